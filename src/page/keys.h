#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace obscura::page {

/// Whole numbers as bytes, seven bits a byte, low ones first; a sign is the lowest bit (LEB128, zigzag).
class Numbers {
 public:
  void add(std::int64_t n);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The values of one number in successive frames, equal ones once.
class Course {
 public:
  void add(double value, std::int64_t times = 1);
  std::int64_t size() const { return size_; }
  double last() const { return runs_.back().first; }
  double first() const { return runs_.front().first; }
  bool constant() const { return runs_.size() == 1; }
  std::vector<double> values() const;

 private:
  std::vector<std::pair<double, std::int64_t>> runs_;
  std::int64_t size_ = 0;
};

/// What keys are written to: each kind of number in a stream of its own, which compresses better.
struct KeyStreams {
  Numbers starts, gaps, ends, bends;
};

/// Keys are whole multiples of this part of their bound.
inline constexpr int kKeySteps = 4;

/// Writes values as cubic pieces that are nowhere, in a frame, farther from them than `bound`; each as long
/// as it can be. A piece of n frames from p to q is
///   p + u (q - p) + 3 u (1 - u)^2 a + 3 u^2 (1 - u) b,  u = k / n
/// with p, q, a and b whole multiples of bound / kKeySteps: the gap n, q - p, and where n > 1 a and b.
void write_keys(const std::vector<double>& values, double bound, KeyStreams& out);

}  // namespace obscura::page
