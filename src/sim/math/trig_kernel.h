#pragma once

// Kernels that sim/math/trig.h and its vector form share, for T a double or a vector of them.
//   sin(hi + lo) = sin hi + lo cos hi,  cos(hi + lo) = cos hi - lo sin hi
// pi/2 is the sum of four pieces; the first three have 33 bits, so that k times a piece is exact for k <=
// 2^20.

namespace obscura::sim::trig {

inline constexpr double kPieces[4] = {0x1.921fb54400000p+0, 0x1.0b4611a600000p-34, 0x1.3198a2e000000p-69,
                                      0x1.b839a252049c1p-104};
inline constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
inline constexpr double kFar = 1048576;  // 2^20

// the next term left out is below 2^-60 at pi/4
inline constexpr double kSin[8] = {
    -1.0 / 6,        1.0 / 120,        -1.0 / 5040,          1.0 / 362880,
    -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368000, 1.0 / 355687428096000};
inline constexpr double kCos[7] = {1.0 / 24,        -1.0 / 720,         1.0 / 40320,         -1.0 / 3628800,
                                   1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000};

template <class T>
struct Twin {
  T hi, lo;
};

// a - b = hi + lo exactly (Knuth)
template <class T>
[[gnu::always_inline]] inline Twin<T> minus(const T& a, const T& b) {
  const T hi = a - b;
  const T back = hi - a;
  return {hi, (a - (hi - back)) - (b + back)};
}

template <class T, int N>
[[gnu::always_inline]] inline T horner(const double (&c)[N], const T& z) {
  T sum = T{} + c[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * z + c[i];
  return sum;
}

// sin(r) = hi + (hi^3 P(hi^2) + lo (1 - hi^2/2))
template <class T>
[[gnu::always_inline]] inline T sin_kernel(const Twin<T>& r) {
  const T z = r.hi * r.hi;
  return r.hi + (r.hi * z * horner(kSin, z) + r.lo * (1 - 0.5 * z));
}

// cos(r) = 1 - hi^2/2 + hi^4 Q(hi^2) - hi lo; the rounding error of 1 - hi^2/2 is added back
template <class T>
[[gnu::always_inline]] inline T cos_kernel(const Twin<T>& r) {
  const T z = r.hi * r.hi;
  const T half = 0.5 * z;
  const T most = 1 - half;
  return most + (((1 - most) - half) + (z * z * horner(kCos, z) - r.hi * r.lo));
}

// a - k pi/2, |a| <= 2^20, k the nearest integer to a / (pi/2)
template <class T>
[[gnu::always_inline]] inline Twin<T> reduced(const T& a, const T& k) {
  const Twin<T> first = minus<T>(a - k * kPieces[0], k * kPieces[1]);
  const Twin<T> second = minus<T>(first.hi, k * kPieces[2]);
  const T tail = first.lo + second.lo - k * kPieces[3];
  const T hi = second.hi + tail;
  return {hi, (second.hi - hi) + tail};
}

}  // namespace obscura::sim::trig
