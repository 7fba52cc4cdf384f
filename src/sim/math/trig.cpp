// Sine and cosine by reduction to a quarter turn and Taylor's series.
//   x = k pi/2 + r,  |r| <= pi/4              r = hi + lo, two doubles
// The series and the pieces of pi/2 are in sim/math/trig_kernel.h.

#include "sim/math/trig.h"

#include <cmath>
#include <limits>

#include "sim/math/trig_kernel.h"

namespace obscura::sim {

namespace {

constexpr double kTwoPi = 0x1.921fb54442d18p+2;
}  // namespace

SinCos sin_cos(double x) {
  double a = std::fabs(x);
  if (!(a <= std::numeric_limits<double>::max())) return {x - x, x - x};
  // 2 pi as a double is off by 3.9e-17 of itself: the remainder is that of an argument nearer than x's
  // rounding
  if (a > trig::kFar) a = std::fmod(a, kTwoPi);

  // r = a - k pi/2
  const double k = std::floor(a * trig::kTwoOverPi + 0.5);
  const trig::Twin<double> r = trig::reduced(a, k);
  const double s = trig::sin_kernel(r), c = trig::cos_kernel(r);
  SinCos answer{};
  switch (int(k) & 3) {
    case 0:
      answer = {s, c};
      break;
    case 1:
      answer = {c, -s};
      break;
    case 2:
      answer = {-s, -c};
      break;
    default:
      answer = {-c, s};
      break;
  }
  if (std::signbit(x)) answer.sin = -answer.sin;
  return answer;
}

}  // namespace obscura::sim
