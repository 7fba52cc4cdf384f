// How contacts of space push positions out of each other, a part of the way, by their own rows: of each in
// turn
//   p' = max(0, p + (share (-g - allowed) - n . u) / K_n)        u  how far it has been pushed apart, m
// over and over. Pairs are sorted by level, as the iterations' are: those of one share no body that moves.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/space.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

namespace {

constexpr int kPartRounds = 2000;  // gaps times rounds of pushing apart; 4 to 16 rounds at least,
constexpr int kMostParts = 10000;  // and so many, until changes are
constexpr double kParted = 1e-12;  // of what is wanted

}  // namespace

// J M^-1 J' of a contact's normal, 1/kg
double SpaceIterative::normal_response(const ContactConstraint& touch) const {
  double sum = 0;
  for (const auto& [body, arm] : {std::pair(touch.a, &touch.arm_a), std::pair(touch.b, &touch.arm_b)}) {
    const PointBody<D>& m = moving_[body];
    const AngularVec<D> turns = moment<D>(*arm, touch.n);
    sum += m.inverse_mass + turns.dot(m.inverse_inertia * turns);
  }
  return sum;
}

// The touches that are too deep, and how far each is to be pushed, m; the greatest of that.
double SpaceIterative::find_overlaps(const State<D>& state, double h) {
  const int n = int(model_.bodies.size());
  const AllowedOverlap let = allowed_overlap(state);
  const double share = corrected_share(state, h);
  double most = 0;
  overlaps_.clear();
  for (int i = 0; i < int(touches_.size()); ++i) {
    const ContactConstraint& touch = touches_[i];
    if (!(touch.gap < 0)) continue;
    const double far = bounding_radius_[touch.a];
    const double allowed =
        let(touch.b == n ? far : std::max(far, bounding_radius_[touch.b]), 1 / touch.per_width);
    if (!(touch.gap < -allowed)) continue;
    overlaps_.push_back({i, share * (-touch.gap - allowed)});
    most = std::max(most, overlaps_.back().wanted);
  }
  return most;
}

// the pairs of these, by their levels
void SpaceIterative::sort_overlaps() {
  overlap_pairs_.clear(), overlap_levels_.begin(moving_.size());
  for (int first = 0, end = 0; first < int(overlaps_.size()); first = end) {
    const ContactConstraint& touch = touches_[overlaps_[first].touch];
    const auto same = [&](int i) {
      const ContactConstraint& other = touches_[overlaps_[i].touch];
      return other.a == touch.a && other.b == touch.b;
    };
    for (end = first + 1; end < int(overlaps_.size()) && same(end);) ++end;
    const auto moves = [&](int body) { return moving_[body].inverse_mass > 0; };
    const int level = overlap_levels_.next(touch.a, moves(touch.a), touch.b, moves(touch.b));
    overlap_pairs_.push_back({level, first, end});
  }
  // counted, and each to the next place of its level
  overlap_begins_.assign(std::size_t(overlap_levels_.count()) + 1, 0);
  for (const OverlapPair& pair : overlap_pairs_) ++overlap_begins_[std::size_t(pair.level) + 1];
  for (std::size_t i = 1; i < overlap_begins_.size(); ++i) overlap_begins_[i] += overlap_begins_[i - 1];
  overlap_places_.assign(overlap_begins_.begin(), overlap_begins_.end() - 1);
  sorted_overlaps_.resize(overlap_pairs_.size());
  for (const OverlapPair& pair : overlap_pairs_)
    sorted_overlaps_[std::size_t(overlap_places_[std::size_t(pair.level)]++)] = pair;
  overlap_pairs_.swap(sorted_overlaps_);
}

// once over all of a pair; what another has pushed apart too is taken back
void SpaceIterative::push_apart(OverlapPair& pair) {
  pair.change = 0;
  for (int i = pair.first; i < pair.end; ++i) {
    OverlappingTouch& it = overlaps_[std::size_t(i)];
    const ContactConstraint& touch = touches_[it.touch];
    const double left = std::max(it.wanted - touch.n.dot(slip(touch)), -it.response * it.parted);
    it.parted += left / it.response;
    push(touch, left / it.response * touch.n);
    pair.change = std::max(pair.change, std::fabs(left));
  }
}

void SpaceIterative::correct_overlaps(StepPart<D> part) {
  State<D>& state = part.state;
  const double most = find_overlaps(state, part.h);
  if (overlaps_.empty()) return;
  sort_overlaps();
  begin_corrections();
  kept_ = moving_;
  each(workers(), int(overlaps_.size()), kBodyPiece, [&](int begin, int end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i)
      overlaps_[i].response = normal_response(touches_[overlaps_[i].touch]);
  });
  for (PointBody<D>& m : moving_) m.v.setZero(), m.w.setZero();  // and belts do not push
  const int count = int(overlaps_.size());
  const int fewest = std::clamp(kPartRounds / count, 4, 16), rounds = std::max(fewest, kMostParts / count);
  // few until nothing changes: then the order in which they are visited does not matter
  double change = 1;
  for (int round = 0; round < rounds && (round < fewest || change > kParted * most); ++round) {
    for (std::size_t level = 0; level + 1 < overlap_begins_.size(); ++level) {
      const int first = overlap_begins_[level];
      each(workers(), overlap_begins_[level + 1] - first, kBodyPiece, [&](int begin, int end) {
        for (int i = first + begin; i < first + end; ++i) push_apart(overlap_pairs_[std::size_t(i)]);
      });
    }
    change = 0;
    for (const OverlapPair& pair : overlap_pairs_) change = std::max(change, pair.change);
    if (joints_.empty()) continue;
    velocities_to_joints();
    joints_.solve_positions();
    velocities_from_joints();
  }
  each(workers(), int(model_.bodies.size()), kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (inactive_[i]) continue;
      state.x[i] += moving_[i].v, corrections_[i] += moving_[i].v;
      const int k = turning(state, i);
      if (k < 0 || moving_[i].w.isZero(0)) continue;
      const Orientation<D> before = state.turn[k];
      state.turn[k] = turned<D>(before, moving_[i].w);
      if (!wobbles<D>(model_.bodies[i].inertia)) continue;
      // its spin goes along: its energy is the same about axes that have turned with it
      const AngularVec<D> own = from_room<D>(rotation<D>(before), state.spin[k]);
      kept_[i].w = state.spin[k] = to_room<D>(rotation<D>(state.turn[k]), own);
    }
  });
  moving_.swap(kept_);
}

}  // namespace obscura::sim
