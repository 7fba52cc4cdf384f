#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "sim/model/state.h"
#include "sim/solve/iterate/impact_queue.h"
#include "sim/solve/iterate/instant_impact.h"
#include "sim/solve/iterate/joint_solver.h"
#include "sim/solve/iterate/plane_contact_rows.h"
#include "sim/solve/iterate/plane_pair_cache.h"
#include "sim/solve/iterate/struck_ends.h"

namespace obscura::sim::plane {

/// Impacts: contact points that close within a substep faster than the resting speed. Newton's law with
/// Coulomb friction, normals and friction of a pair together; pairs in the order of time, each at its own
/// time and at the poses of that time, until none approaches. What meets in one instant is solved together,
/// if it is few and the model says so (Model::impacts), else pair after pair. A body on joints is struck
/// together with all bodies of its component, whose taut ropes and reached limits push back.
class Impacts {
 public:
  /// `pairs` is kept by reference. `together`: what meets in one instant is solved together.
  Impacts(const CoreShapes& cores, const Pairs& pairs, bool together);

  /// Builds, for each body, the list of its awake pairs.
  void list_pairs(const std::vector<Pair>& pairs, const std::vector<Motion>& v);

  /// Resolves the impacts of the lanes in `found` and all that follow from them. `old`: velocities at the
  /// start; dv: what the substep adds to them without contacts; struck_joints: a solver for where impacts
  /// find the joints. Adds the change by impacts to v, marks lanes as struck, and sets least() for them.
  /// Returns a body whose impacts do not end (sim/solve/iterate/endless_impacts.h), or -1.
  int run(const LaneList& found, const std::vector<Pair>& pairs, std::vector<ContactBatch>& batches,
          const std::vector<Pose>& poses, const std::vector<Pose>& middle, const std::vector<Motion>& old,
          const std::vector<Motion>& dv, std::vector<Motion>& v, const SubstepConstants& constants,
          JointSolver<2>& joints, JointSolver<2>& struck_joints);

  /// The work of kinematic bodies and belts by the impacts of the last run, J.
  double drive_work() const { return drive_work_; }

  /// One a batch: the normal speeds (m/s) that the iterations must reach, at least, in lanes that are struck.
  const TargetSpeeds* least() const { return least_.data(); }

  /// Forgets the impulses of the step before.
  void clear() { struck_.clear(); }
  /// Records the impulses of the last run, under the keys of the contacts.
  void record(const std::vector<Pair>& pairs, const std::vector<Contact<2>>& contacts,
              const std::vector<ContactBatch>& batches);
  /// Writes all that was recorded into the contacts.
  void store_impulses(std::vector<Contact<2>>& contacts) const;

  /// The awake pairs of a body.
  std::span<const int> around(int body) const { return around_.of(body); }

  /// Impacts of a body: the times of the first and the last (s from the start of the substep; -1: none), its
  /// displacement until the last, and its velocity after that.
  double first(int body) const { return first_[body]; }
  double last(int body) const { return when_[body]; }
  const Motion& way(int body) const { return way_[body]; }
  const Motion& after(int body) const { return now_[body]; }
  /// What its impacts have given to a body.
  Motion given(int body) const { return when_[body] < 0 ? Motion() : dv_impacts_[body]; }

 private:
  struct Struck {
    ContactKey key;
    Vec<2> impulse;  // on a, N s
    bool pushed;
  };
  // a direction, and the moments of a push along it about both bodies, m
  struct Push {
    double x, y, a, b;
  };
  struct Impact {
    int pair = -1;
    double when = 0;       // s: the rows are those of then
    bool renewed = false;  // its features are others than those of the lane
    bool met[2] = {false, false};
    double speed = 0;                     // m/s: of the fastest touch that closes
    double gap[2] = {0, 0};               // m
    double n[2] = {0, 0}, t[2] = {0, 0};  // impulses, N s
    Push pushes[2][2] = {};               // along normals and across them, of each touch

    bool any() const { return n[0] != 0 || n[1] != 0; }
  };
  // a pair as it stands at a time, and how its bodies move
  struct PlacedPair {
    double when = 0;
    bool renewed = false;  // by other features than those of the lane
    Motion a, b;
    TouchRow rows[2];
  };
  // whether a pair has had an impact, and by other features than those of the lane
  enum class Met : unsigned char { none, struck, renewed };
  // an impact of several pairs in one instant, and how the bodies of each move before it
  struct Meeting {
    Impact impact;
    Motion a, b;
    bool moved = false;  // by the impact, directly or by ends of joints
  };
  // what a row does to one of its bodies
  struct StruckSide {
    int body;
    double x, y, turn, im, ii;  // of the row; what it moves
  };
  // what does not change while the impacts of a step are resolved
  struct Step {
    const std::vector<Pair>& pairs;
    const std::vector<Pose>&poses, &middle;
    const std::vector<Motion>&old, &dv;
    const SubstepConstants& constants;
    JointSolver<2>&joints, &struck_joints;
  };
  void reach(int body, double when, const Step& step);
  Motion way_at(int body, double when, const Step& step) const;
  void place_joints(const Pair& pair, double when, const Step& step);
  void move(int body, double when, const Step& step, Pose& pose, Motion& v) const;
  PlacedPair placed_at(const Pair& pair, double when, const ContactBatch& batches, const Step& step) const;
  double closing_guess(const Pair& pair, int k, const ContactBatch& batches, const PlacedPair& at,
                       const Step& step) const;
  double closing_time(const Pair& pair, int k, const ContactBatch& batches, const PlacedPair& start,
                      const Step& step) const;
  double most_bend(const Pair& pair, const Motion& va, const Motion& vb) const;
  bool may_meet(const Pair& pair, const ContactBatch& batches, const Step& step) const;
  double first_closing(const Pair& pair, const ContactBatch& batches, const PlacedPair& start,
                       const Step& step, int& which) const;
  void features_at(const Pair& pair, double when, const Step& step, int (&words)[2]) const;
  static bool still_nearest(const Pair& pair, const int (&words)[2], const ContactBatch& by, int k);
  static bool outdated(const Pair& pair, const int (&words)[2], const ContactBatch& by);
  PlacedPair placed_renewed(const Pair& pair, const int (&words)[2], double when, const Step& step);
  bool find_meeting(const Pair& pair, const ContactBatch& batches, PlacedPair& at, const Step& step);
  static double closed_gap(const Pair& pair, const PlacedPair& at, double far);
  static bool place_touch(const TouchRow& r, double together, int k, Impact& impact);
  bool find_impact(const Pair& pair, Impact& impact, const ContactBatch& batches, const Step& step);
  int rounds(const Pair& pair) const { return rounds_[pair.a] + (pair.b < 0 ? 0 : rounds_[pair.b]); }
  void look_at(int pair);
  bool predict(int pair, Impact& impact, const std::vector<ContactBatch>& batches, const Step& step);
  bool resolve(Impact& impact, const std::vector<ContactBatch>& batches, const Step& step);
  bool reach_component(const Pair& pair, double when, const Step& step);
  std::pair<double, double> place_at(int body, double when, const Step& step) const;
  bool meets_at(const Pair& pair, double when, const ContactBatch& batches, const Step& step,
                Meeting& meeting);
  bool gather_instant(const Impact& first, const std::vector<ContactBatch>& batches, const Step& step);
  bool grow_instant(const Impact& first, const std::vector<ContactBatch>& batches, const Step& step);
  bool near_at(const Pair& pair, int body, double when, const Step& step) const;
  bool knows(int pair) const;
  void jam(const Pair& pair);
  bool jams(const Pair& pair) const {
    return jammed_[std::size_t(pair.a)] || (pair.b >= 0 && jammed_[std::size_t(pair.b)]);
  }
  bool crowd() const;
  int most_together() const;
  static bool on_joints(int body, const Step& step);
  const Pair& pair_of(int touch, const Step& step) const;
  const Push& push_of(int row) const;
  std::array<StruckSide, 2> sides(int row, const std::vector<ContactBatch>& batches, const Step& step) const;
  void couple_instant(const std::vector<ContactBatch>& batches, const Step& step, bool tied);
  void take_alone(const Impact& first);
  void gather_ends(double when, const Step& step);
  bool resolve_instant(const Impact& first, const std::vector<ContactBatch>& batches, const Step& step);
  void had_impact(const Impact& impact, const Step& step);
  void give(int body, double x, double y, double w) {
    now_[body].x += x, now_[body].y += y, now_[body].w += w;
    dv_impacts_[body].x += x, dv_impacts_[body].y += y, dv_impacts_[body].w += w;
  }
  bool locked(const Impact& impact, int touch, const std::vector<ContactBatch>& batches, const Step& step);
  void compute_responses(const Pair& pair, const Push (&pushes)[2][2], const bool (&closes)[2],
                         const Step& step);
  static double speed(const Push& push, const Motion& a, const Motion& b) {
    return push.x * (a.x - b.x) + push.y * (a.y - b.y) + (push.a * a.w - push.b * b.w);
  }
  // No slower does a touch of a lane strike, -m/s; dvn: how much faster it closes by the substep's forces,
  // but for those of joints, which whip.
  double strike_speed(const Pair& pair, double impact_speed, double dvn, const Step& step) const {
    const auto tied = [&](int body) { return body >= 0 && step.joints.has(body); };
    if (!step.joints.empty() && (tied(pair.a) || tied(pair.b))) return impact_speed;
    return std::min(impact_speed, step.constants.rests * dvn);
  }
  // what forces give to a closing speed in the substep, as far as it is more than gravity does
  static double gains(double dvn, const Pair& pair) { return dvn < -pair.impact_speed ? dvn : 0; }
  // how a body moves at an impact of its, or one that no impact moves at that time
  Motion motion_at(int body, double when, const Step& step) const {
    Motion v = now_[body];
    if (v.im > 0) return v;
    const double share = when / step.constants.h;
    const Motion& gain = step.dv[body];
    v.x += share * gain.x, v.y += share * gain.y, v.w += share * gain.w;
    return v;
  }
  bool strikes(int a, int b, const Motion& va, const Motion& vb, const Step& step) const;
  PlacedPair placed_by_nearest(const Pair& pair, double when, const ContactBatch& g, const Step& step);
  bool parts_at(const Pair& pair, double when, const ContactBatch& g, const Step& step);
  bool apart_at(const Pair& pair, double when, const ContactBatch& g, const Step& step);
  void leave_to_iterations(std::vector<ContactBatch>& batches, const Step& step);
  const Rows& rows(int group, const std::vector<ContactBatch>& batches, const std::vector<Pose>& poses);

  const Pairs& pairs_;
  ContactBatch fresh_{};                 // of a pair: the features that are nearest when it meets
  std::vector<double> bounding_radius_;  // of bodies, and of walls, m
  ByBody around_;                        // pairs
  std::vector<int> bodies_;              // with impacts
  std::vector<double> first_, when_;     // s: of each body's first and last impact; -1: none
  std::vector<Pose> pose_;               // of those with impacts: at the last
  std::vector<Motion> way_;              // of those with impacts: from the start of the step to the last
  std::vector<Motion> now_;              // velocities after it, or as the step begins
  std::vector<Motion> dv_impacts_;       // what their impacts gave to them
  std::vector<int> rounds_;              // impacts of each body
  double drive_work_ = 0;                // J

  std::vector<int> queue_;        // pairs to be looked at, as one of their bodies just had an impact
  ImpactQueue due_;               // numbers of predicted_
  std::vector<char> waiting_;     // of pairs: in queue_
  std::vector<Met> met_;          // of pairs, as they are left to the iterations
  std::vector<char> impacts_of_;  // of pairs: whether they had one
  std::vector<Impact> predicted_;
  std::vector<Impact> impacts_;  // in the order of time
  std::vector<Struck> struck_;
  std::vector<int> passing_;  // pairs that come near without an impact
  std::vector<int> known_;    // of groups: place in rows_, or -1
  std::vector<int> groups_;
  std::vector<Rows> rows_;
  std::vector<TargetSpeeds> least_;                // of groups
  JointSolver<2>::JointResponse responses_[2][2];  // of normals, and of tangents
  bool together_ = true;
  int instants_ = 0;                         // of this substep
  int spent_ = 0;                            // on large ones of these
  std::vector<char> crowded_;                // of bodies: their impacts go pair after pair in this substep
  std::vector<int> crowd_;                   // these
  std::vector<char> jammed_;                 // of bodies: no impulses end their impacts
  std::vector<Meeting> meetings_;            // in one instant, the first that was found first
  std::vector<std::pair<int, int>> closed_;  // their touches: of which meeting, which of its two
  StruckEnds<2> ends_;
  InstantImpact<2> instant_;
  std::vector<std::pair<int, Motion>> changes_;                   // by it, of bodies
  std::vector<JointSolver<2>::JointResponse> instant_responses_;  // of its rows
};

}  // namespace obscura::sim::plane
