#pragma once

// Hinge: a pin about an axis n; in the plane a pin.
//   C    = [ x_a + r_a - x_b - r_b;  n_a . t_1;  n_a . t_2 ]      n_a  the axis as a has it, R_a R_0' n;
//                                                                 t_i  across n, of b's frame
//   J    = [ those of a pin;  0  n_a x t_i  0  -(n_a x t_i) ]
//   J' v = [ that of a pin;  ((w_a x n_a) x t_i + n_a x (w_b x t_i)) . (w_a - w_b) ]
//   free: the angle about n; limits, motor and friction act on it. In space it is within pi, of
//         sine n . (t x u) and cosine t . u, t = t_1 of b's frame and u the same as a has it. Breaks by |f|.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §4 and §8.

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/pin.h"
#include "sim/math/exponential.h"

namespace obscura::sim {

/// A direction of b's frame as a has it, turned by what the joint keeps.
inline Vec<3> as_a_has_it(const JointPose<3>& at, const Vec<3>& direction) {
  return at.a.room_from_body * (matrix(exponential(at.joint.turn)).transpose() * direction);
}

inline void hold_axis(const JointPose<3>& at, Row<3>* J, double* C) {
  hold_point(at, J, C);
  const Vec<3> axis_a = as_a_has_it(at, at.joint.axis);
  for (int i = 0; i < 2; ++i) {
    const Vec<3> across = at.b.arm(tangent<3>(at.joint.axis, i));
    Row<3>& row = J[3 + i] = Row<3>();
    row.angular_a = row.angular_b = axis_a.cross(across);
    row.velocity_product =
        (at.a.w.cross(axis_a).cross(across) + axis_a.cross(at.b.w.cross(across))).dot(at.a.w - at.b.w);
    C[3 + i] = axis_a.dot(across);
  }
}

/// The angle of a sine and a cosine, by the half of it: the same bits everywhere.
inline double angle_of(double sine, double cosine) {
  const double half = std::sqrt(0.5 * std::max(0.0, 1 + std::fabs(cosine)));
  Eigen::Vector4d q(0, 0, 0, 0);  // a turn by it about the third axis
  if (cosine >= 0) {
    q[3] = half, q[2] = 0.5 * sine / half;
  } else {
    q[2] = sine < 0 ? -half : half, q[3] = 0.5 * std::fabs(sine) / half;
  }
  return logarithm(q)[2];
}

inline double angle_about_axis(const JointPose<3>& at, Row<3>& J) {
  const Vec<3> axis = at.b.arm(at.joint.axis), aside = tangent<3>(at.joint.axis, 0);
  J = Row<3>();
  J.angular_a = J.angular_b = axis;
  J.velocity_product = at.b.w.cross(axis).dot(at.a.w - at.b.w);
  const Vec<3> from = at.b.arm(aside), to = as_a_has_it(at, aside);
  return angle_of(axis.dot(from.cross(to)), from.dot(to));
}

template <int D>
inline constexpr JointEquations<D> kHinge = {.kind = JointKind::hinge,
                                             .rows = 5,
                                             .axis = true,
                                             .turning = true,
                                             .angle = true,
                                             .hold = hold_axis,
                                             .coordinate = angle_about_axis};
template <>
inline constexpr JointEquations<2> kHinge<2> = {
    .kind = JointKind::hinge, .rows = 2, .angle = true, .hold = hold_point<2>, .coordinate = plane_angle};

}  // namespace obscura::sim
