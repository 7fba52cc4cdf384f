// One sweep of projected Gauss and Seidel. Of each pair in turn,
//   friction   lt' = clamp(lt - v_t / K_t, -mu ln, mu ln)
//   normals    ln >= 0,  v_n + K (ln' - ln) - target >= 0,  one of both zero in each touch
// the second by its cases: both press, one presses. Where rounding leaves no case, the one less violated.
//
// Written once in vectors of the compiler; two lanes are SSE2, four AVX2. No operation differs, so the bits
// are the same.

#include "sim/iterative_rows.h"

#pragma GCC diagnostic ignored "-Wpsabi"  // every function with vectors is inlined

namespace obscura::sim::sweep {

namespace {

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
OBSCURA_INLINE V load(const double* from) {
  return *reinterpret_cast<const V*>(from);
}
template <class V>
OBSCURA_INLINE void store(double* to, V v) {
  *reinterpret_cast<V*>(to) = v;
}
template <class V>
OBSCURA_INLINE V pick(typename Of<V>::Mask which, V yes, V no) {
  using M = typename Of<V>::Mask;
  return V((which & M(yes)) | (~which & M(no)));
}
template <class V>
OBSCURA_INLINE V larger(V a, V b) {
  return pick<V>(a > b, a, b);
}
template <class V>
OBSCURA_INLINE V smaller(V a, V b) {
  return pick<V>(a < b, a, b);
}

template <class V>
struct Moving {
  V x, y, w;
};

OBSCURA_INLINE void gather(const Motion* m, const int* i, Moving<V2>& out) {
  const V2 a0 = load<V2>(&m[i[0]].x), a1 = load<V2>(&m[i[0]].w);
  const V2 b0 = load<V2>(&m[i[1]].x), b1 = load<V2>(&m[i[1]].w);
  out.x = __builtin_shufflevector(a0, b0, 0, 2), out.y = __builtin_shufflevector(a0, b0, 1, 3);
  out.w = __builtin_shufflevector(a1, b1, 0, 2);
}
OBSCURA_INLINE void scatter(Motion* m, const int* i, const Moving<V2>& in) {
  store<V2>(&m[i[0]].x, __builtin_shufflevector(in.x, in.y, 0, 2));
  m[i[0]].w = in.w[0];
  store<V2>(&m[i[1]].x, __builtin_shufflevector(in.x, in.y, 1, 3));
  m[i[1]].w = in.w[1];
}
OBSCURA_INLINE void gather(const Motion* m, const int* i, Moving<V4>& out) {
  const V4 a = load<V4>(&m[i[0]].x), b = load<V4>(&m[i[1]].x);
  const V4 c = load<V4>(&m[i[2]].x), d = load<V4>(&m[i[3]].x);
  const V4 ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const V4 ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7), cd1 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  out.x = __builtin_shufflevector(ab, cd, 0, 1, 4, 5), out.w = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  out.y = __builtin_shufflevector(ab1, cd1, 0, 1, 4, 5);
}
OBSCURA_INLINE void scatter(Motion* m, const int* i, const Moving<V4>& in) {
  const V4 none{};
  const V4 xy = __builtin_shufflevector(in.x, in.y, 0, 4, 2, 6),
           xy1 = __builtin_shufflevector(in.x, in.y, 1, 5, 3, 7);
  const V4 w = __builtin_shufflevector(in.w, none, 0, 4, 2, 6),
           w1 = __builtin_shufflevector(in.w, none, 1, 5, 3, 7);
  store<V4>(&m[i[0]].x, __builtin_shufflevector(xy, w, 0, 1, 4, 5));
  store<V4>(&m[i[1]].x, __builtin_shufflevector(xy1, w1, 0, 1, 4, 5));
  store<V4>(&m[i[2]].x, __builtin_shufflevector(xy, w, 2, 3, 6, 7));
  store<V4>(&m[i[3]].x, __builtin_shufflevector(xy1, w1, 2, 3, 6, 7));
}

// the two bodies of each lane under impulses
template <class V>
struct Two {
  Moving<V> a, b;
  V ima, iia, imb, iib;

  OBSCURA_INLINE Two(const Group& g, int lane, const Motion* v) {
    gather(v, g.a + lane, a), gather(v, g.b + lane, b);
    ima = load<V>(g.ima + lane), iia = load<V>(g.iia + lane);
    imb = load<V>(g.imb + lane), iib = load<V>(g.iib + lane);
  }
  OBSCURA_INLINE void back(const Group& g, int lane, Motion* v) const {
    scatter(v, g.a + lane, a), scatter(v, g.b + lane, b);
  }
  OBSCURA_INLINE V along(const V& dx, const V& dy, const V& ra, const V& rb) const {
    return dx * (a.x - b.x) + dy * (a.y - b.y) + (ra * a.w - rb * b.w);
  }
  OBSCURA_INLINE void push(const V& dx, const V& dy, const V& ra, const V& rb, const V& l) {
    const V la = ima * l, lb = imb * l;
    a.x += dx * la, a.y += dy * la, a.w += iia * (ra * l);
    b.x -= dx * lb, b.y -= dy * lb, b.w -= iib * (rb * l);
  }
};

// the normal impulses of a pair together
template <class V>
OBSCURA_INLINE void press(const Group& g, int lane, Two<V>& two, V target0, V target1, V& l0, V& l1) {
  const Group::Side &s0 = g.side[0], &s1 = g.side[1];
  const V nx0 = load<V>(s0.nx + lane), ny0 = load<V>(s0.ny + lane);
  const V nx1 = load<V>(s1.nx + lane), ny1 = load<V>(s1.ny + lane);
  const V na0 = load<V>(s0.na + lane), nb0 = load<V>(s0.nb + lane);
  const V na1 = load<V>(s1.na + lane), nb1 = load<V>(s1.nb + lane);
  const V k12 = load<V>(g.k12 + lane);
  const V none{};
  const V e0 = two.along(nx0, ny0, na0, nb0) - target0, e1 = two.along(nx1, ny1, na1, nb1) - target1;

  // both press
  const V i12 = load<V>(g.i12 + lane);
  const V both0 = l0 - (load<V>(g.i11 + lane) * e0 + i12 * e1);
  const V both1 = l1 - (i12 * e0 + load<V>(g.i22 + lane) * e1);
  const typename Of<V>::Mask together = (both0 >= none) & (both1 >= none);

  // one presses, the other's impulse taken back
  const V only0 = larger<V>(l0 - load<V>(g.r11 + lane) * (e0 - k12 * l1), none);
  const V left1 = e1 + k12 * (only0 - l0) - load<V>(g.k22 + lane) * l1;
  const V only1 = larger<V>(l1 - load<V>(g.r22 + lane) * (e1 - k12 * l0), none);
  const V left0 = e0 + k12 * (only1 - l1) - load<V>(g.k11 + lane) * l0;
  const typename Of<V>::Mask first = left1 >= left0;

  const V next0 = pick<V>(together, both0, pick<V>(first, only0, none));
  const V next1 = pick<V>(together, both1, pick<V>(first, none, only1));
  two.push(nx0, ny0, na0, nb0, next0 - l0);
  two.push(nx1, ny1, na1, nb1, next1 - l1);
  l0 = next0, l1 = next1;
}

template <class V>
OBSCURA_INLINE void start_all(const Group* groups, int count, Motion* v) {
  for (const Group* g = groups; g < groups + count; ++g) {
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Two<V> two(*g, lane, v);
      for (const Group::Side& s : g->side) {
        const V nx = load<V>(s.nx + lane), ny = load<V>(s.ny + lane);
        two.push(nx, ny, load<V>(s.na + lane), load<V>(s.nb + lane), load<V>(s.ln + lane));
        two.push(-ny, nx, load<V>(s.ta + lane), load<V>(s.tb + lane), load<V>(s.lt + lane));
      }
      two.back(*g, lane, v);
    }
  }
}

template <class V>
OBSCURA_INLINE void sweep_all(Group* groups, int count, Motion* v) {
  for (Group* g = groups; g < groups + count; ++g) {
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Two<V> two(*g, lane, v);
      const V mu = load<V>(g->mu + lane);
      for (Group::Side& s : g->side) {
        const V tx = -load<V>(s.ny + lane), ty = load<V>(s.nx + lane);
        const V ta = load<V>(s.ta + lane), tb = load<V>(s.tb + lane);
        const V lt = load<V>(s.lt + lane), most = mu * load<V>(s.ln + lane);
        const V wanted = lt - load<V>(s.mt + lane) * two.along(tx, ty, ta, tb);
        const V next = larger<V>(smaller<V>(wanted, most), -most);
        two.push(tx, ty, ta, tb, next - lt);
        store<V>(s.lt + lane, next);
      }
      Group::Side &s0 = g->side[0], &s1 = g->side[1];
      V l0 = load<V>(s0.ln + lane), l1 = load<V>(s1.ln + lane);
      press<V>(*g, lane, two, load<V>(s0.target + lane), load<V>(s1.target + lane), l0, l1);
      store<V>(s0.ln + lane, l0), store<V>(s1.ln + lane, l1);
      two.back(*g, lane, v);
    }
  }
}

template <class V>
OBSCURA_INLINE void project_all(const Group* groups, Projection* p, int count, Motion* d) {
  for (const Group* g = groups; g < groups + count; ++g, ++p) {
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Two<V> two(*g, lane, d);
      V l0 = load<V>(p->push[0] + lane), l1 = load<V>(p->push[1] + lane);
      press<V>(*g, lane, two, load<V>(p->target[0] + lane), load<V>(p->target[1] + lane), l0, l1);
      store<V>(p->push[0] + lane, l0), store<V>(p->push[1] + lane, l1);
      two.back(*g, lane, d);
    }
  }
}

#if defined(__x86_64__)
const bool kWide = __builtin_cpu_supports("avx2") != 0;
#define OBSCURA_WIDE __attribute__((target("avx2")))
OBSCURA_WIDE void start_wide(const Group* g, int count, Motion* v) { start_all<V4>(g, count, v); }
OBSCURA_WIDE void sweep_wide(Group* g, int count, Motion* v) { sweep_all<V4>(g, count, v); }
OBSCURA_WIDE void project_wide(const Group* g, Projection* p, int count, Motion* d) {
  project_all<V4>(g, p, count, d);
}
#else
constexpr bool kWide = false;
void start_wide(const Group*, int, Motion*) {}
void sweep_wide(Group*, int, Motion*) {}
void project_wide(const Group*, Projection*, int, Motion*) {}
#endif

}  // namespace

void start(const Group* groups, int count, Motion* v) {
  kWide ? start_wide(groups, count, v) : start_all<V2>(groups, count, v);
}
void sweep(Group* groups, int count, Motion* v) {
  kWide ? sweep_wide(groups, count, v) : sweep_all<V2>(groups, count, v);
}
void project(const Group* groups, Projection* projections, int count, Motion* d) {
  kWide ? project_wide(groups, projections, count, d) : project_all<V2>(groups, projections, count, d);
}

}  // namespace obscura::sim::sweep
