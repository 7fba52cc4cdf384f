#pragma once

// Slider: a point of a stays on a line of b, and the bodies keep their relative orientation.
//   C    = [ t_i . (x_a + r_a - x_b - r_b);  phi ]      t_i  the D-1 directions across the axis, fixed in b;
//                                                       r as in a pin, phi as in a weld
//   J    = [ t  r x t ... ]                             as of a vertex of a at a face of b with normal t
//   J' v = that of such a contact (constraint/row.cpp); zero for phi
//   free: the way c = n . (x_a + r_a - x_b - r_b) along the axis n; limits, motor and friction act on it.
//   Breaks by |f|.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §8.

#include "sim/constraint/joints/weld.h"

namespace obscura::sim {

/// How far a's point is from b's along a direction of b's frame, m.
template <int D>
double way_along(const JointPose<D>& at, const Vec<D>& direction, Row<D>& J) {
  ContactCandidate<D> contact;
  contact.on_a = at.joint.a.local, contact.on_b = at.joint.b.local;
  contact.kind = ContactCandidate<D>::Kind::corner_of_a;
  contact.normal = direction;
  Row<D> all[D];
  const double way = rows(contact, at.a, at.b, all).value;
  J = all[0];
  return way;
}

template <int D>
void hold_line(const JointPose<D>& at, Row<D>* J, double* C) {
  for (int i = 0; i < D - 1; ++i) C[i] = way_along<D>(at, tangent<D>(at.joint.axis, i), J[i]);
  hold_turn(at, J + D - 1, C + D - 1);
}

template <int D>
double way_of_slider(const JointPose<D>& at, Row<D>& J) {
  return way_along<D>(at, at.joint.axis, J);
}

template <int D>
inline constexpr JointEquations<D> kSlider = {.kind = JointKind::slider,
                                              .rows = D - 1 + kAngular<D>,
                                              .axis = true,
                                              .turning = true,
                                              .hold = hold_line<D>,
                                              .coordinate = way_of_slider<D>};

}  // namespace obscura::sim
