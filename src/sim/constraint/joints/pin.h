#pragma once

// Pin: a point of one body stays on a point of another; in space a ball joint.
//   C    = x_a + r_a - x_b - r_b                        r = R l, l the anchor in the body's frame
//   J    = [ 1  -[r_a]x  -1  [r_b]x ]                   in the plane [r]x w = -w perp(r)
//   J' v = w_a x (w_a x r_a) - w_b x (w_b x r_b)        velocity-product term
//   free: the turn; in the plane limits, motor and friction act on its angle. Breaks by |f|.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §3 and §8; Catto, Modeling and Solving
// Constraints (2009).

#include "sim/constraint/joints/joint.h"

namespace obscura::sim {

/// D rows: along each axis of the room.
template <int D>
void hold_point(const JointPose<D>& at, Row<D>* J, double* C) {
  const BodyMotion<D>&a = at.a, &b = at.b;
  const Vec<D> arm_a = at.arm_a(), arm_b = at.arm_b();
  const Vec<D> apart = (a.x + arm_a) - (b.x + arm_b);
  for (int axis = 0; axis < D; ++axis) {
    const Vec<D> s = Vec<D>::Unit(axis);
    Row<D> row;
    row.along = s;
    row.angular_a = moment<D>(arm_a, s), row.angular_b = moment<D>(arm_b, s);
    row.velocity_product = s.dot(cross_velocity<D>(a.w, cross_velocity<D>(a.w, arm_a)) -
                                 cross_velocity<D>(b.w, cross_velocity<D>(b.w, arm_b)));
    J[axis] = row, C[axis] = apart[axis];
  }
}

/// The angle of a against b in the plane.
inline double plane_angle(const JointPose<2>& at, Row<2>& J) {
  J = Row<2>();
  J.angular_a = J.angular_b = AngularVec<2>::Unit(0);
  return (at.turn - at.joint.turn)[0];
}

template <int D>
inline constexpr JointEquations<D> kPin = {.kind = JointKind::pin, .rows = D, .hold = hold_point<D>};
template <>
inline constexpr JointEquations<2> kPin<2> = {
    .kind = JointKind::pin, .rows = 2, .angle = true, .hold = hold_point<2>, .coordinate = plane_angle};

}  // namespace obscura::sim
