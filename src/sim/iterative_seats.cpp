// Pairs take their seats: colours, so that four side by side share no body that moves, and what their
// features are.

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim/iterative.h"

namespace obscura::sim {

using sweep::Feature;
using sweep::kLanes;
using sweep::Pair;
using sweep::Seats;

namespace {

constexpr double kCalm = 0.02;  // of its thickness: what a pair may move between two looks, features kept
constexpr double kSoft = 0.05;  // of its thickness between two looks: slower inelastic closings are no blows
constexpr int kColours = 40;    // seats of more colours hold one pair each
constexpr int kAhead = 8;       // seats
constexpr double kNowhere = 1e9;  // m: the gap of a touch that is none

}  // namespace

// seats for the pairs that are awake: greedy colours, in the order of pairs
template <int D>
void Iterative<D>::seat(const State<D>& state, bool known) {
  std::vector<Pair>& all = pairs_.all();
  if (version_ == pairs_.version() && frozen_ == state.frozen) {
    for (Pair& pair : all) {
      if (pair.slot >= 0 && (pair.fresh || !known)) sit(pair, state);
      pair.fresh = false;
    }
    return;
  }
  const int n = int(turns_.size());
  version_ = pairs_.version(), frozen_ = state.frozen;
  for (int i = 0; i < n; ++i) {
    const bool moves = !fixed_[i] && !state.frozen[i];
    v_[i].im = moves ? light_[i].im : 0, ii_[i] = moves ? light_[i].ii : 0;
  }

  std::fill(colours_.begin(), colours_.end(), 0);
  count_.assign(kColours + 1, 0);
  awake_pairs_ = 0;
  for (Pair& pair : all) {
    const bool a = v_[pair.a].im > 0, b = pair.b >= 0 && v_[pair.b].im > 0;
    pair.slot = -1;
    if (!a && !b) continue;
    ++awake_pairs_;
    const std::uint64_t used = (a ? colours_[pair.a] : 0) | (b ? colours_[pair.b] : 0);
    const int which = std::min(std::countr_one(used), kColours);
    if (which < kColours) {
      if (a) colours_[pair.a] |= std::uint64_t(1) << which;
      if (b) colours_[pair.b] |= std::uint64_t(1) << which;
    }
    pair.slot = pair.colour = which;  // for now
    pair.alone = which == kColours;
    ++count_[which];
  }

  // a colour begins with seats of its own
  int begin = 0;
  for (int which = 0; which <= kColours; ++which) {
    const int taken =
        which < kColours ? (count_[which] + kLanes - 1) / kLanes * kLanes : count_[which] * kLanes;
    count_[which] = begin, begin += taken;
  }
  Seats empty{};
  for (int lane = 0; lane < kLanes; ++lane) {
    empty.a[lane] = empty.b[lane] = n, empty.pair[lane] = empty.first[lane] = -1;
    empty.d[0][lane] = empty.d[1][lane] = -kNowhere;
  }
  calmest_ = 1e300;
  slots_.assign(begin, -1);
  for (int i = 0; i < int(all.size()); ++i) {
    Pair& pair = all[i];
    pair.fresh = false;
    if (pair.slot < 0) continue;
    const int which = pair.slot;
    pair.slot = count_[which], count_[which] += which < kColours ? 1 : kLanes;
    slots_[pair.slot] = i;
  }
  // in the order of memory
  seats_.resize(begin / kLanes), projections_.resize(begin / kLanes);
  for (int slot = 0; slot < begin; ++slot) {
    // pairs and contacts are far apart in memory: ask for those of later seats
    if (slot + 2 * kAhead < begin && slots_[slot + 2 * kAhead] >= 0) {
      const char* at = reinterpret_cast<const char*>(&all[slots_[slot + 2 * kAhead]]);
      __builtin_prefetch(at), __builtin_prefetch(at + 64);
    }
    if (slot + kAhead < begin && slots_[slot + kAhead] >= 0) {
      const char* at = reinterpret_cast<const char*>(&state.contacts[all[slots_[slot + kAhead]].first]);
      __builtin_prefetch(at), __builtin_prefetch(at + 64), __builtin_prefetch(at + 128);
    }
    if (slot % kLanes == 0) seats_[slot / kLanes] = empty;
    if (slots_[slot] >= 0) take_seat(slots_[slot], state);
  }
  blows_.join(all, v_);
}

// what stays as long as a pair has its seat
template <int D>
void Iterative<D>::take_seat(int i, const State<D>& state) {
  Pair& pair = pairs_.all()[i];
  const int n = int(turns_.size());
  Seats& g = seats_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes;
  const sweep::Core& a = cores_.all[pair.core_a];
  double sight = 1e300, far = a.reach, thin = a.inside, radius = a.radius;
  bool round = false;
  if (pair.b >= 0) {
    const sweep::Core& b = cores_.all[pair.core_b];
    far = std::max(far, b.reach), thin = std::min(thin, b.inside), radius += b.radius;
    sight = kSight * std::max(thin, 0.5 * radius);
    // features of round things may change at any time, if there are more than one
    round = (a.count == 1) != (b.count == 1);
  }
  if (pairs_.boxes(pair)) g.boxes = static_cast<unsigned char>(g.boxes | 1 << lane);
  g.a[lane] = pair.a, g.iia[lane] = ii_[pair.a];
  g.b[lane] = pair.b >= 0 ? pair.b : n, g.iib[lane] = pair.b >= 0 ? ii_[pair.b] : 0;
  g.pair[lane] = i, g.first[lane] = pair.first, g.touches[lane] = static_cast<unsigned char>(pair.touches);
  g.blow[lane] = -(pair.elasticity > 0 ? rest_speed_ : std::max(rest_speed_, kSoft * thin / span_));
  pair.blow = float(-0.999 * g.blow[lane]);
  g.sight[lane] = sight, g.mu[lane] = pair.friction, g.radius[lane] = radius;
  g.far[lane] = far, g.calm[lane] = round ? -1 : pair.touches == 1 ? 1e300 : kCalm * thin / span_;
  // in terms of bodies' own reaches
  double least = cores_.reach[pair.a];
  if (pair.b >= 0) least = std::min(least, cores_.reach[pair.b]);
  if (g.calm[lane] < 1e300) calmest_ = std::min(calmest_, g.calm[lane] * (least / far));
  sit(pair, state);
}

// features and forces of a pair
template <int D>
void Iterative<D>::sit(const Pair& pair, const State<D>& state) {
  Seats& g = seats_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes, bit = 1 << lane;
  g.first[lane] = pair.first;
  for (int k = 0; k < 2; ++k) {
    g.of_b[k] = static_cast<unsigned char>(g.of_b[k] & ~bit);
    g.corners[k] = static_cast<unsigned char>(g.corners[k] & ~bit);
    g.cx[k][lane] = g.cy[k][lane] = g.fx[k][lane] = g.fy[k][lane] = g.p[k][lane] = g.q[k][lane] = 0;
    g.d[k][lane] = -kNowhere;
    if (k >= pair.touches) continue;
    const Contact<D>& contact = state.contacts[pair.first + k];
    const Feature f = Feature::of(pair.words[k]);
    g.words[k][lane] = static_cast<unsigned short>(pair.words[k]);
    if (f.kind == Feature::none) continue;
    g.p[k][lane] = contact.force[0], g.q[k][lane] = contact.force[1];
    const sweep::Core& a = cores_.all[pair.core_a];
    if (pair.b < 0) {
      const Wall<D>& wall = model_.walls[-1 - pair.b];
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = wall.normal[0], g.fy[k][lane] = wall.normal[1];
      g.d[k][lane] = wall.normal.dot(wall.point);
      continue;
    }
    const sweep::Core& b = cores_.all[pair.core_b];
    if (f.kind == Feature::corners) {
      g.corners[k] = static_cast<unsigned char>(g.corners[k] | bit);
      g.cx[k][lane] = cores_.x[a.first + f.corner], g.cy[k][lane] = cores_.y[a.first + f.corner];
      g.fx[k][lane] = cores_.x[b.first + f.face], g.fy[k][lane] = cores_.y[b.first + f.face];
      g.d[k][lane] = b.radius;
      continue;
    }
    const bool of_a = f.kind == Feature::corner_of_a;
    const int corner = (of_a ? a : b).first + f.corner, face = (of_a ? b : a).first + f.face;
    if (!of_a) g.of_b[k] = static_cast<unsigned char>(g.of_b[k] | bit);
    g.cx[k][lane] = cores_.x[corner], g.cy[k][lane] = cores_.y[corner];
    g.fx[k][lane] = cores_.nx[face], g.fy[k][lane] = cores_.ny[face], g.d[k][lane] = cores_.d[face];
  }
}

template void Iterative<2>::seat(const State<2>&, bool);
template void Iterative<2>::take_seat(int, const State<2>&);
template void Iterative<2>::sit(const Pair&, const State<2>&);

}  // namespace obscura::sim
