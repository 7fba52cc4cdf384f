#pragma once

#include <span>
#include <vector>

#include "sim/collide/broad_phase.h"
#include "sim/collide/core_shapes.h"
#include "sim/collide/may_touch.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"
#include "sim/solve/iterate/box_pairs.h"

namespace obscura::sim::plane {

/// Which cores may touch within a span of time.
class NearPairs {
 public:
  NearPairs(const Model<2>& model, const CoreShapes& cores);

  /// Two cores of different bodies, a < b, and how near each other they may touch, m. Of two boxes, where
  /// they meet: lane + kLanes * group; else -1.
  struct Candidate {
    int a, b;
    int meeting;
    double margin;
  };

  /// Looks for all that may touch within `span` s; not for those that rest nor for those that are calm: so
  /// slow that they come nowhere in `patience` spans. False where no body needs a search.
  bool find(const State<2>& state, const std::vector<Pose>& poses, double span, int patience);
  static constexpr int kCalmSearches = 16;

  /// For how many spans those must be calm whom look `number` leaves out: every other look is for the fast
  /// alone, of the rest every other for the less fast too, and so on; each kCalmLooks-th is for all.
  static int patience(long long number) {
    number %= kCalmSearches;
    return number == 0 ? 0 : 2 * int(number & -number);
  }

  /// What the last look has found, ascending.
  const std::vector<Candidate>& candidates() const { return candidates_; }
  const BoxManifold& manifold(const Candidate& c) const { return manifolds_[c.meeting / kLanes]; }
  /// Whether a body was not looked for. Walls are not.
  bool still(int body) const { return body < 0 || still_[body] != 0; }
  /// Whether a body touches nothing here: the handout's law moves it.
  bool apart(int body) const { return handout_[body] != 0; }
  /// How far a body may come within the span by itself, m.
  double margin(int body) const { return movers_[body].margin; }

  /// What of this is for speed (m/s) that it may gain meanwhile, by impacts.
  double spare(int body, double speed, double span) const;

  /// How far a body that is moved gets in the next span from where its velocity takes it, m.
  void foresee(int body, double farther) { farther_[body] = farther; }

  /// Whether both are one box about their centre.
  bool boxes(int a, int b) const { return halves_[a].wide > 0 && halves_[b].wide > 0; }
  void find_outdated(const std::vector<ContactBatch>& batches, const std::vector<Motion>& v,
                     const std::vector<Pose>& poses, double share, std::vector<Outdated>& boxes,
                     Found& others) const {
    plane::find_outdated(batches.data(), int(batches.size()), v.data(), poses.data(), halves_.data(), share,
                         boxes, others);
  }

 private:
  // of a body, in one line of memory
  struct alignas(64) Mover {
    double x = 0, y = 0, vx = 0, vy = 0;
    double margin = 0, swing = 0, speed = 0;  // m; m/s of its farthest point, by its spin alone, and at most
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
  std::vector<Half> halves_;
  std::vector<Mover> movers_;
  std::vector<Bounds<2>> bounds_;      // of cores
  std::vector<char> fixed_, handout_;  // bodies: what of the model is asked for often
  std::vector<double> farther_;        // bodies that are moved: see foresee(); empty where there are none
  std::vector<char> still_;            // bodies
  std::vector<char> still_cores_, points_;
  std::vector<char> exposed_;  // bodies that may be struck within the span
  Islands groups_;             // of bodies that may be thrown against each other
  std::vector<Candidate> candidates_;
  std::vector<BoxManifold> manifolds_;
  double calm_ = 0;        // m: how far the calm may come
  double elasticity_ = 0;  // the largest there is
};

}  // namespace obscura::sim::plane
