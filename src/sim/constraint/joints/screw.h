#pragma once

// Screw: a point of a stays on a line of b, and a turns about that line by an angle for each length that it
// goes along it; in space.
//   C    = [ t_i . (x_a + r_a - x_b - r_b);  n_a . t_i;  s - p phi ]
//            s, phi  way along the axis n and angle about it, as of a slider and a hinge
//            p       metres a radian; C is taken up to whole turns
//   J    = [ rows of a slider across n; rows of a hinge across n; J_s - p J_phi ],  J' v likewise
//   free: the way s; limits, motor and friction act on it. Breaks by |f|.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §4.4 (helical joint).

#include <cmath>
#include <numbers>

#include "sim/constraint/joints/hinge.h"
#include "sim/constraint/joints/slider.h"

namespace obscura::sim {

inline void hold_thread(const JointPose<3>& at, Row<3>* J, double* C) {
  Row<3> all[5];
  double off[5];
  hold_axis(at, all, off);
  for (int i = 0; i < 2; ++i) C[i] = way_along<3>(at, tangent<3>(at.joint.axis, i), J[i]);
  for (int i = 0; i < 2; ++i) J[2 + i] = all[3 + i], C[2 + i] = off[3 + i];
  Row<3> turn;
  const double p = at.joint.ratio, round = 2 * std::numbers::pi * std::fabs(p);
  const double way = way_of_slider<3>(at, J[4]), angle = angle_about_axis(at, turn);
  J[4].angular_a -= p * turn.angular_a, J[4].angular_b -= p * turn.angular_b;
  J[4].velocity_product -= p * turn.velocity_product;
  const double apart = way - p * angle;
  C[4] = apart - round * std::round(apart / round);
}

/// In the plane there is none; it is a slider.
template <int D>
inline constexpr JointEquations<D> kScrew = {.kind = JointKind::screw,
                                             .rows = 5,
                                             .axis = true,
                                             .turning = true,
                                             .hold = hold_thread,
                                             .coordinate = way_of_slider<3>};
template <>
inline constexpr JointEquations<2> kScrew<2> = {.kind = JointKind::screw,
                                                .rows = 2,
                                                .axis = true,
                                                .turning = true,
                                                .hold = hold_line<2>,
                                                .coordinate = way_of_slider<2>};

}  // namespace obscura::sim
