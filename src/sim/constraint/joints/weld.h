#pragma once

// Weld: two bodies keep their place and turn against each other.
//   C    = [ x_a + r_a - x_b - r_b;  phi ]              r as of a pin
//   phi  = theta_a - theta_b - theta_0                  in space the vector sin(angle) axis of
//                                                       E = R_a (R_b R_0)', (E - E')/2 = [phi]x
//   J    = [ those of a pin;  0  1  0  -1 ]             of phi to first order
//   J' v = [ that of a pin;  0 ]
//   free: nothing. Breaks by |f|; moments do not count.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §8.

#include "sim/constraint/joints/pin.h"
#include "sim/math/exponential.h"

namespace obscura::sim {

/// kAngular<D> rows: about each axis of the room.
template <int D>
void hold_turn(const JointPose<D>& at, Row<D>* J, double* C) {
  for (int axis = 0; axis < kAngular<D>; ++axis) {
    J[axis] = Row<D>();
    J[axis].angular_a = J[axis].angular_b = AngularVec<D>::Unit(axis);
  }
  if constexpr (D == 2) {
    C[0] = (at.turn - at.joint.turn)[0];
  } else {
    const Rotation<3> kept = at.b.room_from_body * matrix(exponential(at.joint.turn));
    const Rotation<3> e = at.a.room_from_body * kept.transpose();
    C[0] = 0.5 * (e(2, 1) - e(1, 2)), C[1] = 0.5 * (e(0, 2) - e(2, 0)), C[2] = 0.5 * (e(1, 0) - e(0, 1));
  }
}

template <int D>
void hold_pose(const JointPose<D>& at, Row<D>* J, double* C) {
  hold_point(at, J, C);
  hold_turn(at, J + D, C + D);
}

template <int D>
inline constexpr JointEquations<D> kWeld = {
    .kind = JointKind::weld, .rows = D + kAngular<D>, .turning = true, .hold = hold_pose<D>};

}  // namespace obscura::sim
