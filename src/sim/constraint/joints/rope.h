#pragma once

// Rope: two points come no farther apart than l.
//   C    = l - |d| >= 0,  f >= 0,  f C = 0              d as of a rod
//   J, J' v                                             those of a rod, of the other sign
//   free: all, until it is tight. Breaks by |f|.
// Source: Catto, Modeling and Solving Constraints (2009), as an inequality.

#include "sim/constraint/joints/rod.h"

namespace obscura::sim {

template <int D>
void hold_slack(const JointPose<D>& at, Row<D>* J, double* C) {
  C[0] = -excess_length(at, J[0]);
  J[0].reverse();
}

template <int D>
inline constexpr JointEquations<D> kRope = {
    .kind = JointKind::rope, .rows = 1, .one_sided = true, .apart = true, .hold = hold_slack<D>};

}  // namespace obscura::sim
