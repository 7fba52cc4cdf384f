#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace obscura::sim {

/// A place, a direction, a velocity or a force in D dimensions. SI units.
template <int D>
using Vec = Eigen::Matrix<double, D, 1>;

/// Components of spin: one in the plane, three in space.
template <int D>
inline constexpr int kSpins = D*(D - 1) / 2;

/// Angular velocity (rad/s) or torque (N m). In the plane positive is counter-clockwise.
template <int D>
using Spin = Eigen::Matrix<double, kSpins<D>, 1>;

using Vec3 = Eigen::Vector3d;

}  // namespace obscura::sim
