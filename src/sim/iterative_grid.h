#pragma once

#include <cstdint>
#include <vector>

namespace obscura::sim::sweep {

/// An upright rectangle, m.
struct Bounds {
  double left = 0, bottom = 0, right = 0, top = 0;

  bool meets(const Bounds& o) const {
    return left <= o.right && o.left <= right && bottom <= o.top && o.bottom <= top;
  }
};

/// Finds which of many rectangles meet: hashed square cells, as wide as most rectangles are; the few that
/// span many cells are held against everyone. Cost is linear while few overlap.
class Grid {
 public:
  /// Takes them in. Kept by pointer until the next call.
  void fill(const std::vector<Bounds>& bounds);

  /// All with a larger index than `i` that meet it, ascending, into `out`.
  void after(int i, std::vector<int>& out) const;

 private:
  struct Cells {
    std::int64_t left, bottom, right, top;
  };
  Cells cells(const Bounds& b) const;
  std::size_t bucket(std::int64_t x, std::int64_t y) const {
    return std::size_t((std::uint64_t(x) * 0x9E3779B97F4A7C15u ^ std::uint64_t(y) * 0xC2B2AE3D27D4EB4Fu) >>
                       shift_);
  }

  const std::vector<Bounds>* bounds_ = nullptr;
  double per_cell_ = 1;  // 1 / width
  int shift_ = 63;
  std::vector<int> start_, entries_, wide_;
  std::vector<char> is_wide_;
  std::vector<double> widths_;
};

}  // namespace obscura::sim::sweep
