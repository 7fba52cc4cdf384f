// Sine and cosine by reduction to a quarter turn and Taylor's series.
//   x = k pi/2 + r,  |r| <= pi/4              r = hi + lo, two doubles
//   sin(hi + lo) = sin hi + lo cos hi,  cos(hi + lo) = cos hi - lo sin hi
// pi/2 is the sum of four pieces; the first three have 33 bits, so that k times a piece is exact for k <=
// 2^20.

#include "sim/trig.h"

#include <cmath>
#include <limits>

namespace obscura::sim {

namespace {

constexpr double kPieces[4] = {0x1.921fb54400000p+0, 0x1.0b4611a600000p-34, 0x1.3198a2e000000p-69,
                               0x1.b839a252049c1p-104};
constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
constexpr double kTwoPi = 0x1.921fb54442d18p+2;
constexpr double kFar = 1048576;  // 2^20

// the next term left out is below 2^-60 at pi/4
constexpr double kSin[8] = {-1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
                            -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
constexpr double kCos[7] = {1.0 / 24,        -1.0 / 720,         1.0 / 40320,         -1.0 / 3628800,
                            1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000};

struct Twin {
  double hi, lo;
};

// a - b = hi + lo exactly (Knuth)
Twin minus(double a, double b) {
  const double hi = a - b;
  const double back = hi - a;
  return {hi, (a - (hi - back)) - (b + back)};
}

template <int N>
double horner(const double (&c)[N], double z) {
  double sum = c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}

// sin(r) = hi + (hi^3 P(hi^2) + lo (1 - hi^2/2))
double sin_kernel(Twin r) {
  const double z = r.hi * r.hi;
  return r.hi + (r.hi * z * horner(kSin, z) + r.lo * (1 - 0.5 * z));
}

// cos(r) = 1 - hi^2/2 + hi^4 Q(hi^2) - hi lo; what 1 - hi^2/2 rounds away is put back
double cos_kernel(Twin r) {
  const double z = r.hi * r.hi;
  const double half = 0.5 * z;
  const double most = 1 - half;
  return most + (((1 - most) - half) + (z * z * horner(kCos, z) - r.hi * r.lo));
}

}  // namespace

SinCos sin_cos(double x) {
  double a = std::fabs(x);
  if (!(a <= std::numeric_limits<double>::max())) return {x - x, x - x};
  // 2 pi as a double is off by 3.9e-17 of itself: the remainder is that of an argument nearer than x's
  // rounding
  if (a > kFar) a = std::fmod(a, kTwoPi);

  // r = a - k pi/2
  const double k = std::floor(a * kTwoOverPi + 0.5);
  const Twin first = minus(a - k * kPieces[0], k * kPieces[1]);
  const Twin second = minus(first.hi, k * kPieces[2]);
  const double tail = first.lo + second.lo - k * kPieces[3];
  const double hi = second.hi + tail;
  const Twin r{hi, (second.hi - hi) + tail};

  const double s = sin_kernel(r), c = cos_kernel(r);
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
