// How iterations of a substep in space end: island by island they go on until contacts have settled; what few
// contacts do not settle is solved exactly, and what contacts would give is shed.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

namespace {

constexpr int kSettlingTouches = 50000;  // times iterations, of touches that have not settled then
constexpr int kIslandTouches = 300;      // the least of an island
constexpr int kFewestFollowed = 20;      // iterations: of less none are accelerated
constexpr int kFewTouches = 500;         // of more, less in proportion, but as if
constexpr int kSettlingRounds = 3;       // so many were of all
constexpr int kQuietTouches = 400000;    // of islands that are quiet so many, whatever else there is
constexpr int kQuietRounds = 400;
constexpr double kEnough = 0.3;       // speed, of what gravity gives in the substep, where there are
constexpr int kCrowdTouches = 5000;   // so many; of less, less as the square: a row passes a blow on slowly
constexpr int kFewExactly = 60;       // touches
constexpr double kExactly = 1e-12;    // of how fast bodies of an island pass each other,
constexpr int kExactTouches = 2000;   // within so many touches times iterations
constexpr double kUneven = 50;        // masses of an island that is solved exactly, most to least
constexpr int kShedding = 5;          // sweeps
constexpr int kRestIterations = 400;  // iterations of an island at rest
constexpr double kClosedGap = 1e-6;   // of the narrower body: so near it bears

int settling_budget(int touches) {
  return touches <= kFewTouches
             ? kSettlingTouches
             : std::max(kSettlingTouches / touches * kFewTouches, kSettlingRounds * touches);
}

}  // namespace

// More iterations of those contacts that are not settled and of those beside them: where a column is struck
// from below, the blow is to pass through all of it in this substep. Few go on until hardly anything changes,
// for a while: then the order in which they are visited does not matter, and mirror images stay so. Those of
// few, and of those that hardly move, are accelerated (Silcowitz, Niebe and Erleben 2010): a tower of fifty
// blocks sinks a quarter as far. Bodies on joints are left out. Where many move, the next substep finds what
// is left: they go on until an iteration changes their speeds, in the mean, by less than gravity does by a
// part.
void SpaceIterative::settle_contacts(double h) {
  settling_.begin(touches_, all_, moving_, joints_.bodies());
  bool follows = false;
  const double rounds = double(settling_budget(int(touches_.size()))) / std::max(1, int(touches_.size()));
  for (Settling::Island& island : settling_.islands) {
    island.budget = std::max(int(rounds * island.contacts), kIslandTouches);
    const bool quiet = island.quiet >= kMostlyQuiet * island.contacts;
    if (quiet)
      island.budget = std::max(island.budget, int(share_of_iterations(island.rate) *
                                                  std::min(kQuietTouches, kQuietRounds * island.contacts)));
    island.follows =
        (quiet || island.contacts <= kFewTouches) && island.budget >= kFewestFollowed * island.contacts;
    follows = follows || island.follows;
    if (island.contacts > kFewTouches && island.rate >= kAllButStill) {
      const double crowded = std::min(1.0, double(island.contacts) / kCrowdTouches);
      const double speed = kEnough * crowded * crowded * g_ * h;
      island.enough = speed * speed * island.mass;
    }
  }
  batches_.set_islands(settling_);
  if (follows) batches_.begin_directions();
  if (settling_.islands.empty()) return;
  for (bool back = false;; back = !back) {
    for (Settling::Island& island : settling_.islands) {
      island.friction = int(touches_.size()) <= kFewExactly && island.spent < kExactTouches;
      island.settled = island.friction ? kExactly * island.rate : kSettled;
    }
    batches_.iterate(moving_, back, settling_);
    if (back) settling_.compare_velocities(moving_, bounding_radius_);
    if (!settling_.close_settled()) return;
    if (follows && back) batches_.follow_directions(moving_, settling_);
    settling_.activate_next();
  }
}

// those of few contacts and uneven masses (sim/solve/iterate/exact_island.h)
void SpaceIterative::solve_exhausted() {
  batches_.store(touches_);
  const auto left = [](const Settling::Island& it) { return it.exhausted && it.contacts <= kFewSolved; };
  if (std::none_of(settling_.islands.begin(), settling_.islands.end(), left)) return;
  const auto few = [&](int number) {
    if (number < 0) return false;
    const Settling::Island& island = settling_.islands[number];
    if (!left(island)) return false;
    double least = std::numeric_limits<double>::infinity(), most = 0;  // 1/kg
    for (int i = island.first; i < island.last; ++i) {
      const double inverse_mass = moving_[settling_.bodies[i]].inverse_mass;
      least = std::min(least, inverse_mass), most = std::max(most, inverse_mass);
    }
    return most >= kUneven * least;
  };
  std::vector<std::pair<int, int>>& all = exhausted_;
  all.clear();
  for (int i = 0; i < int(touches_.size()); ++i) {
    const int a = settling_.island_of[touches_[i].a],
              number = a >= 0 ? a : settling_.island_of[touches_[i].b];
    if (few(number) && !touches_[i].passes) all.emplace_back(number, i);
  }
  std::sort(all.begin(), all.end());
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    meets_.clear();
    for (; last < all.size() && all[last].first == all[first].first; ++last)
      meets_.push_back(all[last].second);
    solve_together();
  }
}

// the contacts meets_
void SpaceIterative::solve_together() {
  static const BodyMotion<D> room;
  const int count = int(meets_.size()), n = int(model_.bodies.size());
  begin_rows(count), exact_.resize(count);
  for (int k = 0; k < count; ++k) {
    const ContactConstraint& touch = touches_[meets_[k]];
    set_rows(k, touch, touch.n, touch.arm_a, touch.arm_b, stances_[touch.a],
             touch.b == n ? room : stances_[touch.b]);
    exact_.blocks[k] = {.mu = touch.mu};
    const Vec<D> u = slip(touch), impulse = touch.normal_impulse * touch.n + touch.tangent_impulse;
    for (int i = 0; i < D; ++i) {
      const Vec<D>& way = impact_rows_[D * k + i].along;
      exact_.speeds[D * k + i] = way.dot(u) - (i == 0 ? touch.least : 0);
      exact_.p[D * k + i] = way.dot(impulse);
    }
  }
  couple_rows(exact_.K);
  if (!exact_.solve()) return;
  for (int k = 0; k < count; ++k) {
    ContactConstraint& touch = touches_[meets_[k]];
    Vec<D> impulse = Vec<D>::Zero();
    for (int i = 0; i < D; ++i) impulse += exact_.p[D * k + i] * impact_rows_[D * k + i].along;
    push(touch, impulse - touch.normal_impulse * touch.n - touch.tangent_impulse);
    touch.normal_impulse = exact_.p[D * k];
    touch.tangent_impulse = impulse - exact_.p[D * k] * touch.n;
  }
  const ContactConstraint& any = touches_[meets_[0]];
  const int a = settling_.island_of[any.a];
  settling_.islands[a >= 0 ? a : settling_.island_of[any.b]].exhausted = false;
}

// --- contacts of what hangs on joints (sim/solve/iterate/jointed_contacts.cpp), by their numbers

void SpaceIterative::list_touches(std::vector<TouchEnds>& touches) const {
  const int n = int(model_.bodies.size());
  for (int i = 0; i < int(touches_.size()); ++i) {
    const ContactConstraint& touch = touches_[std::size_t(i)];
    touches.push_back({i, i, touch.a, touch.b < n ? touch.b : -1, touch.passes});
  }
}

SpaceIterative::TouchRows SpaceIterative::read_touch(int number) const {
  const ContactConstraint& from = touches_[std::size_t(number)];
  const PointBody<D>&a = moving_[from.a], &b = moving_[from.b];
  const Vec<D> passes = a.v + cross_velocity<D>(a.w, from.arm_a) - b.v - cross_velocity<D>(b.w, from.arm_b),
               slips = passes + from.surface(), impulse = from.normal_impulse * from.n + from.tangent_impulse;
  TouchRows touch;
  touch.rows = rows_of(from, from.n, from.arm_a, from.arm_b);
  for (std::size_t k = 0; k < D; ++k) {
    const Vec<D>& way = touch.rows[k].along;
    touch.speed[k] = k == 0 ? from.n.dot(passes) - from.least : way.dot(slips);
    touch.impulse[k] = k == 0 ? from.normal_impulse : way.dot(impulse);
  }
  touch.mu = from.mu, touch.per_width = from.per_width;
  return touch;
}

void SpaceIterative::write_touch(int number, const TouchRows& its) {
  ContactConstraint& touch = touches_[std::size_t(number)];
  touch.normal_impulse = its.impulse[0];
  touch.tangent_impulse = its.impulse[1] * its.rows[1].along + its.impulse[2] * its.rows[2].along;
}

// --- those that joints leave nothing to move (sim/solve/iterate/locked_contacts.cpp)

std::array<Row<3>, 3> SpaceIterative::begun_rows(int number) const {
  static const BodyMotion<D> room;
  const ContactConstraint& touch = touches_[std::size_t(number)];
  const BodyMotion<D>&a = stances_[touch.a],
        &b = touch.b == int(model_.bodies.size()) ? room : stances_[touch.b];
  const EvaluatedContact<D> begun = evaluate(features_[std::size_t(number)], a, b);
  return rows_of(touch, begun.normal, begun.point - a.x, begun.point - b.x);
}

bool SpaceIterative::open_touch(int number) {
  ContactConstraint& touch = touches_[std::size_t(number)];
  if (touch.blow || touch.after) return false;
  push(touch, -touch.normal_impulse * touch.n - touch.tangent_impulse);
  touch.normal_impulse = 0, touch.tangent_impulse.setZero();
  touch.least = kNoAim, touch.passes = true, touch.bounces = touch.closing = touch.slides = false;
  return true;
}

void SpaceIterative::bear_touch(StepPart<D> part, int number, double force) {
  touches_[std::size_t(number)].normal_impulse = part.h * force;
}

// Where iterations end before they have converged, contacts may press more than they should, and what they
// bear bounces. Over the substep a contact gives its bodies
//   W = p . (u + u') / 2        u, u'  how fast they pass there, before and after
// Of islands that gain, those contacts that give press less, until nothing is gained: what bounces is
// stopped, and nothing else of the island braked.
void SpaceIterative::shed_gains() {
  static const BodyMotion<D> room;
  const int n = int(model_.bodies.size());
  const auto passing = [&](const ContactConstraint& touch) -> Vec<D> {
    const BodyMotion<D>& b = touch.b == n ? room : stances_[touch.b];
    return stances_[touch.a].velocity(touch.arm_a) - b.velocity(touch.arm_b) + touch.belt + slip(touch) -
           touch.drift;
  };
  const auto island = [&](const ContactConstraint& touch) {
    const int a = settling_.island_of[touch.a];
    return a >= 0 ? a : settling_.island_of[touch.b];
  };
  const auto opens = [&](const ContactConstraint& touch) { return touch.n.dot(passing(touch)); };
  if (std::none_of(settling_.islands.begin(), settling_.islands.end(),
                   [](const Settling::Island& it) { return it.exhausted; }))
    return;
  const int count = int(touches_.size());
  works_.resize(touches_.size());
  each(workers(), count, kTouchPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const ContactConstraint& touch = touches_[i];
      ContactWork& it = works_[i] = {};
      if (!(touch.normal_impulse > 0) || touch.after) continue;
      const int of = island(touch);
      if (of < 0 || !settling_.islands[of].exhausted) continue;
      const Vec<D> passes = passing(touch);
      const double along = touch.n.dot(passes);
      it.island = of, it.work = touch.normal_impulse * along + touch.tangent_impulse.dot(passes);
      it.opens = along > 0 && !touch.bounces;
    }
  });
  given_.assign(settling_.islands.size(), 0), some_.clear();
  for (int i = 0; i < count; ++i) {
    const ContactWork& it = works_[i];
    if (it.island < 0) continue;
    given_[it.island] += it.work;
    if (it.opens) some_.push_back(i);
  }
  std::erase_if(some_, [&](int i) { return !(given_[works_[i].island] > 0); });
  for (int sweep = 0; sweep < kShedding && !some_.empty(); ++sweep) {
    for (const int i : some_) {
      ContactConstraint& touch = touches_[i];
      const double less = std::min(touch.normal_impulse, opens(touch) / normal_response(touch));
      if (!(less > 0)) continue;
      touch.normal_impulse -= less;
      Vec<D> back = -less * touch.n;
      const double size = std::sqrt(touch.tangent_impulse.squaredNorm()),
                   most = touch.mu * touch.normal_impulse;
      if (size > most) {
        const Vec<D> cut = (most / size - 1) * touch.tangent_impulse;
        touch.tangent_impulse += cut, back += cut;
      }
      push(touch, back);
    }
  }
}

// --- islands at rest (sim/solve/iterate/equilibrium.cpp)

int SpaceIterative::begin_rest(const Sleep<D>::Island& island, const State<D>& state, double h) {
  some_.clear();
  for (const int contact : island.contacts) {
    const auto at =
        std::lower_bound(touches_.begin(), touches_.end(), state.contacts[contact].key,
                         [](const auto& touch, const ContactKey& key) { return touch.key < key; });
    some_.push_back(int(at - touches_.begin()));
    at->least = at->gap * at->per_width < kClosedGap ? 0 : -at->gap / h;
    push(*at, at->normal_impulse * at->n + at->tangent_impulse);
  }
  batches_.sort(touches_, some_, moving_);
  batches_.build(touches_, some_, moving_);
  settling_.begin(touches_, some_, moving_, {});
  for (Settling::Island& its : settling_.islands) its.follows = !island.jointed;
  batches_.set_islands(settling_);
  batches_.begin_directions();
  return kRestIterations;
}

void SpaceIterative::iterate_rest(int i) {
  batches_.iterate(moving_, i % 2 == 0);
  if (i % 2 == 0) batches_.follow_directions(moving_, settling_);
}

void SpaceIterative::finish_rest(const Sleep<D>::Island& island, State<D>& state, double h) {
  batches_.store(touches_);
  for (std::size_t i = 0; i < some_.size(); ++i)
    state.contacts[island.contacts[i]] = contact(touches_[some_[i]], h);
}

}  // namespace obscura::sim
