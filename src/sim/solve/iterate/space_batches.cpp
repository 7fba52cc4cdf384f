// One iteration of projected Gauss and Seidel in space. Of each contact in turn,
//   normal     l_n' = max(0, l_n + (least - n . u) / K_n)                       u  slip of a against b, m/s
//   friction   l_t' = cut(l_t - (u - n n . u + askew (l_n' - l_n)) / K_t)       to |l_t'| <= mu l_n'
// K_t is the larger eigenvalue of K across n: a step along the velocity, cut back, holds a sliding box with
// exactly mu N, which one by the inverse block would not. Friction comes after the normal impulse: were both
// found from one velocity, iterations of rough contacts would diverge.
//
// Written once in vectors of the compiler; two lanes are SSE2, four AVX2. No operation differs, so the bits
// are the same.

#include "sim/solve/iterate/space_batches.h"

#include <algorithm>
#include <bit>

#include "sim/math/lanes.h"
#include "sim/solve/iterate/pieces.h"

namespace obscura::sim {

namespace {

using namespace lanes;

constexpr int kMostSorted = 8;  // contacts: pairs of more come first, as they come
constexpr int kBodyFours = 5;   // numbers of a PointBody, in fours
static_assert(sizeof(PointBody<3>) == 4 * kBodyFours * sizeof(double));

template <class V>
struct Wide3 {
  V x, y, z;
};
template <class V>
OBSCURA_INLINE Wide3<V> load3(const double (&from)[3][4], int lane) {
  return {load<V>(from[0] + lane), load<V>(from[1] + lane), load<V>(from[2] + lane)};
}
template <class V>
OBSCURA_INLINE void store3(double (&to)[3][4], int lane, const Wide3<V>& v) {
  store<V>(to[0] + lane, v.x), store<V>(to[1] + lane, v.y), store<V>(to[2] + lane, v.z);
}
template <class V>
struct Symmetric {
  V xx, xy, xz, yy, yz, zz;
};
template <class V>
OBSCURA_INLINE V inner(const Wide3<V>& p, const Wide3<V>& q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
template <class V>
OBSCURA_INLINE Wide3<V> outer(const Wide3<V>& p, const Wide3<V>& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

// one body of each lane
template <class V>
struct WideBody {
  Quad<V> v, w;                    // m/s and 1/kg; rad/s
  V i00, i10, i20, i11, i21, i22;  // inverse inertia

  OBSCURA_INLINE WideBody(const double* bodies, const int* at) {
    Quad<V> first, second, third;
    gather(bodies, at, v), gather(bodies + 4, at, w);
    gather(bodies + 8, at, first), gather(bodies + 12, at, second), gather(bodies + 16, at, third);
    i00 = first.x, i10 = first.y, i20 = first.z, i11 = second.x, i21 = second.y, i22 = third.x;
  }
  OBSCURA_INLINE void back(double* bodies, const int* at) const {
    scatter(bodies, at, v), scatter(bodies + 4, at, w);
  }
  OBSCURA_INLINE void keep(const Mask<V>& moves, const WideBody& before) {
    v.x = pick<V>(moves, v.x, before.v.x), v.y = pick<V>(moves, v.y, before.v.y),
    v.z = pick<V>(moves, v.z, before.v.z);
    w.x = pick<V>(moves, w.x, before.w.x), w.y = pick<V>(moves, w.y, before.w.y),
    w.z = pick<V>(moves, w.z, before.w.z);
  }
  OBSCURA_INLINE Wide3<V> velocity(const Wide3<V>& arm) const {
    const Wide3<V> turns = outer<V>({w.x, w.y, w.z}, arm);
    return {v.x + turns.x, v.y + turns.y, v.z + turns.z};
  }
  OBSCURA_INLINE void push(const Wide3<V>& p, const Wide3<V>& arm) {
    v.x += v.w * p.x, v.y += v.w * p.y, v.z += v.w * p.z;
    const Wide3<V> m = outer<V>(arm, p);
    w.x += i00 * m.x + i10 * m.y + i20 * m.z;
    w.y += i10 * m.x + i11 * m.y + i21 * m.z;
    w.z += i20 * m.x + i21 * m.y + i22 * m.z;
  }
};

// K of one side, without its mass: - [r]x I^-1 [r]x, of which column k is r x (I^-1 (r x e_k)) taken back
template <class V>
OBSCURA_INLINE void add_turning(const WideBody<V>& body, const Wide3<V>& r, Symmetric<V>& k) {
  // I^-1 [r]x, column by column: r x e_x = (0, z, -y), r x e_y = (-z, 0, x), r x e_z = (y, -x, 0)
  const Wide3<V> x{body.i10 * r.z - body.i20 * r.y, body.i11 * r.z - body.i21 * r.y,
                   body.i21 * r.z - body.i22 * r.y};
  const Wide3<V> y{body.i20 * r.x - body.i00 * r.z, body.i21 * r.x - body.i10 * r.z,
                   body.i22 * r.x - body.i20 * r.z};
  const Wide3<V> z{body.i00 * r.y - body.i10 * r.x, body.i10 * r.y - body.i11 * r.x,
                   body.i20 * r.y - body.i21 * r.x};
  k.xx += r.z * x.y - r.y * x.z, k.xy += r.z * y.y - r.y * y.z, k.xz += r.z * z.y - r.y * z.z;
  k.yy += r.x * y.z - r.z * y.x, k.yz += r.x * z.z - r.z * z.x, k.zz += r.y * z.x - r.x * z.y;
}

// What the contacts answer, J M^-1 J' = K: along n, across it at most, and across it by an impulse along n.
//   askew = K n - n (n . K n)
// Of the block across n:
//   trace = tr K - n . K n,  determinant = n . adj(K) n
template <class V>
OBSCURA_INLINE void respond_all(std::span<const SpaceBatches::Batch> batches,
                                std::vector<SpaceBatches::Row>& rows, const double* bodies) {
  const V none{}, one = V{} + 1.0;
  for (const SpaceBatches::Batch& g : batches) {
    for (int lane = 0; lane < SpaceBatches::kLanes; lane += Of<V>::lanes) {
      const WideBody<V> a(bodies, g.at_a + lane), b(bodies, g.at_b + lane);
      const V masses = a.v.w + b.v.w;
      for (int i = g.first; i < g.first + g.count; ++i) {
        SpaceBatches::Row& r = rows[std::size_t(i)];
        const Wide3<V> n = load3<V>(r.n, lane);
        Symmetric<V> k{masses, none, none, masses, none, masses};
        add_turning<V>(a, load3<V>(r.arm_a, lane), k), add_turning<V>(b, load3<V>(r.arm_b, lane), k);
        const Wide3<V> kn{k.xx * n.x + k.xy * n.y + k.xz * n.z, k.xy * n.x + k.yy * n.y + k.yz * n.z,
                          k.xz * n.x + k.yz * n.y + k.zz * n.z};
        const V normal = inner<V>(n, kn);
        const V xx = k.yy * k.zz - k.yz * k.yz, yy = k.xx * k.zz - k.xz * k.xz,
                zz = k.xx * k.yy - k.xy * k.xy;
        const V xy = k.xz * k.yz - k.xy * k.zz, xz = k.xy * k.yz - k.xz * k.yy,
                yz = k.xy * k.xz - k.xx * k.yz;
        const V determinant = n.x * (xx * n.x + xy * n.y + xz * n.z) +
                              n.y * (xy * n.x + yy * n.y + yz * n.z) + n.z * (xz * n.x + yz * n.y + zz * n.z);
        const V half = 0.5 * ((k.xx + k.yy + k.zz) - normal);
        const V across = half + root(larger<V>(half * half - determinant, none));
        // unused lanes have no normal
        const Mask<V> used = normal > none;
        store<V>(r.per_normal + lane, pick<V>(used, one / pick<V>(used, normal, one), none));
        store<V>(r.across + lane, pick<V>(used, across, none));
        store<V>(r.per_across + lane, pick<V>(used, one / pick<V>(used, across, one), none));
        store3<V>(r.askew, lane, {kn.x - normal * n.x, kn.y - normal * n.y, kn.z - normal * n.z});
      }
    }
  }
}

// Those from `begin` on before `end`. Walls and what does not move are written as they were, also by several
// threads at once: their velocities have no zero below zero that adding nothing would change.
// kSome: of active bodies alone, of the batches `open`; each says which of its lanes were on and have changed
template <class V, bool kSome>
OBSCURA_INLINE void iterate_all(std::vector<SpaceBatches::Batch>& batches,
                                std::vector<SpaceBatches::Row>& rows,
                                const std::vector<SpaceBatches::Belt>& belts, double* bodies, int begin,
                                int end, bool back, [[maybe_unused]] const std::vector<int>& open,
                                [[maybe_unused]] const Settling* settling) {
  using Batch = SpaceBatches::Batch;
  using Row = SpaceBatches::Row;
  const V none{}, one = V{} + 1.0;
  for (int i = begin; i < end; ++i) {
    const int at = back ? begin + end - 1 - i : i;
    Batch& g = batches[std::size_t(kSome ? open[std::size_t(at)] : at)];
    [[maybe_unused]] unsigned char on = 0;
    [[maybe_unused]] alignas(32) double friction[SpaceBatches::kLanes] = {};
    if constexpr (kSome) {
      for (int lane = 0; lane < SpaceBatches::kLanes; ++lane) {
        const int flags = settling->flags[std::size_t(g.a[lane])] | settling->flags[std::size_t(g.b[lane])];
        if (!(flags & Settling::kNow) || (flags & Settling::kNever) || !(g.used >> lane & 1)) continue;
        on = static_cast<unsigned char>(on | 1 << lane);
        friction[lane] = settling->islands[std::size_t(g.island[lane])].friction ? 1 : 0;
      }
      g.on = on, g.changed = 0;
      if (!on) continue;
    }
    for (int lane = 0; lane < SpaceBatches::kLanes; lane += Of<V>::lanes) {
      WideBody<V> a(bodies, g.at_a + lane), b(bodies, g.at_b + lane);
      const WideBody<V> begun_a = a, begun_b = b;
      const V mu = load<V>(g.mu + lane);
      [[maybe_unused]] V most_wrong = none;
      [[maybe_unused]] const Mask<V> moves = mask<V>(kSome ? on : g.used, lane);
      for (int k = 0; k < g.count; ++k) {
        Row& r = rows[std::size_t(g.first + (back ? g.count - 1 - k : k))];
        const Wide3<V> n = load3<V>(r.n, lane), arm_a = load3<V>(r.arm_a, lane),
                       arm_b = load3<V>(r.arm_b, lane), askew = load3<V>(r.askew, lane);
        const Wide3<V> va = a.velocity(arm_a), vb = b.velocity(arm_b);
        Wide3<V> u{va.x - vb.x, va.y - vb.y, va.z - vb.z};
        if (!belts.empty()) {
          const Wide3<V> belt = load3<V>(belts[std::size_t(&r - rows.data())].speed, lane);
          u.x += belt.x, u.y += belt.y, u.z += belt.z;
        }
        const V along = inner<V>(n, u), wrong = load<V>(r.least + lane) - along;
        const V l0 = load<V>(r.normal_impulse + lane);
        const V l = larger<V>(l0 + wrong * load<V>(r.per_normal + lane), none);
        const V pushed = l - l0, most = mu * l;
        const Wide3<V> t0 = load3<V>(r.tangent_impulse, lane);
        const V per = load<V>(r.per_across + lane);
        const Wide3<V> wanted{t0.x - (u.x - along * n.x + pushed * askew.x) * per,
                              t0.y - (u.y - along * n.y + pushed * askew.y) * per,
                              t0.z - (u.z - along * n.z + pushed * askew.z) * per};
        const V size = root(inner<V>(wanted, wanted));
        const Mask<V> cut = size > most;
        const V by = pick<V>(cut, most / pick<V>(cut, size, one), one);
        const Wide3<V> t{wanted.x * by, wanted.y * by, wanted.z * by};
        const Wide3<V> change{t.x - t0.x, t.y - t0.y, t.z - t0.z};
        const Wide3<V> p{pushed * n.x + change.x, pushed * n.y + change.y, pushed * n.z + change.z};
        a.push(p, arm_a), b.push({-p.x, -p.y, -p.z}, arm_b);
        if constexpr (kSome) {
          V left = pick<V>(l0 > none, magnitude<V>(wrong), wrong);
          left = larger<V>(
              left, load<V>(friction + lane) * (load<V>(r.across + lane) * root(inner<V>(change, change))));
          most_wrong = larger<V>(most_wrong, left);
          store<V>(r.normal_impulse + lane, pick<V>(moves, l, l0));
          store3<V>(r.tangent_impulse, lane,
                    {pick<V>(moves, t.x, t0.x), pick<V>(moves, t.y, t0.y), pick<V>(moves, t.z, t0.z)});
        } else {
          store<V>(r.normal_impulse + lane, l), store3<V>(r.tangent_impulse, lane, t);
        }
      }
      if constexpr (kSome) {
        // the other lanes stay: what a pair does must not hang on which lanes are beside its own
        a.keep(moves, begun_a), b.keep(moves, begun_b);
        most_wrong *= load<V>(g.per_width + lane);
        for (int k = 0; k < Of<V>::lanes; ++k) {
          if (!(on >> (lane + k) & 1)) continue;
          const Settling::Island& island = settling->islands[std::size_t(g.island[lane + k])];
          if (most_wrong[k] > island.settled)
            g.changed = static_cast<unsigned char>(g.changed | 1 << (lane + k));
        }
      }
      a.back(bodies, g.at_a + lane), b.back(bodies, g.at_b + lane);
    }
  }
}

// Impulses go on along the directions, the share of their island times as far; the next directions are that
// and what the iterations changed. Share 0: what these changed alone.
template <class V>
OBSCURA_INLINE void follow_all(const std::vector<SpaceBatches::Batch>& batches,
                               std::vector<SpaceBatches::Row>& rows,
                               std::vector<SpaceBatches::Impulses>& before,
                               std::vector<SpaceBatches::Impulses>& directions, double* bodies,
                               const std::vector<int>& open, const Settling& settling) {
  const V none{}, one = V{} + 1.0;
  for (const int at : open) {
    const SpaceBatches::Batch& g = batches[std::size_t(at)];
    unsigned char on = 0;
    alignas(32) double shares[SpaceBatches::kLanes] = {};
    for (int lane = 0; lane < SpaceBatches::kLanes; ++lane) {
      if (!(g.used >> lane & 1)) continue;
      const Settling::Island& island = settling.islands[std::size_t(g.island[lane])];
      if (!island.follows || !island.open) continue;
      on = static_cast<unsigned char>(on | 1 << lane), shares[lane] = island.share;
    }
    if (!on) continue;
    for (int lane = 0; lane < SpaceBatches::kLanes; lane += Of<V>::lanes) {
      WideBody<V> a(bodies, g.at_a + lane), b(bodies, g.at_b + lane);
      const WideBody<V> begun_a = a, begun_b = b;
      const V mu = load<V>(g.mu + lane), by = load<V>(shares + lane);
      const Mask<V> moves = mask<V>(on, lane);
      const auto set = [&](double* to, const V& changed) {
        store<V>(to, pick<V>(moves, changed, load<V>(to)));
      };
      const auto set3 = [&](double(&to)[3][4], const Wide3<V>& changed) {
        set(to[0] + lane, changed.x), set(to[1] + lane, changed.y), set(to[2] + lane, changed.z);
      };
      for (int i = g.first; i < g.first + g.count; ++i) {
        SpaceBatches::Row& r = rows[std::size_t(i)];
        SpaceBatches::Impulses &from = before[std::size_t(i)], &to = directions[std::size_t(i)];
        const Wide3<V> n = load3<V>(r.n, lane), t0 = load3<V>(r.tangent_impulse, lane),
                       tf = load3<V>(from.tangent, lane), td = load3<V>(to.tangent, lane);
        const V l0 = load<V>(r.normal_impulse + lane), ld = by * load<V>(to.normal + lane);
        const Wide3<V> t1{by * td.x, by * td.y, by * td.z};
        set(to.normal + lane, ld + (l0 - load<V>(from.normal + lane)));
        set3(to.tangent, {t1.x + (t0.x - tf.x), t1.y + (t0.y - tf.y), t1.z + (t0.z - tf.z)});
        const V l = larger<V>(l0 + ld, none), most = mu * l;
        const Wide3<V> wanted{t0.x + t1.x, t0.y + t1.y, t0.z + t1.z};
        const V size = root(inner<V>(wanted, wanted));
        const Mask<V> cut = size > most;
        const V part = pick<V>(cut, most / pick<V>(cut, size, one), one);
        const Wide3<V> t{wanted.x * part, wanted.y * part, wanted.z * part};
        const V pushed = l - l0;
        const Wide3<V> p{pushed * n.x + (t.x - t0.x), pushed * n.y + (t.y - t0.y),
                         pushed * n.z + (t.z - t0.z)};
        a.push(p, load3<V>(r.arm_a, lane)), b.push({-p.x, -p.y, -p.z}, load3<V>(r.arm_b, lane));
        set(r.normal_impulse + lane, l), set3(r.tangent_impulse, t);
        set(from.normal + lane, l), set3(from.tangent, t);
      }
      a.keep(moves, begun_a), b.keep(moves, begun_b);
      a.back(bodies, g.at_a + lane), b.back(bodies, g.at_b + lane);
    }
  }
}

OBSCURA_WIDE void follow_wide(const std::vector<SpaceBatches::Batch>& batches,
                              std::vector<SpaceBatches::Row>& rows,
                              std::vector<SpaceBatches::Impulses>& before,
                              std::vector<SpaceBatches::Impulses>& directions, double* bodies,
                              const std::vector<int>& open, const Settling& settling) {
  follow_all<V4>(batches, rows, before, directions, bodies, open, settling);
}
OBSCURA_WIDE void respond_wide(std::span<const SpaceBatches::Batch> batches,
                               std::vector<SpaceBatches::Row>& rows, const double* bodies) {
  respond_all<V4>(batches, rows, bodies);
}
OBSCURA_WIDE void iterate_wide(std::vector<SpaceBatches::Batch>& batches,
                               std::vector<SpaceBatches::Row>& rows,
                               const std::vector<SpaceBatches::Belt>& belts, double* bodies, int begin,
                               int end, bool back) {
  iterate_all<V4, false>(batches, rows, belts, bodies, begin, end, back, {}, nullptr);
}
OBSCURA_WIDE void iterate_some_wide(std::vector<SpaceBatches::Batch>& batches,
                                    std::vector<SpaceBatches::Row>& rows,
                                    const std::vector<SpaceBatches::Belt>& belts, double* bodies, int begin,
                                    int end, bool back, const std::vector<int>& open,
                                    const Settling& settling) {
  iterate_all<V4, true>(batches, rows, belts, bodies, begin, end, back, open, &settling);
}

}  // namespace

void SpaceBatches::sort(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
                        std::span<const PointBody<3>> bodies) {
  pairs_.clear(), levels_.begin(bodies.size());
  for (int first = 0, end = 0; first < int(which.size()); first = end) {
    const ContactConstraint<3>& contact = contacts[std::size_t(which[std::size_t(first)])];
    const auto same = [&](int i) {
      const ContactConstraint<3>& other = contacts[std::size_t(which[std::size_t(i)])];
      return other.a == contact.a && other.b == contact.b;
    };
    for (end = first + 1; end < int(which.size()) && same(end);) ++end;
    const auto moves = [&](int body) { return bodies[std::size_t(body)].inverse_mass > 0; };
    const int level = levels_.next(contact.a, moves(contact.a), contact.b, moves(contact.b));
    pairs_.push_back({contact.a, contact.b, first, end - first, level});
  }

  // by level, and in each by how many contacts they have, the most first
  const auto place = [](const Pair& pair) {
    return std::size_t(pair.level * kMostSorted + kMostSorted - std::min(pair.count, kMostSorted));
  };
  begin_.assign(std::size_t(std::max(1, levels_.count()) * kMostSorted + 1), 0);
  for (const Pair& pair : pairs_) ++begin_[place(pair) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  pair_begins_.clear();
  for (int level = 0; level <= levels_.count(); ++level)
    pair_begins_.push_back(begin_[std::size_t(level * kMostSorted)]);
  sorted_.resize(pairs_.size());
  for (const Pair& pair : pairs_) sorted_[std::size_t(begin_[place(pair)]++)] = pair;
}

// batches of the sorted pairs, and how many rows each has
void SpaceBatches::lay_out() {
  batches_.clear(), level_begins_.clear();
  for (int i = 0; i < int(sorted_.size()); ++i) {
    const Pair& pair = sorted_[std::size_t(i)];
    const bool begins = batches_.empty() || batches_.back().level != pair.level;
    if (begins) level_begins_.push_back(int(batches_.size()));
    if (begins || batches_.back().lanes == kLanes) {
      Batch& made = batches_.emplace_back();
      made.level = pair.level, made.first_pair = i;
    }
    Batch& g = batches_.back();
    ++g.lanes, g.count = std::max(g.count, pair.count);
  }
  level_begins_.push_back(int(batches_.size()));
  int rows = 0;
  for (Batch& g : batches_) g.first = rows, rows += g.count;
  rows_.resize(std::size_t(rows));
}

void SpaceBatches::build(std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
                         std::span<const PointBody<3>> bodies) {
  lay_out();
  const bool belts = std::any_of(which.begin(), which.end(),
                                 [&](int i) { return !contacts[std::size_t(i)].surface().isZero(0); });
  belts_.assign(belts ? rows_.size() : 0, Belt{});
  const double* const numbers = bodies.data()->v.data();
  each(workers_.get(), int(batches_.size()), kBatchPiece, [&](int begin, int end) {
    const auto these = std::span(batches_).subspan(std::size_t(begin), std::size_t(end - begin));
    for (Batch& g : these) fill(g, contacts, which, int(bodies.size()) - 1);
    four_lanes ? respond_wide(these, rows_, numbers) : respond_all<V2>(these, rows_, numbers);
  });
}

void SpaceBatches::fill(Batch& g, std::span<const ContactConstraint<3>> contacts, std::span<const int> which,
                        int none) {
  std::fill_n(g.a, kLanes, none), std::fill_n(g.b, kLanes, none), std::fill_n(g.island, kLanes, -1);
  std::fill_n(g.at_a, kLanes, kBodyFours * none), std::fill_n(g.at_b, kLanes, kBodyFours * none);
  std::fill_n(g.mu, kLanes, 0.0), std::fill_n(g.per_width, kLanes, 1.0);
  for (int i = g.first; i < g.first + g.count; ++i) {
    rows_[std::size_t(i)] = {};
    std::fill_n(rows_[std::size_t(i)].contact, kLanes, -1);
  }
  for (int lane = 0; lane < g.lanes; ++lane) add(g, lane, contacts, which);
}

void SpaceBatches::add(Batch& g, int lane, std::span<const ContactConstraint<3>> contacts,
                       std::span<const int> which) {
  const Pair& pair = sorted_[std::size_t(g.first_pair + lane)];
  g.used = static_cast<unsigned char>(g.used | 1 << lane);
  g.a[lane] = pair.a, g.b[lane] = pair.b;
  g.at_a[lane] = kBodyFours * pair.a, g.at_b[lane] = kBodyFours * pair.b;
  for (int k = 0; k < pair.count; ++k) {
    const int number = which[std::size_t(pair.first + k)];
    const ContactConstraint<3>& from = contacts[std::size_t(number)];
    Row& r = rows_[std::size_t(g.first + k)];
    for (int i = 0; i < 3; ++i) {
      r.n[i][lane] = from.n[i], r.arm_a[i][lane] = from.arm_a[i], r.arm_b[i][lane] = from.arm_b[i];
      if (!belts_.empty()) belts_[std::size_t(g.first + k)].speed[i][lane] = from.surface()[i];
    }
    g.mu[lane] = from.mu, g.per_width[lane] = from.per_width;
    r.contact[lane] = number;
    load(r, lane, from);
  }
}

void SpaceBatches::load(Row& row, int lane, const ContactConstraint<3>& from) {
  row.least[lane] = from.least, row.normal_impulse[lane] = from.normal_impulse;
  for (int i = 0; i < 3; ++i) row.tangent_impulse[i][lane] = from.tangent_impulse[i];
}

void SpaceBatches::load(std::span<const ContactConstraint<3>> contacts) {
  for (Row& r : rows_) {
    for (int lane = 0; lane < kLanes; ++lane)
      if (r.contact[lane] >= 0) load(r, lane, contacts[std::size_t(r.contact[lane])]);
  }
}

void SpaceBatches::store(std::span<ContactConstraint<3>> contacts) const {
  each(workers_.get(), int(rows_.size()), kLanes * kBatchPiece, [&](int begin, int end) {
    for (int at = begin; at < end; ++at) {
      const Row& r = rows_[std::size_t(at)];
      for (int lane = 0; lane < kLanes; ++lane) {
        if (r.contact[lane] < 0) continue;
        ContactConstraint<3>& to = contacts[std::size_t(r.contact[lane])];
        to.normal_impulse = r.normal_impulse[lane];
        for (int i = 0; i < 3; ++i) to.tangent_impulse[i] = r.tangent_impulse[i][lane];
      }
    }
  });
}

void SpaceBatches::set_islands(const Settling& settling) {
  open_.clear();
  for (Batch& g : batches_) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int a = settling.island_of[std::size_t(g.a[lane])];
      g.island[lane] = a >= 0 ? a : settling.island_of[std::size_t(g.b[lane])];
      if (g.island[lane] < 0) g.used = static_cast<unsigned char>(g.used & ~(1 << lane));
    }
    open_.push_back(int(&g - batches_.data()));
  }
  find_open_levels();
}

void SpaceBatches::find_open_levels() {
  open_begins_.clear();
  for (int i = 0; i < int(open_.size()); ++i) {
    const auto level = [&](int at) { return batches_[std::size_t(open_[std::size_t(at)])].level; };
    if (i == 0 || level(i) != level(i - 1)) open_begins_.push_back(i);
  }
  open_begins_.push_back(int(open_.size()));
}

// act(begin, end) for all, level by level; those of a level share no body that moves
template <class Act>
void SpaceBatches::by_level(std::span<const int> begins, bool back, const Act& act) const {
  if (!workers_ || begins.empty()) return act(0, begins.empty() ? 0 : begins.back());
  const int levels = int(begins.size()) - 1;
  for (int i = 0; i < levels; ++i) {
    const auto level = std::size_t(back ? levels - 1 - i : i);
    const int first = begins[level];
    each(workers_.get(), begins[level + 1] - first, kBatchPiece,
         [&](int begin, int end) { act(first + begin, first + end); });
  }
}

void SpaceBatches::begin_directions() {
  before_.resize(rows_.size()), direction_.assign(rows_.size(), {});
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    std::copy_n(rows_[i].normal_impulse, kLanes, before_[i].normal);
    for (int k = 0; k < 3; ++k) std::copy_n(rows_[i].tangent_impulse[k], kLanes, before_[i].tangent[k]);
  }
}

void SpaceBatches::follow_directions(std::span<PointBody<3>> bodies, Settling& settling) {
  for (Settling::Island& island : settling.islands) island.change = 0;
  for (const int at : open_) {
    const Batch& g = batches_[std::size_t(at)];
    for (int lane = 0; lane < kLanes; ++lane) {
      if (!(g.used >> lane & 1)) continue;
      Settling::Island& island = settling.islands[std::size_t(g.island[lane])];
      if (!island.follows || !island.open) continue;
      for (int i = g.first; i < g.first + g.count; ++i) {
        const Row& r = rows_[std::size_t(i)];
        const Impulses& from = before_[std::size_t(i)];
        double sum = r.normal_impulse[lane] - from.normal[lane];
        sum *= sum;
        for (int k = 0; k < 3; ++k) {
          const double t = r.tangent_impulse[k][lane] - from.tangent[k][lane];
          sum += t * t;
        }
        island.change += r.across[lane] * sum;
      }
    }
  }
  for (Settling::Island& island : settling.islands) {
    island.share = island.before > 0 && island.change <= island.before ? island.change / island.before : 0;
    if (!island.open) continue;
    island.before = island.change;
    if (island.follows && island.change < island.enough) island.budget = island.spent;
  }
  double* const numbers = bodies.data()->v.data();
  if (four_lanes) return follow_wide(batches_, rows_, before_, direction_, numbers, open_, settling);
  follow_all<V2>(batches_, rows_, before_, direction_, numbers, open_, settling);
}

void SpaceBatches::iterate(std::span<PointBody<3>> bodies, bool back) {
  double* const numbers = bodies.data()->v.data();
  by_level(level_begins_, back, [&](int begin, int end) {
    if (four_lanes) return iterate_wide(batches_, rows_, belts_, numbers, begin, end, back);
    iterate_all<V2, false>(batches_, rows_, belts_, numbers, begin, end, back, {}, nullptr);
  });
}

void SpaceBatches::iterate(std::span<PointBody<3>> bodies, bool back, Settling& settling) {
  const auto open = [&](const Batch& g) {
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((g.used >> lane & 1) && settling.islands[std::size_t(g.island[lane])].open) return true;
    }
    return false;
  };
  if (settling.narrowed) {
    std::erase_if(open_, [&](int at) { return !open(batches_[std::size_t(at)]); });
    find_open_levels();
  }
  settling.narrowed = false;
  for (Settling::Island& island : settling.islands) island.changed = false;
  double* const numbers = bodies.data()->v.data();
  by_level(open_begins_, back, [&](int begin, int end) {
    if (four_lanes)
      return iterate_some_wide(batches_, rows_, belts_, numbers, begin, end, back, open_, settling);
    iterate_all<V2, true>(batches_, rows_, belts_, numbers, begin, end, back, open_, &settling);
  });
  for (const int at : open_) {
    const Batch& g = batches_[std::size_t(at)];
    for (int lane = 0; g.on && lane < kLanes; ++lane) {
      if (!(g.on >> lane & 1)) continue;
      Settling::Island& island = settling.islands[std::size_t(g.island[lane])];
      island.spent += g.count;
      if (!(g.changed >> lane & 1)) continue;
      island.changed = true;
      settling.flags[std::size_t(g.a[lane])] |= Settling::kNext,
          settling.flags[std::size_t(g.b[lane])] |= Settling::kNext;
    }
  }
}

}  // namespace obscura::sim
