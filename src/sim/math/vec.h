#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace obscura::sim {

/// A place, a direction, a velocity or a force in D dimensions. SI units.
template <int D>
using Vec = Eigen::Matrix<double, D, 1>;

/// Components of spin: one in the plane, three in space.
template <int D>
inline constexpr int kAngular = D*(D - 1) / 2;

/// Angular velocity (rad/s) or torque (N m). In the plane positive is counter-clockwise.
template <int D>
using AngularVec = Eigen::Matrix<double, kAngular<D>, 1>;

/// The turn of a rigid body: in the plane an angle (rad, not wrapped), in space a unit quaternion (x, y, z,
/// w), room from body.
template <int D>
using Orientation = Eigen::Matrix<double, D == 2 ? 1 : 4, 1>;

/// The turn of what stands as it was made: the angle zero, or (0, 0, 0, 1).
template <int D>
Orientation<D> no_rotation() {
  return D == 2 ? Orientation<D>(Orientation<D>::Zero())
                : Orientation<D>(Orientation<D>::Unit(Orientation<D>::RowsAtCompileTime - 1));
}

using Vec3 = Eigen::Vector3d;

/// A place of the plane at z = 0.
template <int D>
Vec3 to_3d(const Vec<D>& x) {
  Vec3 place = Vec3::Zero();
  place.head<D>() = x;
  return place;
}

}  // namespace obscura::sim
