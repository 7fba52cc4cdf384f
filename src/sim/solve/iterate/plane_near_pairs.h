#pragma once

#include <span>
#include <vector>

#include "sim/collide/broad_phase.h"
#include "sim/collide/core_shapes.h"
#include "sim/collide/may_touch.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"
#include "sim/solve/iterate/plane_box_pairs.h"

namespace obscura::sim::plane {

/// Broad phase with margins: which cores may touch within a span of time.
class NearPairs {
 public:
  NearPairs(const Model<2>& model, const CoreShapes& cores);

  /// Two cores of different bodies, a < b, that may touch if their distance is at most `margin`, m.
  struct Candidate {
    int a, b;
    int meeting;  // of two boxes: the lane of their manifold, lane + kLanes * group; else -1
    double margin;
  };

  /// Finds all pairs that may touch within `span` s. Leaves out pairs of bodies that rest or are calm: so
  /// slow that they hardly move in `patience` spans. False if no body needs a search.
  bool find(const State<2>& state, const std::vector<Pose>& poses, double span, int patience);
  static constexpr int kCalmSearches = 16;

  /// The `patience` of search `number`, a ruler sequence: 2, 4, 2, 8, 2, 4, 2, 16, ... So every search
  /// includes the fast bodies, every other one those half as fast too, and every kCalmSearches-th (0) all
  /// bodies.
  static int patience(long long number) {
    number %= kCalmSearches;
    return number == 0 ? 0 : 2 * int(number & -number);
  }

  /// The pairs of the last search, ascending.
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const BoxManifold& manifold(const Candidate& c) const { return manifolds_[c.meeting / kLanes]; }
  /// Whether the last search left a body out, as it does all walls.
  bool still(int body) const { return body < 0 || still_[body] != 0; }
  /// Whether a body takes no part, as it collides by the handout's law.
  bool apart(int body) const { return handout_[body] != 0; }
  /// How far a body may move within the span, m.
  double margin(int body) const { return movers_[body].margin; }

  /// The part of margin() that covers speed gained by impacts within the span (m), for a body of `speed` m/s.
  double spare(int body, double speed, double span) const;

  /// How far a kinematic body may be, in the next span, from where its present velocity takes it, m.
  void foresee(int body, double farther) { farther_[body] = farther; }

  /// Whether both are single boxes centred on their bodies.
  bool boxes(int a, int b) const { return halves_[a].wide > 0 && halves_[b].wide > 0; }
  /// plane::find_outdated() of all batches, in their order, shared by the model's workers.
  void find_outdated(const std::vector<ContactBatch>& batches, const std::vector<Motion>& v,
                     const std::vector<Pose>& poses, double share, std::vector<ChangedPair>& boxes,
                     LaneList& others);

 private:
  // a body in one cache line
  struct alignas(64) Mover {
    double x = 0, y = 0, vx = 0, vy = 0;
    double margin = 0;            // m
    double swing = 0, speed = 0;  // m/s: what spin adds to a point, at most; the speed of the fastest point
    double bounding_radius = 0, half_thickness = 0;  // m
  };
  void compute_margins(const State<2>& state, const std::vector<Pose>& poses, double span, int patience);
  void compute_bounds(const std::vector<Pose>& poses);
  void mark_possible_impacts(double span);
  void collide_box_pairs(const std::vector<Pose>& poses);

  const Model<2>& model_;
  const CoreShapes& cores_;
  MayTouch<2> may_touch_;
  BroadPhase<2> broad_;
  std::vector<HalfSides> halves_;
  std::vector<Mover> movers_;
  std::vector<Bounds<2>> bounds_;      // of cores
  std::vector<char> fixed_, handout_;  // one a body, copied from the model
  std::vector<double> farther_;        // one a body: see foresee(); empty: no body is kinematic
  std::vector<char> still_;            // bodies
  std::vector<char> still_cores_, points_;
  std::vector<char> exposed_;  // one a body: it may be struck within the span
  Islands groups_;             // bodies that may be thrown against each other
  std::vector<Candidate> candidates_;
  std::vector<BoxManifold> manifolds_;
  // what a piece of find_outdated() has found
  struct Outdated {
    std::vector<ChangedPair> boxes;
    LaneList others;
  };
  std::vector<Outdated> outdated_;
  double calm_ = 0;        // m: how far a calm body may move
  double elasticity_ = 0;  // the largest of all bodies and walls
};

}  // namespace obscura::sim::plane
