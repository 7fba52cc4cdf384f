#pragma once

#include "sim/math/vec.h"

namespace obscura::sim {

// Turns in space: unit quaternions (x, y, z, w), and rotation vectors (rad) that move them.

/// First b, then a. Unit where both are.
Eigen::Vector4d product(const Eigen::Vector4d& a, const Eigen::Vector4d& b);

/// The turn about `turn` by its length.
Eigen::Vector4d exponential(const Vec3& turn);

/// The rotation vector of a unit quaternion, at most pi long: exponential(logarithm(q)) is q or -q.
Vec3 logarithm(const Eigen::Vector4d& q);

/// q exp(by): the orientation `q` turned further by the rotation vector `by` in the body's frame; of unit
/// length. The same bits as `q` if `by` is zero.
Eigen::Vector4d turned(const Eigen::Vector4d& q, const Vec3& by);

/// dexp^-1: the rate of the rotation vector d in q0 exp(d(t)) for the angular velocity w (rad/s), both in the
/// body's frame. Runge-Kutta-Munthe-Kaas integrates it. (For exp(d) q0 and w in the outer frame pass -d.)
/// Requires |d| < 2 pi.
Vec3 turn_rate(const Vec3& d, const Vec3& w);

/// The spin (rad/s) of q0 exp(d(t)) whose rotation vector changes at `rate`, seen from what turns: dexp, the
/// inverse of turn_rate.
Vec3 spin_of(const Vec3& d, const Vec3& rate);

/// Columns are the axes of what is turned by the unit quaternion q.
Eigen::Matrix3d matrix(const Eigen::Vector4d& q);

/// The rotation about a unit axis by an angle whose sine and cosine are given.
Eigen::Matrix3d about(const Vec3& axis, double sin, double cos);

}  // namespace obscura::sim
