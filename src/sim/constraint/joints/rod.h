#pragma once

// Rod: two points stay at a distance l.
//   C    = |d| - l,  d = x_a + r_a - x_b - r_b          r as of a pin
//   J    = [ n  r_a x n  -n  -(r_b x n) ],  n = d / |d|
//   J' v                                                that of two vertices that touch (constraint/row.cpp)
//   free: all but the distance, none that it can tell. Breaks by |f|.
// Source: Catto, Modeling and Solving Constraints (2009), distance constraint.

#include "sim/constraint/joints/joint.h"

namespace obscura::sim {

/// How much longer than l it is, m.
template <int D>
double excess_length(const JointPose<D>& at, Row<D>& J) {
  ContactCandidate<D> contact;
  contact.on_a = at.joint.a.local, contact.on_b = at.joint.b.local;
  contact.kind = ContactCandidate<D>::Kind::corners;
  Row<D> all[D];
  const double excess = rows(contact, at.a, at.b, all).value - at.joint.length;
  J = all[0];
  return excess;
}

template <int D>
void hold_length(const JointPose<D>& at, Row<D>* J, double* C) {
  C[0] = excess_length(at, J[0]);
}

template <int D>
inline constexpr JointEquations<D> kRod = {
    .kind = JointKind::rod, .rows = 1, .apart = true, .hold = hold_length<D>};

}  // namespace obscura::sim
