// Free motion.
//   x' = v,   v' = g - (c/m) v                          centre of mass
//   I w' = -w x (I w),   q' = q (0, w) / 2              torque-free rotation, in the body's frame
// Source: Goldstein, Poole and Safko, Classical Mechanics (2002), §5.6.

#include "sim/motion/free_motion.h"

#include <algorithm>

#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

void component_rates(std::size_t n, const double* __restrict gravity, const double* __restrict drag,
                     const double* __restrict v, double* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = gravity[i] - drag[i] * v[i];
}

}  // namespace

void unconstrained_rates(std::span<const double> gravity, std::span<const double> drag,
                         std::span<const double> v, std::span<double> v_rate) {
  if (drag.empty()) {
    std::copy(gravity.begin(), gravity.end(), v_rate.begin());
  } else {
    component_rates(v.size(), gravity.data(), drag.data(), v.data(), v_rate.data());
  }
}

void FreeTranslation::rates(double, std::span<const double>, std::span<const double> v,
                            std::span<double> d_rate, std::span<double> v_rate) {
  std::copy(v.begin(), v.end(), d_rate.begin());
  unconstrained_rates(gravity_.first(v.size()), drag_, v, v_rate);
}

template <>
void TorqueFreeRotation<2>::rates(double, std::span<const double>, std::span<const double> v,
                                  std::span<double> d_rate, std::span<double> v_rate) {
  std::copy(v.begin(), v.end(), d_rate.begin());
  std::fill(v_rate.begin(), v_rate.end(), 0.0);
}

template <>
void TorqueFreeRotation<3>::rates(double, std::span<const double> d, std::span<const double> v,
                                  std::span<double> d_rate, std::span<double> v_rate) {
  for (std::size_t i = 0; i < base_.size(); ++i) {
    const Vec3 w = base_[i] + Eigen::Map<const Vec3>(v.data() + 3 * i);
    Eigen::Map<Vec3>(d_rate.data() + 3 * i) =
        displacement_rate<3>(Eigen::Map<const Vec3>(d.data() + 3 * i), w);
    Eigen::Map<Vec3>(v_rate.data() + 3 * i) = gyroscopic_acceleration<3>(inertia_[i], w);
  }
}

}  // namespace obscura::sim
