#pragma once

#include "sim/math/vec.h"

namespace obscura::sim {

/// The force or impulse p = (normal, two tangents) of a single contact with friction in space:
///   w = K p + b,   0 <= w_n _|_ p_n >= 0,   |p_t| <= mu p_n;   if |p_t| = mu p_n, p_t is opposite to w_t
/// K: symmetric, positive definite (1/kg); b: w without p (m/s; then p is in N s). Used for impacts of one
/// contact; Cone solves all others. False if the search finds no solution: there may be none, or several. The
/// law is that of sim/solve/cone/cone.h.
bool solve_one_contact(const Eigen::Matrix3d& K, const Vec3& b, double mu, Vec3& p);

}  // namespace obscura::sim
