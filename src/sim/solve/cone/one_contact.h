#pragma once

#include "sim/math/vec.h"

namespace obscura::sim {

/// The force or impulse p = (normal, two tangents) of a single contact with friction in space:
///   w = K p + b,   0 <= w_n _|_ p_n >= 0,   |p_t| <= mu p_n,   where it is at most, against w_t
/// K: symmetric, positive definite (1/kg); b: what the contact would do without it (m/s; then p is in N s).
/// False where the search finds none: a contact may have none, or several. The law as in
/// sim/solve/cone/cone.h.
bool solve_one_contact(const Eigen::Matrix3d& K, const Vec3& b, double mu, Vec3& p);

}  // namespace obscura::sim
