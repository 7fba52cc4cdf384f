#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/math/islands.h"
#include "sim/model/drives.h"
#include "sim/motion/forward_dynamics.h"
#include "sim/solve/cone/cone.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/iterate/joint_solver.h"
#include "sim/solve/iterate/plane_contact_rows.h"
#include "sim/solve/iterate/plane_equilibrium.h"
#include "sim/solve/iterate/plane_impacts.h"
#include "sim/solve/iterate/plane_pair_cache.h"
#include "sim/solve/iterate/substeps.h"
#include "sim/solve/iterate/touch_notes.h"
#include "sim/solve/sleep.h"

namespace obscura::sim {

/// The iterative solver of the plane, for thousands of bodies. Pairs are found 60 times a second, forces by a
/// few warm-started iterations a step. All that is carried from step to step is in the state: its contacts,
/// those of pairs that may touch soon among them, hold forces and feature numbers. Members are scratch and
/// follow from the state, so a run cut in two is the run in one. Scratch is reused if step, poses and
/// velocities of the state are bit for bit those that the last step left.
class PlaneIterative final : public ContactSolver<2> {
  static constexpr int D = 2;

 public:
  /// Both are kept by reference.
  explicit PlaneIterative(const Model<D>& model, const std::vector<Path<D>>& paths);

  void begin_anew() override { anew_ = true; }
  void watch(Course<D>* course) override { notes_.watch(course); }
  bool collide(StepPart<D> step) override;
  void wake(StepPart<D> step) override;
  int substeps() const override { return substeps_; }
  const Vec<D>* corrections() const override { return corrected_ ? corrections_.data() : nullptr; }
  const std::vector<char>* pushed_by_joints() const override { return joints_.pushed(); }
  void move_free(StepPart<D> part) override;
  void warm_start(StepPart<D> part) override;
  void resolve_impacts(StepPart<D> part) override;
  void iterate(StepPart<D> part) override;
  void advance(StepPart<D> part) override;
  void project(StepPart<D> part) override;
  void report(StepPart<D> step) override;
  void sleep(StepPart<D> step) override;

 private:
  using Motion = plane::Motion;

  // Of the thickness of the thinner body: contacts with wider gaps are ignored in a substep. A body fast
  // enough to cross such a gap is swept instead.
  static constexpr double kSight = 0.5;
  // m; a point, which has no thickness, is seen from a little way off
  double sight(const plane::CoreShape& a, const plane::CoreShape& b) const {
    const double thin = std::max(std::min(a.half_thickness, b.half_thickness), 0.5 * (a.radius + b.radius));
    const double thick = std::max(a.half_thickness, b.half_thickness);
    return kSight * (thin > 0 ? thin : std::min(thick, kPointWidth * model_.scale));
  }

  bool gather(const State<D>& state);
  // whether overlaps are those that the scene has, too small for it to refuse them
  bool at_start(const State<D>& state) const { return state.step == 0 && model_.overlap == Overlap::refuse; }
  bool first(StepPart<D> part) const { return part.substep == 0 && part.state.step % every_ == 0; }
  double share(StepPart<D> part) const;
  void renew_pairs(StepPart<D> part);
  bool strained(const State<D>& state) const;
  void report_pair(const plane::Pair& pair, State<D>& state) const;
  void note_touches(StepPart<D> part);
  void build_batches(const State<D>& state, bool known);
  void place_contacts(State<D>& state, bool all) const;
  void clear_sleeping(const State<D>& state);
  bool put_to_sleep(State<D>& state, double h);
  bool update_batches(const State<D>& state);
  int colour(const plane::Pair& pair);
  void clear_lane(int slot);
  void fill_lane(int pair, const State<D>& state);
  void write_lane(const plane::Pair& pair, const State<D>& state);
  void first_guess(State<D>& state);
  int fewest_iterations() const;
  void begin_joints(StepPart<D> part);
  void settle_pairs();
  double squared_change() const;
  void solve_exhausted();
  void solve_together(std::span<const std::pair<int, int>> lanes);
  void integrate_unconstrained(State<D>& state, double t, double h);
  void share_free_motion(StepPart<D> part);
  void integrate_jointed(StepPart<D> part);
  void start_joint_rows();
  void set_driven_joints(const std::vector<Motion>& motions);
  void move_driven(StepPart<D> part);
  void place_driven(State<D>& state);
  bool wake_near_driven(StepPart<D> step);
  void foresee_driven(double t);
  double belt_of(int body) const { return body < 0 ? 0 : model_.bodies[std::size_t(body)].belt[0]; }
  void book_contacts(StepPart<D> part) const;
  void copy_to_joints();
  void copy_from_joints();
  void solve_joint_velocities();
  void project_joints(State<D>& state, double h);
  void correct_overlaps(const State<D>& state);
  void place_bodies(State<D>& state, double h, bool apply_push_out);
  void update_pairs(State<D>& state, bool known);
  bool outran(double h, double left) const;
  double safe_fraction(int body, const plane::Pose& from, const Motion& way, double begun, double h,
                       bool walls) const;
  Motion mean_way(int body, double h) const;
  Motion course(int body, double h);
  bool sinks(int body, const Motion& way, double h) const;
  bool fast(int body, const Motion& way) const;

  const Model<D>& model_;
  plane::CoreShapes cores_;
  plane::Pairs pairs_;
  plane::Impacts impacts_;
  Sleep<D> sleep_;
  plane::Equilibrium equilibrium_;
  ForwardDynamics<D> dynamics_;
  JointSolver<D> joints_;
  Drives<D> drives_;
  std::vector<DrivenMotion<D>> driven_;  // kinematic bodies at the end of the substep
  std::vector<char> carries_;            // one a body: kinematic or with a belt; empty: there are none
  double driven_gain_ = 0;               // m/s: the most that a substep adds to a point of a kinematic body
  Stages stages_;
  std::int64_t every_ = 1;  // steps between two pair searches
  double span_ = 0;         // the same, s
  AllowedOverlap allowed_overlap_;
  TouchNotes<D> notes_;
  int substeps_ = 1;                  // of this step
  double closing_rate_ = 0;           // at the start of the step, in widths, 1/s
  bool anew_ = false;                 // the next step searches for pairs, even if no search is due
  bool outran_ = false;               // a body has left the margin of the last pair search
  double restitution_threshold_ = 0;  // m/s: slower approaches do not bounce
  bool drag_ = false;

  // One entry a body, and one more that never moves, for walls
  std::vector<plane::Pose> poses_, begun_;  // now, and at the start of the substep
  std::vector<double> turns_;               // the angles of poses_, rad
  std::vector<double> ii_;                  // 1/(kg m^2); 0: asleep or fixed
  std::vector<Motion> v_, old_;             // now, and at the start of the substep
  // Of the whole step without contacts: the change of velocity, and of the displacement what exceeds h times
  // the mean velocity
  std::vector<Motion> gain_, bend_;
  std::vector<Motion> dv_, dx_;      // of the substep without contacts: changes of velocity and of pose
  std::vector<Motion> push_;         // displacements by correct_overlaps()
  std::vector<Vec<D>> corrections_;  // of them, the centres'
  bool corrected_ = false;
  std::vector<char> closing_;  // a contact of the body closed slowly in this substep
  std::vector<char> frozen_;   // State::frozen when lanes were assigned
  std::vector<char> fixed_;
  struct Light {
    double im, ii;  // 1/kg, 1/(kg m^2)
  };
  std::vector<Light> light_;
  std::vector<char> movers_;  // one a body: springs, hands or forces act on it

  std::vector<std::uint64_t> colours_;     // one a body: a bit for each colour in use
  std::vector<int> count_, begin_, ends_;  // one a colour: its next free lane, its first lane and its end
  std::vector<plane::ContactBatch> batches_;
  std::vector<plane::Projection> projections_;
  plane::LaneList slow_, fast_;
  plane::StepConstants constants_;  // of the substep
  plane::ActiveBodies active_bodies_;
  std::vector<plane::LaneImpulses> before_, directions_;  // by group, while iterations are accelerated
  // islands that iterations have not settled
  struct Touch {
    int slot, k;
    plane::TouchRow row;
  };
  struct Exhausted {
    Islands sets;
    std::vector<int> contacts;               // at roots
    std::vector<std::pair<int, int>> lanes;  // root and lane
    std::vector<Touch> touches;
    Cone<2> cone;
    std::vector<ConeBlock<2>> blocks;
    std::vector<ConeMode<2>> modes;
    Eigen::MatrixXd K;
    Eigen::VectorXd b, p;
  } exhausted_;
  bool deep_ = false;                    // some overlap exceeds the allowed one
  int iterations_ = 0;                   // of this substep, over all pairs
  std::vector<int> slots_, next_slots_;  // the pair in each lane
  std::vector<int> moved_;               // pairs that change lanes
  std::int64_t next_step_ = -1;          // State::step of the state that the last step left
  long version_ = -1;
  int awake_pairs_ = 0;
  double calmest_ = 0;  // m/s: while all points are slower than half of it, no features change
};

}  // namespace obscura::sim
