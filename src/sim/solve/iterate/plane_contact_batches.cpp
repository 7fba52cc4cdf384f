// Pairs take their lanes: colours, so that four side by side share no body that moves, and what their
// features are.

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim/solve/iterate/plane.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

using plane::ContactBatch;
using plane::Feature;
using plane::kLanes;
using plane::Pair;

namespace {

constexpr double kCalm =
    0.02;  // of its thickness: what a pair may move between two pair searches, features kept
constexpr int kColours = 40;    // lanes of more colours hold one pair each
constexpr int kPerSpare = 128;  // lanes of a colour: one group more for so many
constexpr int kAhead = 8;       // lanes

// iterations of an island at rest
constexpr int kRestPairs = 40000;  // pairs times iterations
constexpr int kFewestAtRest = 10, kMostAtRest = 400;

bool meets_corners(const Pair& pair) { return Feature::of(pair.words[0]).kind == Feature::corners; }

}  // namespace

// lanes for the pairs that are awake: greedy colours, in the order of pairs
void PlaneIterative::build_batches(const State<D>& state, bool known) {
  std::vector<Pair>& all = pairs_.all();
  if (version_ == pairs_.version() && frozen_ == state.frozen) {
    for (Pair& pair : all) {
      if (pair.slot >= 0 && (pair.fresh || !known)) write_lane(pair, state);
      pair.fresh = false;
    }
    return;
  }
  version_ = pairs_.version(), few_stale_ = true;
  if (known && frozen_ == state.frozen && update_batches(state)) {
    impacts_.list_pairs(all, moving_);
    return;
  }
  const int n = int(turns_.size());
  frozen_ = state.frozen;
  for (int i = 0; i < n; ++i) {
    const bool moves = !fixed_[i] && !state.frozen[i];
    moving_[i].im = moves ? light_[i].im : 0, ii_[i] = moves ? light_[i].ii : 0;
  }

  std::fill(colours_.begin(), colours_.end(), 0);
  count_.assign(kColours + 1, 0);
  awake_pairs_ = 0;
  for (Pair& pair : all) {
    pair.slot = pair.colour = colour(pair);  // for now
    pair.alone = pair.colour == kColours;
    if (pair.slot >= 0) ++awake_pairs_, ++count_[pair.colour];
  }

  // A colour begins with lanes of its own, and a large one has some to spare. Where two corners meet sits
  // behind them: that takes more arithmetic.
  begin_.assign(1, 0);
  for (int which = 0; which <= kColours; ++which) {
    const int many = count_[which];
    const int groups = which < kColours ? (many + kLanes - 1) / kLanes + many / kPerSpare : many;
    count_[which] = begin_.back(), begin_.push_back(begin_.back() + groups * kLanes);
  }
  ends_.assign(begin_.begin() + 1, begin_.end());
  const int end = begin_.back();
  slots_.assign(end, -1);
  for (int i = 0; i < int(all.size()); ++i) {
    Pair& pair = all[i];
    pair.fresh = false;
    if (pair.slot < 0) continue;
    const int which = pair.slot;
    if (which < kColours && meets_corners(pair)) {
      pair.slot = --ends_[which];
    } else {
      pair.slot = count_[which], count_[which] += which < kColours ? 1 : kLanes;
    }
    slots_[pair.slot] = i;
  }
  // in the order of memory
  calmest_ = 1e300;
  batches_.resize(end / kLanes), projections_.resize(end / kLanes);
  slow_.reserve(std::size_t(end)), fast_.reserve(std::size_t(end)), reserve_seen();
  for (int slot = 0; slot < end; ++slot) {
    // pairs and contacts are far apart in memory: ask for those of later lanes
    if (slot + 2 * kAhead < end && slots_[slot + 2 * kAhead] >= 0) {
      const char* at = reinterpret_cast<const char*>(&all[slots_[slot + 2 * kAhead]]);
      __builtin_prefetch(at), __builtin_prefetch(at + 64);
    }
    if (slot + kAhead < end && slots_[slot + kAhead] >= 0) {
      const char* at = reinterpret_cast<const char*>(&state.contacts[all[slots_[slot + kAhead]].first]);
      __builtin_prefetch(at), __builtin_prefetch(at + 64), __builtin_prefetch(at + 128);
    }
    if (slots_[slot] < 0) {
      clear_lane(slot);
    } else {
      fill_lane(slots_[slot], state);
    }
  }
  impacts_.list_pairs(all, moving_);
}

// The colour of a pair, the next in order; -1 where it is asleep.
int PlaneIterative::colour(const Pair& pair) {
  const bool a = moving_[pair.a].im > 0, b = pair.b >= 0 && moving_[pair.b].im > 0;
  if (!a && !b) return -1;
  const std::uint64_t used = (a ? colours_[pair.a] : 0) | (b ? colours_[pair.b] : 0);
  const int which = std::min(std::countr_one(used), kColours);
  if (which == kColours) return which;
  if (a) colours_[pair.a] |= std::uint64_t(1) << which;
  if (b) colours_[pair.b] |= std::uint64_t(1) << which;
  return which;
}

// Batches after some pairs have come and some have gone: a pair that keeps its colour keeps its lane, for
// within a colour the order is of no account. False where there are too few.
bool PlaneIterative::update_batches(const State<D>& state) {
  if (begin_.empty()) return false;
  std::vector<Pair>& all = pairs_.all();
  const int end = begin_.back(), count = int(all.size());
  std::fill(colours_.begin(), colours_.end(), 0);
  next_slots_.assign(end, -1), moved_.clear();
  int awake = 0;
  for (int i = 0; i < count; ++i) {
    Pair& pair = all[i];
    const int which = colour(pair);
    if (which < 0) continue;
    if (which == kColours || pair.alone) return false;
    ++awake;
    if (pair.slot >= 0 && pair.colour == which) {
      next_slots_[pair.slot] = i;
    } else {
      pair.colour = which;
      moved_.push_back(i);
    }
  }
  count_.assign(begin_.begin(), begin_.end() - 1), ends_.assign(begin_.begin() + 1, begin_.end());
  for (const int i : moved_) {
    int &next = count_[all[i].colour], &last = ends_[all[i].colour];
    while (next < last && next_slots_[next] >= 0) ++next;
    while (next < last && next_slots_[last - 1] >= 0) --last;
    if (next == last) return false;
    all[i].slot = meets_corners(all[i]) ? --last : next++;
    next_slots_[all[i].slot] = count + i;
  }

  awake_pairs_ = awake;
  for (int slot = 0; slot < end; ++slot) {
    if (slot + 2 * kAhead < end && next_slots_[slot + 2 * kAhead] >= 0)
      __builtin_prefetch(&all[next_slots_[slot + 2 * kAhead] % count]);
    int& i = next_slots_[slot];
    if (i >= count) {
      i -= count;
      fill_lane(i, state);
    } else if (i >= 0) {
      ContactBatch& g = batches_[slot / kLanes];
      g.pair[slot % kLanes] = i, g.first[slot % kLanes] = all[i].first;
      if (all[i].fresh) write_lane(all[i], state);
    } else if (slots_[slot] >= 0) {
      clear_lane(slot);
    }
    if (i >= 0) all[i].fresh = false;
  }
  slots_.swap(next_slots_);
  return true;
}

// unused lanes, with the dummy body
ContactBatch PlaneIterative::empty_batch(int none) {
  ContactBatch made{};
  for (int k = 0; k < kLanes; ++k) {
    made.a[k] = made.b[k] = none, made.pair[k] = made.first[k] = -1;
    made.d[0][k] = made.d[1][k] = -plane::kNowhere, made.per_width[k] = 1;
  }
  return made;
}

void PlaneIterative::clear_lane(int slot) {
  static const ContactBatch empty = empty_batch(0);
  ContactBatch& g = batches_[slot / kLanes];
  const int lane = slot % kLanes, rest = ~(1 << lane), none = int(turns_.size());
  copy_lane(empty, lane, g, lane);
  g.a[lane] = g.b[lane] = none, g.pair[lane] = g.first[lane] = -1;
  g.used = static_cast<unsigned char>(g.used & rest), g.boxes = static_cast<unsigned char>(g.boxes & rest);
}

// what stays as long as a pair has its lane
void PlaneIterative::fill_lane(int i, const State<D>& state) {
  Pair& pair = pairs_.all()[i];
  const int n = int(turns_.size());
  ContactBatch& g = batches_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes;
  const plane::CoreShape& a = cores_.all[pair.core_a];
  double sight = 1e300, far = a.bounding_radius, thin = a.half_thickness, radius = a.radius;
  bool round = false;
  if (pair.b >= 0) {
    const plane::CoreShape& b = cores_.all[pair.core_b];
    far = std::max(far, b.bounding_radius), thin = std::min(thin, b.half_thickness), radius += b.radius;
    sight = this->sight(a, b);
    // features of round things may change at any time, if there are more than one
    round = (a.count == 1) != (b.count == 1);
  }
  const int bit = 1 << lane;
  g.used = static_cast<unsigned char>(g.used | bit);
  g.boxes = static_cast<unsigned char>(pairs_.boxes(pair) ? g.boxes | bit : g.boxes & ~bit);
  g.a[lane] = pair.a, g.iia[lane] = ii_[pair.a];
  g.b[lane] = pair.b >= 0 ? pair.b : n, g.iib[lane] = pair.b >= 0 ? ii_[pair.b] : 0;
  g.pair[lane] = i, g.first[lane] = pair.first, g.touches[lane] = static_cast<unsigned char>(pair.touches);
  g.impact_speed[lane] = -least_strike(pair.material.elasticity, 2 * thin);
  pair.impact_speed = float(-0.999 * g.impact_speed[lane]);
  g.sight[lane] = sight, g.mu[lane] = pair.material.friction, g.radius[lane] = radius;
  g.per_width[lane] = 1 / std::max(2 * thin, kPointWidth * model_.scale);
  const double belt = belt_of(pair.a) + belt_of(pair.b);
  g.belt[lane] = belt;
  const bool carried = belt != 0 || drives_.number(pair.a) >= 0 || drives_.number(pair.b) >= 0;
  g.belts = static_cast<unsigned char>(carried ? g.belts | bit : g.belts & ~bit);
  g.far[lane] = far, g.calm[lane] = round ? -1 : pair.touches == 1 ? 1e300 : kCalm * thin / span_;
  // in terms of bodies' own bounding radii
  double least = cores_.bounding_radius[pair.a];
  if (pair.b >= 0) least = std::min(least, cores_.bounding_radius[pair.b]);
  if (g.calm[lane] < 1e300) calmest_ = std::min(calmest_, g.calm[lane] * (least / far));
  write_lane(pair, state);
}

// features and forces of a pair
void PlaneIterative::write_lane(const Pair& pair, const State<D>& state) {
  ContactBatch& g = batches_[pair.slot / kLanes];
  const int lane = pair.slot % kLanes;
  g.first[lane] = pair.first;
  pairs_.put(pair, pair.words, g);
  for (int k = 0; k < 2; ++k) {
    const bool none = k >= pair.touches || Feature::of(pair.words[k]).kind == Feature::none;
    const Vec<D> force = none ? Vec<D>(Vec<D>::Zero()) : state.contacts[pair.first + k].force;
    g.p[k][lane] = force[0], g.q[k][lane] = force[1];
  }
}

// --- islands at rest (sim/solve/iterate/equilibrium.cpp)

// The pairs of an island in batches of its own, those of one colour together.
int PlaneIterative::begin_rest(const Sleep<D>::Island& island, const State<D>& state, double h) {
  const std::vector<Pair>& all = pairs_.all();
  rest_.clear(), rest_batches_.clear();
  for (const int contact : island.contacts) {
    const auto after = std::upper_bound(all.begin(), all.end(), contact,
                                        [](int number, const Pair& pair) { return number < pair.first; });
    const int pair = int(after - all.begin()) - 1;
    if (rest_.empty() || rest_.back() != pair) rest_.push_back(pair);
  }
  std::sort(rest_.begin(), rest_.end(), [&](int i, int j) { return all[i].slot < all[j].slot; });
  int lane = kLanes, colour = -1;
  for (const int i : rest_) {
    const Pair& pair = all[i];
    if (lane == kLanes || pair.colour != colour || pair.alone)
      rest_batches_.push_back(empty_batch(int(state.x.size()))), lane = 0, colour = pair.colour;
    copy_lane(batches_[pair.slot / kLanes], pair.slot % kLanes, rest_batches_.back(), lane++);
  }
  constants_ = {h, 1e300, 0, 0, {}, nullptr};
  old_.assign(old_.size(), {});
  plane::warm_start(rest_batches_.data(), int(rest_batches_.size()), poses_.data(), poses_.data(),
                    old_.data(), moving_.data(), constants_, slow_, fast_);
  return std::clamp(kRestPairs / std::max(1, int(rest_.size())), kFewestAtRest, kMostAtRest);
}

void PlaneIterative::iterate_rest(int) {
  plane::iterate(rest_batches_.data(), int(rest_batches_.size()), poses_.data(), moving_.data(), constants_);
}

void PlaneIterative::finish_rest(const Sleep<D>::Island&, State<D>& state, double) {
  plane::iterate_last(rest_batches_.data(), int(rest_batches_.size()), poses_.data(), moving_.data(),
                      constants_, state.contacts.data());
  for (const ContactBatch& own : rest_batches_) {
    for (int k = 0; k < kLanes; ++k) {
      if (own.pair[k] < 0) continue;
      const int slot = pairs_.all()[own.pair[k]].slot;
      copy_lane_forces(own, k, batches_[slot / kLanes], slot % kLanes);
    }
  }
}

}  // namespace obscura::sim
