// Elementary functions by reduction to a small argument and a power series.
//   exp x    = 2^k exp r,                 r = x - k ln 2,  |r| <= ln 2 / 2
//   log x    = k ln 2 + 2 artanh s,       x = 2^k m,  s = (m - 1) / (m + 1),  |s| <= 0.172
//   x^y      = exp(y log x),              log x as the sum of two doubles
//   atan t   = atan c + atan u,           u = (t - c) / (1 + c t),  c = k/8,  |u| <= 3/32,  0 <= t <= 1
//   asin x   = atan2(x, sqrt((1 - x)(1 + x)))
//   sinh, tanh by their series below 1, where the difference of exponentials would cancel
// Source of the reductions: Muller, Elementary Functions (2016), §11; of sums and products as two doubles:
// Dekker (1971).

#include "sim/math/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obscura::sim::elementary {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// ln 2 = high + low: the high part has 32 bits, so that k times it is exact
constexpr double kLn2High = 0x1.62e42fee00000p-1, kLn2Low = 0x1.a39ef35793c76p-33;
constexpr double kPerLn2 = 0x1.71547652b82fep+0, kRootOfTwo = 0x1.6a09e667f3bcdp+0;
constexpr double kHalfPi = 0x1.921fb54442d18p+0, kHalfPiLow = 0x1.1a62633145c07p-54;
constexpr double kPi = 0x1.921fb54442d18p+1, kPiLow = 0x1.1a62633145c07p-53;

// atan(k/8), the second what the first rounds away
constexpr double kArcs[9][2] = {{0, 0},
                                {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};

// 1/2, 1/6, ..., 1/14!
constexpr double kExp[13] = {1.0 / 2,          1.0 / 6,        1.0 / 24,        1.0 / 120,
                             1.0 / 720,        1.0 / 5040,     1.0 / 40320,     1.0 / 362880,
                             1.0 / 3628800,    1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800,
                             1.0 / 87178291200};
// 2/3, 2/5, ..., of 2 artanh s
constexpr double kArtanh[12] = {2.0 / 3,  2.0 / 5,  2.0 / 7,  2.0 / 9,  2.0 / 11, 2.0 / 13,
                                2.0 / 15, 2.0 / 17, 2.0 / 19, 2.0 / 21, 2.0 / 23, 2.0 / 25};
constexpr double kArctan[9] = {-1.0 / 3, 1.0 / 5,   -1.0 / 7, 1.0 / 9,  -1.0 / 11,
                               1.0 / 13, -1.0 / 15, 1.0 / 17, -1.0 / 19};
// 1/3!, 1/5!, ...
constexpr double kSinh[10] = {1.0 / 6,
                              1.0 / 120,
                              1.0 / 5040,
                              1.0 / 362880,
                              1.0 / 39916800,
                              1.0 / 6227020800,
                              1.0 / 1307674368000,
                              1.0 / 355687428096000,
                              1.0 / 121645100408832000,
                              1.0 / 51090942171709440000.0};

template <int N>
double polynomial(const double (&c)[N], double z) {
  double sum = c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}

// a number as the sum of two doubles
struct Pair {
  double high = 0, low = 0;
};

Pair sum_of(double a, double b) {
  const double high = a + b, back = high - a;
  return {high, (a - (high - back)) + (b - back)};
}

// exactly, where no product overflows: halves of 26 bits
Pair product_of(double a, double b) {
  constexpr double kSplit = 134217729;  // 2^27 + 1
  const double p = kSplit * a, q = kSplit * b;
  const double ah = p - (p - a), al = a - ah, bh = q - (q - b), bl = b - bh;
  const double high = a * b;
  return {high, ((ah * bh - high) + ah * bl + al * bh) + al * bl};
}

Pair product_of(const Pair& a, const Pair& b) {
  const Pair p = product_of(a.high, b.high);
  return sum_of(p.high, p.low + (a.high * b.low + a.low * b.high));
}

// exp(x + more), more a correction of x below its last place
double exponential_of(double x, double more) {
  if (!(x > -746)) return x < 0 ? 0 : kNone;
  if (x > 710) return kInfinity;
  const double k = std::floor(x * kPerLn2 + 0.5);
  const double high = x - k * kLn2High, low = k * kLn2Low;
  const double r = high - low, rest = ((high - r) - low) + more;
  const double square = r * r * polynomial(kExp, r);
  return std::ldexp(1 + (r + (square + rest * (1 + (r + square)))), int(k));
}

// x = 2^k m with m between 1/sqrt 2 and sqrt 2; x > 0 and finite
double mantissa(double x, double& k) {
  int exponent = 0;
  double m = 2 * std::frexp(x, &exponent);
  --exponent;
  if (m > kRootOfTwo) m *= 0.5, ++exponent;
  k = exponent;
  return m;
}

// log x to 2^-65 of itself; x > 0 and finite
Pair logarithm_of(double x) {
  double k = 0;
  const double m = mantissa(x, k);
  if (m == 1) return sum_of(k * kLn2High, k * kLn2Low);
  // s = (m - 1) / (m + 1)
  const double f = m - 1;
  const Pair g = sum_of(m, 1);
  const double first = f / g.high;
  const Pair back = product_of(first, g.high);
  const Pair s = sum_of(first, ((f - back.high) - back.low - first * g.low) / g.high);
  // 2 artanh s = 2 s + s z (2/3 + z (2/5 + ...)),  z = s^2
  const Pair z = product_of(s, s);
  constexpr double kTwoThirds = 2.0 / 3, kTwoThirdsLow = 0x1.5555555555555p-55;
  double rest = kArtanh[11];
  for (int i = 10; i >= 1; --i) rest = rest * z.high + kArtanh[i];
  Pair q = sum_of(kTwoThirds, z.high * rest);
  q.low += kTwoThirdsLow;
  const Pair more = product_of(s, product_of(z, q));
  Pair all = sum_of(2 * s.high, more.high);
  all.low += 2 * s.low + more.low;
  const Pair whole = sum_of(k * kLn2High, all.high);
  return sum_of(whole.high, whole.low + (all.low + k * kLn2Low));
}

// atan(y/x) for 0 <= y <= x, x > 0
Pair arc_of(double y, double x) {
  const double part = y / x;
  // below 3/32 the series alone: atan(1/8) would cancel most of u
  const int k = part < 0.09375 ? 0 : std::max(1, int(part * 8 + 0.5));
  const double c = k / 8.0;
  const double u = k == 0 ? part : (y - c * x) / (x + c * y);
  const double z = u * u;
  return {kArcs[k][0], kArcs[k][1] + (u + u * z * polynomial(kArctan, z))};
}

double sinh_series(double x) {
  const double z = x * x;
  return x + x * z * polynomial(kSinh, z);
}

}  // namespace

double exp(double x) { return exponential_of(x, 0); }

double log(double x) {
  if (!(x > 0)) return x == 0 ? -kInfinity : kNone;
  if (x == kInfinity) return x;
  double k = 0;
  const double f = mantissa(x, k) - 1;
  const double s = f / (2 + f), z = s * s, half = 0.5 * f * f;
  // 2 s = f - f^2/2 + s f^2/2
  const double rest = s * (half + z * polynomial(kArtanh, z)) + k * kLn2Low;
  return k * kLn2High - ((half - rest) - f);
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNone;
  const bool whole = std::floor(y) == y;
  const bool odd = whole && std::fabs(y) < 0x1p53 && std::fmod(y, 2) != 0;
  const double size = std::fabs(x), sign = std::signbit(x) && odd ? -1 : 1;
  if (size == 0) return sign * (y < 0 ? kInfinity : 0.0);
  if (size == kInfinity) return sign * (y < 0 ? 0.0 : kInfinity);
  if (x < 0 && !whole && std::fabs(y) != kInfinity) return kNone;
  if (size == 1) return sign;
  // |log x| is 2^-53 at least: so large an exponent leaves nothing or everything
  if (std::fabs(y) > 0x1p65) return (size > 1) == (y > 0) ? sign * kInfinity : sign * 0.0;
  const Pair l = logarithm_of(size);
  if (std::fabs(y * l.high) > 800) return y * l.high > 0 ? sign * kInfinity : sign * 0.0;
  const Pair p = product_of(y, l.high);
  const Pair all = sum_of(p.high, p.low + y * l.low);
  return sign * exponential_of(all.high, all.low);
}

double tan(double x) {
  const SinCos it = sin_cos(x);
  return it.sin / it.cos;
}

double atan2(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNone;
  double a = std::fabs(y), b = std::fabs(x);
  if (a == kInfinity || b == kInfinity) {
    a = a == kInfinity ? 1 : 0, b = b == kInfinity ? 1 : 0;
  } else if (a > 0x1p1000 || b > 0x1p1000) {
    a *= 0x1p-60, b *= 0x1p-60;
  } else if (a < 0x1p-960 && b < 0x1p-960) {
    a *= 0x1p60, b *= 0x1p60;
  }
  Pair arc{0, 0};
  if (a <= b) {
    if (b > 0) arc = arc_of(a, b);
  } else {
    const Pair other = arc_of(b, a);
    arc = sum_of(kHalfPi, -other.high);
    arc.low += kHalfPiLow - other.low;
  }
  if (std::signbit(x)) {
    const Pair turned = sum_of(kPi, -arc.high);
    arc = {turned.high, turned.low + (kPiLow - arc.low)};
  }
  const double angle = arc.high + arc.low;
  return std::signbit(y) ? -angle : angle;
}

double atan(double x) { return atan2(x, 1); }

double asin(double x) { return atan2(x, std::sqrt((1 - x) * (1 + x))); }

double acos(double x) { return atan2(std::sqrt((1 - x) * (1 + x)), x); }

double sinh(double x) {
  const double a = std::fabs(x);
  if (a <= 1) return sinh_series(x);
  double size;
  if (a > 700) {
    const double half = exponential_of(0.5 * a, 0);
    size = 0.5 * half * half;
  } else {
    const double e = exponential_of(a, 0);
    size = 0.5 * (e - 1 / e);
  }
  return x < 0 ? -size : size;
}

double cosh(double x) {
  const double a = std::fabs(x);
  if (a > 700) {
    const double half = exponential_of(0.5 * a, 0);
    return 0.5 * half * half;
  }
  const double e = exponential_of(a, 0);
  return 0.5 * (e + 1 / e);
}

double tanh(double x) {
  const double a = std::fabs(x);
  if (a <= 1) return sinh_series(x) / cosh(x);
  const double size = 1 - 2 / (exponential_of(2 * a, 0) + 1);
  return x < 0 ? -size : size;
}

}  // namespace obscura::sim::elementary
