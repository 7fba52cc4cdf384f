#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace obscura::sim {

/// Numbers of a seed, the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : bits_(seed) {}

  double between(double low, double high) { return low + (high - low) * (double(bits_()) / 4294967296.0); }
  int below(int n) { return int(bits_() % std::uint32_t(n)); }

  /// Each component within `most` of zero.
  template <int N>
  Eigen::Matrix<double, N, 1> vector(double most) {
    Eigen::Matrix<double, N, 1> v;
    for (int k = 0; k < N; ++k) v[k] = between(-most, most);
    return v;
  }

 private:
  std::mt19937 bits_;
};

}  // namespace obscura::sim
