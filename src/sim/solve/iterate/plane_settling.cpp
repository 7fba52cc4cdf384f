// How iterations of a substep in the plane end: they go on over what has not settled and what lies beside it,
// and those of few pairs to a bound of their own.

#include <algorithm>

#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

using plane::ContactBatch;
using plane::kLanes;
using plane::Pair;

namespace {

constexpr int kSettlingPairs = 20000;   // more, of unsettled pairs: pairs times iterations, at least
constexpr int kSettlingIterations = 8;  // or as many as so many iterations of all pairs
constexpr int kFewPairs = 300;          // accelerated
constexpr int kQuietPairs = 80000;      // where most are quiet, as many, and accelerated
constexpr int kQuietIterations = 400;   // or as many as so many iterations of all
constexpr int kFewIterations = 50;      // more, of few pairs that others do not touch

}  // namespace

// More iterations of pairs that have not settled and of their neighbours: if a column is struck from below,
// the impact must pass through all of it in this substep. Those of few are accelerated by conjugate
// directions (Silcowitz, Niebe and Erleben 2010).
void PlaneIterative::settle_contacts(double) {
  settle_all();
  settle_few();
}

void PlaneIterative::settle_all() {
  const int count = int(batches_.size());
  const bool quiet = closing_rates_.quiet, follows = awake_pairs_ <= kFewPairs || quiet;
  active_bodies_.settled = settled_rate(closing_rates_.most, awake_pairs_), active_bodies_.groups.clear();
  const auto activate = [&] {
    active_bodies_.bodies.assign(turns_.size() + 1, plane::ActiveBodies::kNow);
    active_bodies_.bodies.back() = 0, active_bodies_.next.assign(turns_.size() + 1, 0);
    for (const int body : joints_.bodies()) active_bodies_.bodies[body] = plane::ActiveBodies::kNever;
  };
  activate();
  if (follows) {
    before_.resize(std::size_t(count)), directions_.assign(std::size_t(count), {});
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < 2; ++k)
        std::copy_n(batches_[i].p[k], kLanes, before_[i].p[k]),
            std::copy_n(batches_[i].q[k], kLanes, before_[i].q[k]);
    }
  }
  double change = 0;
  int left = std::max(kSettlingPairs, kSettlingIterations * awake_pairs_);
  if (quiet)
    left = std::max(left, int(share_of_iterations(closing_rates_.most) *
                              std::min(kQuietPairs, kQuietIterations * awake_pairs_)));
  for (int pairs = 1; left > 0; left -= pairs) {
    pairs = iterate_active();
    if (pairs == 0) return;
    const auto now = [](unsigned char flags) { return flags & plane::ActiveBodies::kNow; };
    if (!follows || left <= pairs) continue;
    if (std::none_of(active_bodies_.bodies.begin(), active_bodies_.bodies.end(), now)) return;
    const double changed = squared_change();
    plane::follow(batches_.data(), count, middle_.data(), moving_.data(), before_.data(), directions_.data(),
                  change > 0 && changed <= change ? changed / change : 0, active_bodies_);
    change = changed;
    activate();
  }
}

// Of islands of few pairs those that are not at rest go on to a bound that does not hang on what moves
// elsewhere, or how fast: something heavy that falls on something light is not to bounce, nor to be held the
// worse where something fast is near. What iterations leave is solved exactly.
void PlaneIterative::settle_few() {
  if (few_stale_) find_few();
  if (active_bodies_.settled <= kSettled || few_groups_.empty()) return;
  active_bodies_.settled = kSettled, active_bodies_.groups = few_groups_, active_bodies_.listed = few_bodies_;
  std::fill(active_bodies_.bodies.begin(), active_bodies_.bodies.end(), 0);
  for (const int body : few_bodies_) active_bodies_.bodies[body] = plane::ActiveBodies::kNow;
  for (int i = 0; i < kFewIterations; ++i) {
    if (iterate_active() == 0) return;
  }
}

// islands of so few pairs that they may be solved exactly: their bodies, and the groups with lanes of theirs
void PlaneIterative::find_few() {
  const int n = int(turns_.size());
  const auto moves = [&](int body) { return moving_[body].im > 0; };
  Islands& sets = exhausted_.sets;
  std::vector<int>& pairs = exhausted_.contacts;
  sets.reset(n + 1), pairs.assign(n + 1, 0);
  const auto each_pair = [&](auto&& act) {
    for (const Pair& pair : pairs_.all()) {
      if (pair.slot >= 0) act(pair, pair.b >= 0 ? pair.b : n);
    }
  };
  each_pair([&](const Pair& pair, int b) {
    if (moves(pair.a) && moves(b)) sets.join(pair.a, b);
  });
  for (const int body : joints_.bodies()) pairs[sets.root(body)] = kFewSolved + 1;
  each_pair([&](const Pair& pair, int b) { ++pairs[sets.root(moves(pair.a) ? pair.a : b)]; });
  few_bodies_.clear(), few_groups_.clear();
  for (int i = 0; i < n; ++i) {
    if (const int count = pairs[sets.root(i)]; moves(i) && count > 0 && count <= kFewSolved)
      few_bodies_.push_back(i);
  }
  each_pair([&](const Pair& pair, int b) {
    if (pairs[sets.root(moves(pair.a) ? pair.a : b)] <= kFewSolved) few_groups_.push_back(pair.slot / kLanes);
  });
  std::sort(few_groups_.begin(), few_groups_.end());
  few_groups_.erase(std::unique(few_groups_.begin(), few_groups_.end()), few_groups_.end());
  few_stale_ = false;
}

// what the last iteration has changed of the impulses, each by the masses that it moves; in the order of
// pairs
double PlaneIterative::squared_change() const {
  double sum = 0;
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const plane::LaneImpulses& before = before_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    double its = 0;
    for (int k = 0; k < 2; ++k) {
      const double p = g.p[k][lane] - before.p[k][lane], q = g.q[k][lane] - before.q[k][lane];
      its += p * p + q * q;
    }
    sum += (moving_[g.a[lane]].im + moving_[g.b[lane]].im) * its;
  }
  return sum;
}

}  // namespace obscura::sim
