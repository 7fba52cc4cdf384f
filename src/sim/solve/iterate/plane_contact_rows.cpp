// One iteration of projected Gauss and Seidel. Of each pair in turn,
//   friction   lt' = clamp(lt - v_t / K_t, -mu ln, mu ln)
//   normals    ln >= 0,  v_n + K (ln' - ln) - target >= 0,  one of both zero in each touch
// the second by its cases: both press, one presses. If rounding leaves no case, the one less violated. The
// target is -gap / h at an open contact point, else zero; after an impact it is that of Impacts::least().
//
// Written once in vectors of the compiler; two lanes are SSE2, four AVX2. No operation differs, so the bits
// are the same.

#include "sim/solve/iterate/plane_contact_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim/math/lanes.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim::plane {

using namespace lanes;

namespace {

constexpr int kAhead = 4;         // groups
constexpr double kTiny = 1e-300;  // against division by zero in empty lanes: changes no other number

template <class V>
struct WideRow {
  V nx, ny, x, y, gap, na, nb, ta, tb;
};

// kMiddle: sharp corners on each other keep the normal with which the substep began; there their distance is
// next to nothing, and a short way turns it round
template <class V, bool kMiddle = false>
OBSCURA_INLINE void make(const ContactBatch& g, int lane, int k, const Quad<V>& a, const Quad<V>& b,
                         WideRow<V>& r) {
  // the corner's body, and the face's
  const Mask<V> swapped = mask<V>(g.of_b[k], lane);
  const V px = pick<V>(swapped, b.x, a.x), py = pick<V>(swapped, b.y, a.y);
  const V pc = pick<V>(swapped, b.z, a.z), ps = pick<V>(swapped, b.w, a.w);
  const V qx = pick<V>(swapped, a.x, b.x), qy = pick<V>(swapped, a.y, b.y);
  const V qc = pick<V>(swapped, a.z, b.z), qs = pick<V>(swapped, a.w, b.w);
  const V cx = load<V>(g.cx[k] + lane), cy = load<V>(g.cy[k] + lane);
  const V fx = load<V>(g.fx[k] + lane), fy = load<V>(g.fy[k] + lane);
  const V d = load<V>(g.d[k] + lane), radius = load<V>(g.radius + lane);
  const V x = px + (pc * cx - ps * cy), y = py + (ps * cx + pc * cy);
  const V nx = qc * fx - qs * fy, ny = qs * fx + qc * fy;
  r.gap = nx * (x - qx) + ny * (y - qy) - d - radius;
  const V back = radius + 0.5 * r.gap;
  r.x = x - nx * back, r.y = y - ny * back;
  r.nx = pick<V>(swapped, -nx, nx), r.ny = pick<V>(swapped, -ny, ny);
  if (g.corners[k]) {
    // two corners: from b's to a's
    const Mask<V> two = mask<V>(g.corners[k], lane);
    const V ox = qx + nx, oy = qy + ny;
    const V ux = x - ox, uy = y - oy;
    const V l = root(ux * ux + uy * uy);
    const Mask<V> apart =
        l > 1e-12 * (d + radius + magnitude<V>(fx) + magnitude<V>(fy) + magnitude<V>(cx) + magnitude<V>(cy));
    const V one = V{} + 1.0;
    const V safe = pick<V>(apart, l, one);
    V mx = pick<V>(apart, ux / safe, V{}), my = pick<V>(apart, uy / safe, one);
    if constexpr (kMiddle) {
      const Mask<V> sharp = radius <= V{};
      mx = pick<V>(sharp, load<V>(g.ux[k] + lane), mx), my = pick<V>(sharp, load<V>(g.uy[k] + lane), my);
    }
    const V gap = l - radius, along = d + 0.5 * gap;
    r.gap = pick<V>(two, gap, r.gap);
    r.nx = pick<V>(two, mx, r.nx), r.ny = pick<V>(two, my, r.ny);
    r.x = pick<V>(two, ox + mx * along, r.x), r.y = pick<V>(two, oy + my * along, r.y);
  }
  const V ax = r.x - a.x, ay = r.y - a.y, bx = r.x - b.x, by = r.y - b.y;
  r.na = ax * r.ny - ay * r.nx, r.nb = bx * r.ny - by * r.nx;
  r.ta = ax * r.nx + ay * r.ny, r.tb = bx * r.nx + by * r.ny;
}

// the two bodies of each lane under impulses
template <class V>
struct Two {
  Quad<V> a, b;  // velocities, and 1 / mass
  V iia, iib;

  OBSCURA_INLINE Two(const ContactBatch& g, int lane, const Motion* v) {
    gather(&v->x, g.a + lane, a), gather(&v->x, g.b + lane, b);
    iia = load<V>(g.iia + lane), iib = load<V>(g.iib + lane);
  }
  OBSCURA_INLINE void back(const ContactBatch& g, int lane, Motion* v) const {
    scatter(&v->x, g.a + lane, a), scatter(&v->x, g.b + lane, b);
  }
  // only where `moves`; elsewhere as before
  OBSCURA_INLINE void keep(const Mask<V>& moves, const Two& before) {
    a.x = pick<V>(moves, a.x, before.a.x), a.y = pick<V>(moves, a.y, before.a.y),
    a.z = pick<V>(moves, a.z, before.a.z);
    b.x = pick<V>(moves, b.x, before.b.x), b.y = pick<V>(moves, b.y, before.b.y),
    b.z = pick<V>(moves, b.z, before.b.z);
  }
  OBSCURA_INLINE V along(const V& dx, const V& dy, const V& ra, const V& rb) const {
    return dx * (a.x - b.x) + dy * (a.y - b.y) + (ra * a.z - rb * b.z);
  }
  OBSCURA_INLINE void push(const V& dx, const V& dy, const V& ra, const V& rb, const V& l) {
    const V la = a.w * l, lb = b.w * l;
    a.x += dx * la, a.y += dy * la, a.z += iia * (ra * l);
    b.x -= dx * lb, b.y -= dy * lb, b.z -= iib * (rb * l);
  }
};

// the normal impulses of a pair together
template <class V>
OBSCURA_INLINE void solve_normals(Two<V>& two, const WideRow<V>& r0, const WideRow<V>& r1, const V& target0,
                                  const V& target1, V& l0, V& l1) {
  const V none{};
  const V im = two.a.w + two.b.w;
  const V k11 = im + (two.iia * (r0.na * r0.na) + two.iib * (r0.nb * r0.nb));
  const V k22 = im + (two.iia * (r1.na * r1.na) + two.iib * (r1.nb * r1.nb));
  const V k12 =
      im * (r0.nx * r1.nx + r0.ny * r1.ny) + (two.iia * (r0.na * r1.na) + two.iib * (r0.nb * r1.nb));
  const V e0 = two.along(r0.nx, r0.ny, r0.na, r0.nb) - target0,
          e1 = two.along(r1.nx, r1.ny, r1.na, r1.nb) - target1;

  // both press
  const V det = k11 * k22 - k12 * k12, over = 1.0 / (det + kTiny);
  const V both0 = l0 - (k22 * e0 - k12 * e1) * over, both1 = l1 - (k11 * e1 - k12 * e0) * over;
  const Mask<V> together = (both0 >= none) & (both1 >= none) & (det > 1e-8 * (k11 * k22));

  // one presses, the other's impulse taken back
  V next0 = both0, next1 = both1;
  if (any(~together)) {
    const V only0 = larger<V>(l0 - (e0 - k12 * l1) / (k11 + kTiny), none);
    const V left1 = e1 + k12 * (only0 - l0) - k22 * l1;
    const V only1 = larger<V>(l1 - (e1 - k12 * l0) / (k22 + kTiny), none);
    const V left0 = e0 + k12 * (only1 - l1) - k11 * l0;
    const Mask<V> first = left1 >= left0;
    next0 = pick<V>(together, both0, pick<V>(first, only0, none));
    next1 = pick<V>(together, both1, pick<V>(first, none, only1));
  }
  two.push(r0.nx, r0.ny, r0.na, r0.nb, next0 - l0);
  two.push(r1.nx, r1.ny, r1.na, r1.nb, next1 - l1);
  l0 = next0, l1 = next1;
}

// `surface`: what belts and arms that turn add to the speed across, of four pairs; null: nothing
template <class V>
OBSCURA_INLINE void solve_friction(Two<V>& two, const WideRow<V>& r, const V& most, V& lt,
                                   const double* surface = nullptr) {
  const V tx = -r.ny, ty = r.nx;
  const V kt = (two.a.w + two.b.w) + (two.iia * (r.ta * r.ta) + two.iib * (r.tb * r.tb));
  V slips = two.along(tx, ty, r.ta, r.tb);
  if (surface) slips += load<V>(surface);
  const V wanted = lt - slips / (kt + kTiny);
  const V next = larger<V>(smaller<V>(wanted, most), -most);
  two.push(tx, ty, r.ta, r.tb, next - lt);
  lt = next;
}

template <class V>
OBSCURA_INLINE void expand_one(const ContactBatch& g, const Pose* poses, Rows& out) {
  for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
    Quad<V> a, b;
    gather(&poses->x, g.a + lane, a), gather(&poses->x, g.b + lane, b);
    for (int k = 0; k < 2; ++k) {
      WideRow<V> r;
      make<V>(g, lane, k, a, b, r);
      store<V>(out.nx[k] + lane, r.nx), store<V>(out.ny[k] + lane, r.ny);
      store<V>(out.x[k] + lane, r.x), store<V>(out.y[k] + lane, r.y), store<V>(out.gap[k] + lane, r.gap);
      store<V>(out.na[k] + lane, r.na), store<V>(out.nb[k] + lane, r.nb);
      store<V>(out.ta[k] + lane, r.ta), store<V>(out.tb[k] + lane, r.tb);
    }
  }
}

template <class V>
OBSCURA_INLINE V allowed_depth(const ContactBatch& g, int lane, const AllowedOverlap& let) {
  return let.least * load<V>(g.far + lane) + let.share / load<V>(g.per_width + lane);
}

template <class V>
OBSCURA_INLINE bool warm_start_all(ContactBatch* batches, int count, const Pose* poses, const Pose* middle,
                                   const Motion* old, Motion* v, const StepConstants& pace, LaneList& closing,
                                   LaneList& impacts) {
  const V h = V{} + pace.h, creep = V{} - pace.min_closing_speed, gain = V{} + pace.gravity_dv, none{};
  const V bend = 0.5 * (h * h);
  Mask<V> deep{};
  for (int i = 0; i < count; ++i) {
    ContactBatch& g = batches[i];
    g.struck[0] = g.struck[1] = 0;
    if (!g.used) continue;
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b, a_middle, b_middle;
      gather(&poses->x, g.a + lane, a), gather(&poses->x, g.b + lane, b);
      gather(&middle->x, g.a + lane, a_middle), gather(&middle->x, g.b + lane, b_middle);
      const Two<V> before(g, lane, old);
      Two<V> two(g, lane, v);
      const V mu = load<V>(g.mu + lane);
      const V sight = load<V>(g.sight + lane), allowed = allowed_depth<V>(g, lane, pace.allowed);
      // What turns may come sooner than along its tangent: gap'' >= -(w_a^2 + w_b^2) r - 2 w_b v_t. Of two
      // corners of polygons others may come nearer, however these move.
      const V w2 = before.a.z * before.a.z + before.b.z * before.b.z;
      const V w = magnitude<V>(before.a.z) + magnitude<V>(before.b.z);
      const V v1 = magnitude<V>(before.a.x - before.b.x) + magnitude<V>(before.a.y - before.b.y);
      const V far = load<V>(g.far + lane);
      const V fastest = v1 + far * w, turning = far * w2 + 2.0 * w * fastest;
      const V turns = bend * turning, sooner = h * turning;
      const V impact_speed = load<V>(g.impact_speed + lane);
      const Mask<V> polygons = load<V>(g.radius + lane) <= none;
      const V nearby = (V{} + kNearby) / load<V>(g.per_width + lane), belt = load<V>(g.belt + lane);
      Mask<V> slow{}, fast{};
      for (int k = 0; k < 2; ++k) {
        WideRow<V> r;
        make<V>(g, lane, k, a, b, r);
        const V vn = before.along(r.nx, r.ny, r.na, r.nb);
        deep |= r.gap < -allowed;
        const V px = load<V>(g.p[k] + lane), py = load<V>(g.q[k] + lane);
        const Mask<V> bears = px * r.nx + py * r.ny > none;
        const Mask<V> strikes = ~(bears & (vn >= -kLasting * fastest));
        slow |= strikes & (vn < creep) & (r.gap + h * vn < none) & (r.gap <= sight);
        fast |= strikes & (vn - sooner < impact_speed) & (r.gap + h * (vn - gain) < turns) & (r.gap <= sight);
        if (g.corners[k])
          fast |= mask<V>(g.corners[k], lane) & polygons & (-fastest < impact_speed) &
                  (r.gap < h * (fastest + gain));
        store<V>(g.gap[k] + lane, r.gap);
        if (g.corners[k]) store<V>(g.ux[k] + lane, r.nx), store<V>(g.uy[k] + lane, r.ny);
        const Mask<V> near = r.gap < nearby;
        const V vt = before.along(-r.ny, r.nx, r.ta, r.tb);
        make<V, true>(g, lane, k, a_middle, b_middle, r);
        const V gains = before.along(r.nx, r.ny, r.na, r.nb) - vn;
        store<V>(g.turns[k] + lane, pick<V>(near, pick<V>(bears, gains, larger<V>(gains, none)), none));
        store<V>(g.surface[k] + lane, belt + pick<V>(near, before.along(-r.ny, r.nx, r.ta, r.tb) - vt, none));
        const V ln = larger<V>(h * (px * r.nx + py * r.ny), none), most = mu * ln;
        const V lt = larger<V>(smaller<V>(h * (py * r.nx - px * r.ny), most), -most);
        store<V>(g.p[k] + lane, ln), store<V>(g.q[k] + lane, lt);
        two.push(r.nx, r.ny, r.na, r.nb, ln);
        two.push(-r.ny, r.nx, r.ta, r.tb, lt);
      }
      two.back(g, lane, v);
      if (!any(slow | fast)) continue;
      for (int k = 0; k < Of<V>::lanes; ++k) {
        if (fast[k]) {
          impacts.push_back(kLanes * i + lane + k);
        } else if (slow[k]) {
          closing.push_back(kLanes * i + lane + k);
        }
      }
    }
  }
  return any(deep);
}

// impulses of an iteration along normals and tangents, N s
struct Impulses {
  alignas(32) double n[2][kLanes], t[2][kLanes];
};

OBSCURA_INLINE void store_contacts(const ContactBatch& g, const Rows& rows, const Impulses& impulses,
                                   Contact<2>* contacts) {
  for (int lane = 0; lane < kLanes; ++lane) {
    if (g.pair[lane] < 0) continue;
    Contact<2>* c = contacts + g.first[lane];
    for (int k = 0; k < g.touches[lane]; ++k, ++c) {
      c->point[0] = rows.x[k][lane], c->point[1] = rows.y[k][lane];
      c->normal[0] = rows.nx[k][lane], c->normal[1] = rows.ny[k][lane];
      c->gap = rows.gap[k][lane];
      c->force[0] = g.p[k][lane], c->force[1] = g.q[k][lane];
      c->impulse[0] = c->impulse[1] = 0;
      const double ln = impulses.n[k][lane], lt = impulses.t[k][lane];
      c->touching = ln <= 0                           ? ContactMode::open
                    : std::fabs(lt) < g.mu[lane] * ln ? ContactMode::stick
                                                      : ContactMode::slide;
    }
  }
}

template <class V>
OBSCURA_INLINE double largest(const V& v) {
  double most = v[0];
  for (int k = 1; k < Of<V>::lanes; ++k) most = std::max(most, v[k]);
  return most;
}

template <class V>
OBSCURA_INLINE double closing_rate_all(const ContactBatch* batches, int count, const Pose* poses,
                                       const Motion* v, double step) {
  const V none{}, h = V{} + step;
  V most{};
  for (const ContactBatch* g = batches; g < batches + count; ++g) {
    if (!g->used) continue;
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b;
      gather(&poses->x, g->a + lane, a), gather(&poses->x, g->b + lane, b);
      const Two<V> two(*g, lane, v);
      const V per_width = load<V>(g->per_width + lane);
      const Mask<V> polygons = load<V>(g->radius + lane) <= none;
      const V dx = two.a.x - two.b.x, dy = two.a.y - two.b.y;
      const V speed =
          root(dx * dx + dy * dy) + load<V>(g->far + lane) * (magnitude<V>(two.a.z) + magnitude<V>(two.b.z));
      const V passes = pick<V>(polygons, kPassing * speed, none);
      for (int k = 0; k < 2; ++k) {
        WideRow<V> r;
        make<V>(*g, lane, k, a, b, r);
        const V closes = larger<V>(-two.along(r.nx, r.ny, r.na, r.nb), passes);
        most = larger<V>(most,
                         pick<V>((r.gap - h * closes) * per_width < V{} + kNearly, closes * per_width, none));
      }
    }
  }
  return largest<V>(most);
}

// the lanes of a group whose bodies are active, a bit each
inline unsigned char active_lanes(const ContactBatch& g, const unsigned char* bodies) {
  unsigned lanes = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const unsigned flags = unsigned(bodies[g.a[lane]]) | bodies[g.b[lane]];
    lanes |= unsigned((flags & (ActiveBodies::kNow | ActiveBodies::kNever)) == ActiveBodies::kNow) << lane;
  }
  return static_cast<unsigned char>(lanes);
}

// all pairs; or, where kSome, those of bodies that are active, and then how many these are
template <class V, bool kLast, bool kKeep, bool kSome = false>
OBSCURA_INLINE int iterate_all(ContactBatch* batches, int count, const Pose* poses, Motion* v,
                               const StepConstants& pace, Contact<2>* contacts,
                               ActiveBodies* active = nullptr, [[maybe_unused]] const int* listed = nullptr) {
  const V per_h = V{} + 1 / pace.h, none{};
  [[maybe_unused]] int pairs = 0;
  for (int number = 0; number < count; ++number) {
    ContactBatch* const g = batches + (listed ? listed[number] : number);
    if (!g->used) continue;
    [[maybe_unused]] unsigned char lanes = 0;
    if constexpr (kSome) {
      lanes = active_lanes(*g, active->bodies.data());
      if (lanes == 0) continue;
      pairs += std::popcount(lanes);
    }
    [[maybe_unused]] Rows kept;
    [[maybe_unused]] Impulses impulses;
    if constexpr (kKeep) {
      // contacts are far apart in memory: ask for those of a later group
      if (g + kAhead < batches + count) {
        for (int lane = 0; lane < kLanes; ++lane) {
          const char* at = reinterpret_cast<const char*>(contacts + g[kAhead].first[lane]);
          __builtin_prefetch(at, 1), __builtin_prefetch(at + 64, 1), __builtin_prefetch(at + 128, 1);
        }
      }
    }
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b;
      gather(&poses->x, g->a + lane, a), gather(&poses->x, g->b + lane, b);
      WideRow<V> r0, r1;
      make<V, true>(*g, lane, 0, a, b, r0), make<V, true>(*g, lane, 1, a, b, r1);
      r0.gap = load<V>(g->gap[0] + lane), r1.gap = load<V>(g->gap[1] + lane);
      Two<V> two(*g, lane, v);
      const V mu = load<V>(g->mu + lane);
      V l0 = load<V>(g->p[0] + lane), t0 = load<V>(g->q[0] + lane);
      V l1 = load<V>(g->p[1] + lane), t1 = load<V>(g->q[1] + lane);
      [[maybe_unused]] const Two<V> begun = two;
      [[maybe_unused]] const V begun_l0 = l0, begun_t0 = t0, begun_l1 = l1, begun_t1 = t1;
      solve_friction<V>(two, r0, mu * l0, t0, g->surface[0] + lane);
      solve_friction<V>(two, r1, mu * l1, t1, g->surface[1] + lane);
      const V sight = load<V>(g->sight + lane), never = V{} + kNoAim;
      const V open0 =
          pick<V>(r0.gap > sight, never, smaller<V>(-r0.gap * per_h, none) - load<V>(g->turns[0] + lane));
      const V open1 =
          pick<V>(r1.gap > sight, never, smaller<V>(-r1.gap * per_h, none) - load<V>(g->turns[1] + lane));
      V target0 = open0, target1 = open1;
      if (g->struck[0] | g->struck[1]) {
        const TargetSpeeds& least = pace.least[g - batches];
        target0 = pick<V>(mask<V>(g->struck[0], lane), load<V>(least.n[0] + lane), open0);
        target1 = pick<V>(mask<V>(g->struck[1], lane), load<V>(least.n[1] + lane), open1);
      }
      if constexpr (kSome) {
        const V left0 = target0 - two.along(r0.nx, r0.ny, r0.na, r0.nb),
                left1 = target1 - two.along(r1.nx, r1.ny, r1.na, r1.nb);
        const V wrong0 = pick<V>(l0 > none, magnitude<V>(left0), left0),
                wrong1 = pick<V>(l1 > none, magnitude<V>(left1), left1);
        const V wrong = larger<V>(wrong0, wrong1) * load<V>(g->per_width + lane);
        for (int k = 0; k < Of<V>::lanes; ++k) {
          if (!(lanes >> (lane + k) & 1) || !(wrong[k] > active->settled)) continue;
          active->next[g->a[lane + k]] = active->next[g->b[lane + k]] = 1;
        }
      }
      solve_normals<V>(two, r0, r1, target0, target1, l0, l1);
      if constexpr (kSome) {
        // the other lanes stay: the result of a pair must not depend on the lanes beside its own
        const Mask<V> moves = mask<V>(lanes, lane);
        two.keep(moves, begun);
        l0 = pick<V>(moves, l0, begun_l0), t0 = pick<V>(moves, t0, begun_t0);
        l1 = pick<V>(moves, l1, begun_l1), t1 = pick<V>(moves, t1, begun_t1);
      }
      two.back(*g, lane, v);
      if constexpr (!kLast) {
        store<V>(g->p[0] + lane, l0), store<V>(g->q[0] + lane, t0);
        store<V>(g->p[1] + lane, l1), store<V>(g->q[1] + lane, t1);
      } else {
        const V fn0 = l0 * per_h, ft0 = t0 * per_h, fn1 = l1 * per_h, ft1 = t1 * per_h;
        store<V>(g->p[0] + lane, fn0 * r0.nx - ft0 * r0.ny),
            store<V>(g->q[0] + lane, fn0 * r0.ny + ft0 * r0.nx);
        store<V>(g->p[1] + lane, fn1 * r1.nx - ft1 * r1.ny),
            store<V>(g->q[1] + lane, fn1 * r1.ny + ft1 * r1.nx);
      }
      if constexpr (kKeep) {
        store<V>(kept.nx[0] + lane, r0.nx), store<V>(kept.ny[0] + lane, r0.ny);
        store<V>(kept.nx[1] + lane, r1.nx), store<V>(kept.ny[1] + lane, r1.ny);
        store<V>(kept.x[0] + lane, r0.x), store<V>(kept.y[0] + lane, r0.y),
            store<V>(kept.gap[0] + lane, r0.gap);
        store<V>(kept.x[1] + lane, r1.x), store<V>(kept.y[1] + lane, r1.y),
            store<V>(kept.gap[1] + lane, r1.gap);
        store<V>(impulses.n[0] + lane, l0), store<V>(impulses.t[0] + lane, t0);
        store<V>(impulses.n[1] + lane, l1), store<V>(impulses.t[1] + lane, t1);
      }
    }
    if constexpr (kKeep) store_contacts(*g, kept, impulses, contacts);
  }
  if constexpr (kSome) return pairs;
  return 0;
}

template <class V>
OBSCURA_INLINE void follow_all(ContactBatch* batches, int count, const Pose* poses, Motion* v,
                               LaneImpulses* before, LaneImpulses* directions, double share,
                               const ActiveBodies& active) {
  const V none{}, by = V{} + share;
  for (ContactBatch* g = batches; g < batches + count; ++g, ++before, ++directions) {
    unsigned char on = 0;
    for (int lane = 0; g->used && lane < kLanes; ++lane) {
      if (g->pair[lane] >= 0 &&
          !((active.bodies[g->a[lane]] | active.bodies[g->b[lane]]) & ActiveBodies::kNever))
        on = static_cast<unsigned char>(on | 1 << lane);
    }
    if (!on) continue;
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b;
      gather(&poses->x, g->a + lane, a), gather(&poses->x, g->b + lane, b);
      Two<V> two(*g, lane, v);
      const Two<V> begun = two;
      const V mu = load<V>(g->mu + lane);
      const Mask<V> moves = mask<V>(on, lane);
      const auto set = [&](double* to, const V& next) { store<V>(to, pick<V>(moves, next, load<V>(to))); };
      for (int k = 0; k < 2; ++k) {
        WideRow<V> r;
        make<V, true>(*g, lane, k, a, b, r);
        const V l0 = load<V>(g->p[k] + lane), t0 = load<V>(g->q[k] + lane);
        const V dl = by * load<V>(directions->p[k] + lane), dt = by * load<V>(directions->q[k] + lane);
        set(directions->p[k] + lane, dl + (l0 - load<V>(before->p[k] + lane)));
        set(directions->q[k] + lane, dt + (t0 - load<V>(before->q[k] + lane)));
        const V l = larger<V>(l0 + dl, none), most = mu * l;
        const V t = larger<V>(smaller<V>(t0 + dt, most), -most);
        two.push(r.nx, r.ny, r.na, r.nb, l - l0), two.push(-r.ny, r.nx, r.ta, r.tb, t - t0);
        set(g->p[k] + lane, l), set(g->q[k] + lane, t);
        set(before->p[k] + lane, l), set(before->q[k] + lane, t);
      }
      two.keep(moves, begun);
      two.back(*g, lane, v);
    }
  }
}

template <class V>
OBSCURA_INLINE void project_all(const ContactBatch* batches, Projection* p, int count, const Pose* poses,
                                Motion* d, double share, AllowedOverlap let) {
  const V none{}, part = V{} + share;
  for (const ContactBatch* g = batches; g < batches + count; ++g, ++p) {
    if (!g->used) continue;
    for (int lane = 0; lane < kLanes; lane += Of<V>::lanes) {
      Quad<V> a, b;
      gather(&poses->x, g->a + lane, a), gather(&poses->x, g->b + lane, b);
      WideRow<V> r0, r1;
      make<V>(*g, lane, 0, a, b, r0), make<V>(*g, lane, 1, a, b, r1);
      Two<V> two(*g, lane, d);
      const V mu = load<V>(g->mu + lane), allowed = allowed_depth<V>(*g, lane, let);
      V l0 = load<V>(p->push[0] + lane), l1 = load<V>(p->push[1] + lane);
      V t0 = load<V>(p->side[0] + lane), t1 = load<V>(p->side[1] + lane);
      solve_friction<V>(two, r0, mu * l0, t0);
      solve_friction<V>(two, r1, mu * l1, t1);
      const V over0 = r0.gap + allowed, over1 = r1.gap + allowed;
      solve_normals<V>(two, r0, r1, pick<V>(over0 < none, -part * over0, -over0),
                       pick<V>(over1 < none, -part * over1, -over1), l0, l1);
      store<V>(p->push[0] + lane, l0), store<V>(p->push[1] + lane, l1);
      store<V>(p->side[0] + lane, t0), store<V>(p->side[1] + lane, t1);
      two.back(*g, lane, d);
    }
  }
}

OBSCURA_WIDE void expand_wide(const ContactBatch& s, const Pose* at, Rows& out) {
  expand_one<V4>(s, at, out);
}
OBSCURA_WIDE bool warm_start_wide(ContactBatch* s, int n, const Pose* at, const Pose* middle,
                                  const Motion* old, Motion* v, const StepConstants& pace, LaneList& closing,
                                  LaneList& impacts) {
  return warm_start_all<V4>(s, n, at, middle, old, v, pace, closing, impacts);
}
OBSCURA_WIDE double closing_rate_wide(const ContactBatch* s, int n, const Pose* at, const Motion* v,
                                      double h) {
  return closing_rate_all<V4>(s, n, at, v, h);
}
OBSCURA_WIDE void iterate_wide(ContactBatch* s, int n, const Pose* at, Motion* v, const StepConstants& pace) {
  iterate_all<V4, false, false>(s, n, at, v, pace, nullptr);
}
OBSCURA_WIDE int iterate_some_wide(ContactBatch* s, const int* listed, int n, const Pose* at, Motion* v,
                                   const StepConstants& pace, ActiveBodies& active) {
  return iterate_all<V4, false, false, true>(s, n, at, v, pace, nullptr, &active, listed);
}
OBSCURA_WIDE void iterate_last_wide(ContactBatch* s, int n, const Pose* at, Motion* v,
                                    const StepConstants& pace, Contact<2>* contacts) {
  contacts ? iterate_all<V4, true, true>(s, n, at, v, pace, contacts)
           : iterate_all<V4, true, false>(s, n, at, v, pace, nullptr);
}
OBSCURA_WIDE void follow_wide(ContactBatch* s, int n, const Pose* at, Motion* v, LaneImpulses* before,
                              LaneImpulses* directions, double share, const ActiveBodies& active) {
  follow_all<V4>(s, n, at, v, before, directions, share, active);
}
OBSCURA_WIDE void project_wide(const ContactBatch* s, Projection* p, int n, const Pose* at, Motion* d,
                               double share, AllowedOverlap let) {
  project_all<V4>(s, p, n, at, d, share, let);
}

}  // namespace

void copy_lane_forces(const ContactBatch& from, int i, ContactBatch& to, int k) {
  for (int side = 0; side < 2; ++side) to.p[side][k] = from.p[side][i], to.q[side][k] = from.q[side][i];
}
void copy_lane(const ContactBatch& from, int i, ContactBatch& to, int k) {
  to.a[k] = from.a[i], to.b[k] = from.b[i], to.pair[k] = from.pair[i], to.first[k] = from.first[i];
  to.touches[k] = from.touches[i], to.used = static_cast<unsigned char>(to.used | 1 << k);
  to.mu[k] = from.mu[i], to.iia[k] = from.iia[i], to.iib[k] = from.iib[i];
  to.calm[k] = from.calm[i], to.far[k] = from.far[i], to.impact_speed[k] = from.impact_speed[i],
  to.radius[k] = from.radius[i];
  to.sight[k] = from.sight[i], to.per_width[k] = from.per_width[i], to.belt[k] = from.belt[i];
  to.belts = static_cast<unsigned char>((to.belts & ~(1 << k)) | (from.belts >> i & 1) << k);
  for (int side = 0; side < 2; ++side) {
    to.cx[side][k] = from.cx[side][i], to.cy[side][k] = from.cy[side][i];
    to.fx[side][k] = from.fx[side][i], to.fy[side][k] = from.fy[side][i], to.d[side][k] = from.d[side][i];
    const auto bit = [&](unsigned char bits, unsigned char& out) {
      out = static_cast<unsigned char>((out & ~(1 << k)) | (bits >> i & 1) << k);
    };
    bit(from.of_b[side], to.of_b[side]), bit(from.corners[side], to.corners[side]);
    to.words[side][k] = from.words[side][i];
  }
  copy_lane_forces(from, i, to, k);
}

void expand(const ContactBatch& s, const Pose* at, Rows& out) {
  four_lanes ? expand_wide(s, at, out) : expand_one<V2>(s, at, out);
}

namespace {

void set_arms(TouchRow& r, const Pose& a, const Pose& b) {
  const double ax = r.x - a.x, ay = r.y - a.y, bx = r.x - b.x, by = r.y - b.y;
  r.na = ax * r.ny - ay * r.nx, r.nb = bx * r.ny - by * r.nx;
  r.ta = ax * r.nx + ay * r.ny, r.tb = bx * r.nx + by * r.ny;
}

}  // namespace

TouchRow row(const ContactBatch& g, int lane, int k, const Pose& a, const Pose& b) {
  const bool swapped = g.of_b[k] >> lane & 1;
  const Pose &p = swapped ? b : a, &q = swapped ? a : b;
  const double cx = g.cx[k][lane], cy = g.cy[k][lane], fx = g.fx[k][lane], fy = g.fy[k][lane];
  const double d = g.d[k][lane], radius = g.radius[lane];
  const double x = p.x + (p.c * cx - p.s * cy), y = p.y + (p.s * cx + p.c * cy);
  const double nx = q.c * fx - q.s * fy, ny = q.s * fx + q.c * fy;
  TouchRow r;
  if (g.corners[k] >> lane & 1) {
    const double ox = q.x + nx, oy = q.y + ny, ux = x - ox, uy = y - oy;
    const double l = std::sqrt(ux * ux + uy * uy);
    const bool apart =
        l > 1e-12 * (d + radius + std::fabs(fx) + std::fabs(fy) + std::fabs(cx) + std::fabs(cy));
    r.nx = apart ? ux / l : 0, r.ny = apart ? uy / l : 1, r.gap = l - radius;
    const double along = d + 0.5 * r.gap;
    r.x = ox + r.nx * along, r.y = oy + r.ny * along;
  } else {
    r.gap = nx * (x - q.x) + ny * (y - q.y) - d - radius;
    const double back = radius + 0.5 * r.gap;
    r.x = x - nx * back, r.y = y - ny * back;
    r.nx = swapped ? -nx : nx, r.ny = swapped ? -ny : ny;
  }
  set_arms(r, a, b);
  return r;
}

TouchRow middle_row(const ContactBatch& g, int lane, int k, const Pose& a, const Pose& b) {
  TouchRow r = row(g, lane, k, a, b);
  if ((g.corners[k] >> lane & 1) && g.radius[lane] <= 0) {
    const double along = g.d[k][lane] + 0.5 * r.gap;
    const double ox = r.x - r.nx * along, oy = r.y - r.ny * along;
    r.nx = g.ux[k][lane], r.ny = g.uy[k][lane];
    r.x = ox + r.nx * along, r.y = oy + r.ny * along;
    set_arms(r, a, b);
  }
  r.gap = g.gap[k][lane];
  return r;
}

bool warm_start(ContactBatch* s, int n, const Pose* at, const Pose* middle, const Motion* old, Motion* v,
                const StepConstants& pace, LaneList& closing, LaneList& impacts) {
  closing.clear(), impacts.clear();
  return four_lanes ? warm_start_wide(s, n, at, middle, old, v, pace, closing, impacts)
                    : warm_start_all<V2>(s, n, at, middle, old, v, pace, closing, impacts);
}
double closing_rate(const ContactBatch* s, int n, const Pose* at, const Motion* v, double h) {
  return four_lanes ? closing_rate_wide(s, n, at, v, h) : closing_rate_all<V2>(s, n, at, v, h);
}
void iterate(ContactBatch* s, int n, const Pose* at, Motion* v, const StepConstants& pace) {
  if (four_lanes) return iterate_wide(s, n, at, v, pace);
  iterate_all<V2, false, false>(s, n, at, v, pace, nullptr);
}
int iterate(ContactBatch* s, const int* listed, int n, const Pose* at, Motion* v, const StepConstants& pace,
            ActiveBodies& active) {
  return four_lanes ? iterate_some_wide(s, listed, n, at, v, pace, active)
                    : iterate_all<V2, false, false, true>(s, n, at, v, pace, nullptr, &active, listed);
}
void activate_next(ActiveBodies& active) {
  active.next.back() = 0;  // walls are never active
  unsigned char* const __restrict flags = active.bodies.data();
  unsigned char* const __restrict noted = active.next.data();
  static_assert(ActiveBodies::kNow == 1, "as what is noted");
  const auto next = [&](std::size_t body) {
    flags[body] = static_cast<unsigned char>((flags[body] & ActiveBodies::kNever) | noted[body]);
    noted[body] = 0;
  };
  if (active.groups.empty()) {
    const std::size_t count = active.bodies.size();
    for (std::size_t body = 0; body < count; ++body) next(body);
  } else {
    for (const int body : active.listed) next(std::size_t(body));
  }
}
void follow(ContactBatch* s, int n, const Pose* at, Motion* v, LaneImpulses* before, LaneImpulses* directions,
            double share, const ActiveBodies& active) {
  four_lanes ? follow_wide(s, n, at, v, before, directions, share, active)
             : follow_all<V2>(s, n, at, v, before, directions, share, active);
}
void iterate_last(ContactBatch* s, int n, const Pose* at, Motion* v, const StepConstants& pace,
                  Contact<2>* contacts) {
  if (four_lanes) return iterate_last_wide(s, n, at, v, pace, contacts);
  contacts ? iterate_all<V2, true, true>(s, n, at, v, pace, contacts)
           : iterate_all<V2, true, false>(s, n, at, v, pace, nullptr);
}
void project(const ContactBatch* s, Projection* p, int n, const Pose* at, Motion* d, double share,
             AllowedOverlap allowed) {
  four_lanes ? project_wide(s, p, n, at, d, share, allowed) : project_all<V2>(s, p, n, at, d, share, allowed);
}

}  // namespace obscura::sim::plane
