#pragma once

// Four numbers side by side, in vectors of the compiler: V4 is one AVX2 register, or V2 twice in SSE2, and in
// NEON on aarch64. Code written for a V does the same operations in all of them, so the bits are the same.
// Include this only in files that end in such loops: everything is inlined.

#include <cmath>

#pragma GCC diagnostic ignored "-Wpsabi"  // every function with vectors is inlined

namespace obscura::sim::lanes {

typedef double V2 __attribute__((vector_size(16)));
typedef double V4 __attribute__((vector_size(32)));
typedef long long I2 __attribute__((vector_size(16)));
typedef long long I4 __attribute__((vector_size(32)));
#define OBSCURA_INLINE [[gnu::always_inline]] inline

template <class V>
struct Of;
template <>
struct Of<V2> {
  using Mask = I2;
  static constexpr int lanes = 2;
};
template <>
struct Of<V4> {
  using Mask = I4;
  static constexpr int lanes = 4;
};
template <class V>
using Mask = typename Of<V>::Mask;

template <class V>
OBSCURA_INLINE V load(const double* from) {
  return *reinterpret_cast<const V*>(from);
}
template <class V>
OBSCURA_INLINE void store(double* to, const V& v) {
  *reinterpret_cast<V*>(to) = v;
}
template <class V>
OBSCURA_INLINE V pick(const Mask<V>& which, const V& yes, const V& no) {
  return which ? yes : no;
}
template <class V>
OBSCURA_INLINE V larger(const V& a, const V& b) {
  return pick<V>(a > b, a, b);
}
template <class V>
OBSCURA_INLINE V smaller(const V& a, const V& b) {
  return pick<V>(a < b, a, b);
}
template <class V>
OBSCURA_INLINE V magnitude(const V& a) {
  return larger<V>(a, -a);
}
OBSCURA_INLINE V2 root(const V2& a) { return V2{std::sqrt(a[0]), std::sqrt(a[1])}; }
OBSCURA_INLINE V4 root(const V4& a) {
  return V4{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}
OBSCURA_INLINE bool any(const I2& m) { return (m[0] | m[1]) != 0; }
OBSCURA_INLINE bool any(const I4& m) { return ((m[0] | m[1]) | (m[2] | m[3])) != 0; }

// all bits of the lanes whose bit is set
struct alignas(32) Bits {
  long long lane[16][4];
};
constexpr Bits spread() {
  Bits bits{};
  for (int i = 0; i < 16; ++i) {
    for (int k = 0; k < 4; ++k) bits.lane[i][k] = i >> k & 1 ? -1 : 0;
  }
  return bits;
}
inline constexpr Bits kBits = spread();
template <class V>
OBSCURA_INLINE Mask<V> mask(unsigned char bits, int lane) {
  return *reinterpret_cast<const Mask<V>*>(&kBits.lane[bits][lane]);
}

template <class V>
struct Quad {
  V x, y, z, w;
};

// four doubles of each lane's body
OBSCURA_INLINE void gather(const double* m, const int* i, Quad<V2>& out) {
  const double *p = m + 4 * i[0], *q = m + 4 * i[1];
  const V2 a0 = load<V2>(p), a1 = load<V2>(p + 2), b0 = load<V2>(q), b1 = load<V2>(q + 2);
  out.x = __builtin_shufflevector(a0, b0, 0, 2), out.y = __builtin_shufflevector(a0, b0, 1, 3);
  out.z = __builtin_shufflevector(a1, b1, 0, 2), out.w = __builtin_shufflevector(a1, b1, 1, 3);
}
OBSCURA_INLINE void scatter(double* m, const int* i, const Quad<V2>& in) {
  double *p = m + 4 * i[0], *q = m + 4 * i[1];
  store<V2>(p, __builtin_shufflevector(in.x, in.y, 0, 2)),
      store<V2>(p + 2, __builtin_shufflevector(in.z, in.w, 0, 2));
  store<V2>(q, __builtin_shufflevector(in.x, in.y, 1, 3)),
      store<V2>(q + 2, __builtin_shufflevector(in.z, in.w, 1, 3));
}
OBSCURA_INLINE void gather(const double* m, const int* i, Quad<V4>& out) {
  const V4 a = load<V4>(m + 4 * i[0]), b = load<V4>(m + 4 * i[1]);
  const V4 c = load<V4>(m + 4 * i[2]), d = load<V4>(m + 4 * i[3]);
  const V4 ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const V4 ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  out.x = __builtin_shufflevector(ab, cd, 0, 1, 4, 5), out.z = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  out.y = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5),
  out.w = __builtin_shufflevector(ab1, cd1, 2, 3, 6, 7);
}
OBSCURA_INLINE void scatter(double* m, const int* i, const Quad<V4>& in) {
  const V4 xy = __builtin_shufflevector(in.x, in.y, 0, 4, 2, 6),
           xy1 = __builtin_shufflevector(in.x, in.y, 1, 5, 3, 7);
  const V4 zw = __builtin_shufflevector(in.z, in.w, 0, 4, 2, 6),
           zw1 = __builtin_shufflevector(in.z, in.w, 1, 5, 3, 7);
  store<V4>(m + 4 * i[0], __builtin_shufflevector(xy, zw, 0, 1, 4, 5));
  store<V4>(m + 4 * i[1], __builtin_shufflevector(xy1, zw1, 0, 1, 4, 5));
  store<V4>(m + 4 * i[2], __builtin_shufflevector(xy, zw, 2, 3, 6, 7));
  store<V4>(m + 4 * i[3], __builtin_shufflevector(xy1, zw1, 2, 3, 6, 7));
}

#if defined(__x86_64__)
/// Whether the wide versions are used: where the processor has AVX2. Tests clear it, to compare the bits.
inline bool four_lanes = __builtin_cpu_supports("avx2") != 0;
#define OBSCURA_WIDE __attribute__((target("avx2")))
#else
inline bool four_lanes = false;
#define OBSCURA_WIDE
#endif

}  // namespace obscura::sim::lanes
