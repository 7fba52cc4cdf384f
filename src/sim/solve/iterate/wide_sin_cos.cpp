// sin_cos of four angles at once, without branches. The angle is reduced by k quarter turns; then
//   k odd                           sine and cosine change places
//   (k & 2 != 0) != (x < 0)         the sine changes sign
//   (k + 1) & 2 != 0                the cosine changes sign

#pragma GCC diagnostic ignored "-Wpsabi"  // every function with vectors is inlined

#include "sim/solve/iterate/wide_sin_cos.h"

#include <cmath>

#include "sim/math/trig.h"
#include "sim/math/trig_kernel.h"

namespace obscura::sim::plane {

namespace {

typedef double V __attribute__((vector_size(32)));
typedef long long I __attribute__((vector_size(32)));

constexpr int kAngles = 4;
constexpr double kWhole = 4503599627370496;  // 2^52: from there on doubles are whole

// false where a turn is too far for it
[[gnu::always_inline]] inline bool four(const double* turns, Pose* poses) {
  V x{};
  for (int i = 0; i < kAngles; ++i) x[i] = turns[i];
  const I sign = I{} + (1LL << 63);
  const V a = V(I(x) & ~sign);
  const I near = a <= V{} + trig::kFar;
  if ((near[0] & near[1] & near[2] & near[3]) == 0) return false;
  // floor, of what is not negative
  const V wanted = a * trig::kTwoOverPi + 0.5;
  const V round = (wanted + kWhole) - kWhole;
  const V k = round - V(I(V{} + 1.0) & (round > wanted));
  const trig::Twin<V> r = trig::reduced<V>(a, k);
  const V s = trig::sin_kernel<V>(r), c = trig::cos_kernel<V>(r);
  const I quarter = I(k + kWhole);
  const I odd = -(quarter & 1);
  const I minus_sin = ((quarter & 2) << 62) ^ (I(x) & sign), minus_cos = ((quarter + 1) & 2) << 62;
  const V sin = V(((I(s) & ~odd) | (I(c) & odd)) ^ minus_sin);
  const V cos = V(((I(c) & ~odd) | (I(s) & odd)) ^ minus_cos);
  for (int i = 0; i < kAngles; ++i) poses[i].c = cos[i], poses[i].s = sin[i];
  return true;
}

[[gnu::always_inline]] inline void all(const double* turns, Pose* poses, int count) {
  int i = 0;
  for (; i + kAngles <= count; i += kAngles) {
    if (four(turns + i, poses + i)) continue;
    for (int k = i; k < i + kAngles; ++k) {
      const SinCos sc = sin_cos(turns[k]);
      poses[k].c = sc.cos, poses[k].s = sc.sin;
    }
  }
  for (; i < count; ++i) {
    const SinCos sc = sin_cos(turns[i]);
    poses[i].c = sc.cos, poses[i].s = sc.sin;
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void all_wide(const double* turns, Pose* poses, int count) {
  all(turns, poses, count);
}
#endif

}  // namespace

void turn_all(const double* turns, Pose* poses, int count) {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") != 0;
  if (wide) return all_wide(turns, poses, count);
#endif
  all(turns, poses, count);
}

}  // namespace obscura::sim::plane
