#pragma once

namespace obscura::sim::plane {

/// An impact of two bodies of the plane at up to two touches, in one instant. Rows: the normal and the
/// tangent of touch 0, then those of touch 1.
struct PairImpact {
  bool closed[2] = {false, false};  // which contact points take part
  double K[4][4] = {};              // 1/kg: how much an impulse along a row changes the speed along another
  double v[4] = {};                 // m/s: speeds along the rows before the impact
  double e[2] = {0, 0};             // restitution; 0: too slow to bounce
  double mu = 0;
};

/// Impulses p (N s) along the rows that solve normals and friction together:
///   v' = v + K p,   p_n >= 0,   v_n' + e v_n >= 0,   p_n (v_n' + e v_n) = 0,   v_t' against p_t on the cone
/// Newton's law with friction can raise the energy; then e is halved, in both points, until it does not.
void solve(const PairImpact& impact, double (&p)[4]);

}  // namespace obscura::sim::plane
