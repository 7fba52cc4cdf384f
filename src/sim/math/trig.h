#pragma once

namespace obscura::sim {

struct SinCos {
  double sin, cos;
};

/// Sine and cosine of x (rad), the same bits on every processor: no libm, no fused multiply-add.
/// Off by less than 0.8 units in the last place for |x| <= 2^20; beyond, the answer belongs to an argument
/// within half a unit in the last place of x. Odd and even to the bit. Not a number where x is not finite.
SinCos sin_cos(double x);

}  // namespace obscura::sim
