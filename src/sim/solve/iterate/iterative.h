#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sim/math/islands.h"
#include "sim/math/workers.h"
#include "sim/model/drives.h"
#include "sim/model/script.h"
#include "sim/motion/forward_dynamics.h"
#include "sim/motion/stability.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/iterate/exact_island.h"
#include "sim/solve/iterate/joint_solver.h"
#include "sim/solve/iterate/moving_body.h"
#include "sim/solve/iterate/substeps.h"
#include "sim/solve/iterate/touch_notes.h"
#include "sim/solve/iterate/warm_start.h"
#include "sim/solve/sleep.h"

namespace obscura::sim {

/// The iterative solver, for thousands of bodies: its stages, one text for the plane and for space. Shapes,
/// their features and the wide kernels that iterate their contacts are PlaneIterative's and SpaceIterative's;
/// joints, kinematic bodies, sleep and what a step reports are here. All that is carried from step to step is
/// in the state; members are scratch and follow from it, so a run cut in two is the run in one.
template <int D>
class Iterative : public ContactSolver<D> {
 public:
  void watch(Course<D>* course) final { notes_.watch(course); }
  bool collide(StepPart<D> step) final;
  void wake(StepPart<D> step) final;
  int substeps() const final { return substeps_; }
  void move_free(StepPart<D> part) final;
  // warm_start() and resolve_impacts() are the dimension's
  void iterate(StepPart<D> part) final;
  void advance(StepPart<D> part) final;
  void project(StepPart<D> part) final;
  // report() too
  void sleep(StepPart<D> step) final;
  const Vec<D>* corrections() const final { return corrected_ ? corrections_.data() : nullptr; }
  const std::vector<char>* pushed_by_joints() const final { return joints_.pushed(); }

 protected:
  static constexpr double kPairSearches = 60;   // a second
  static constexpr int kFirstIterations = 100;  // of the first substep, which knows no forces

  /// Both are kept by reference. `deepest`: islands with deeper overlaps do not rest (sim/solve/sleep.h).
  Iterative(const Model<D>& model, const std::vector<Path<D>>& paths, double deepest);

  // What a dimension does in the stages above, in their order.

  /// Pairs that may touch and their features. False: all bodies sleep, and the step is done.
  virtual bool find_contacts(StepPart<D> step) = 0;
  /// Wakes what contacts reach; in the first step sets at rest what begins in equilibrium.
  virtual void update_sleep(StepPart<D> step) = 0;
  /// How fast what touches or may within h s closes, in widths of the narrower body, 1/s: `most` at most;
  /// `ruling` says how many substeps the step has. In the plane, whether most are quiet.
  struct ClosingRates {
    double ruling = 0, most = 0;
    bool quiet = false;
  };
  virtual ClosingRates closing_rates(double h) const = 0;
  /// The ruling one, less spins along normals, which bring no corner nearer: whether substeps are too few for
  /// it is told.
  virtual double approach_rate(double) const { return closing_rates_.ruling; }

  /// Features where bodies have moved since they were found.
  virtual void renew_contacts(StepPart<D> part) = 0;
  /// Moves all bodies without contacts, with the forces of joints, and those that are driven.
  virtual void move_unconstrained(StepPart<D> part) = 0;
  /// A body where the substep begins: how it stands and moves, and its orientation.
  virtual BodyMotion<D> begun(int body) const = 0;
  virtual Orientation<D> begun_turn(int body) const = 0;

  /// Before the first iteration.
  virtual void start_contacts(StepPart<D>) {}
  /// How many iterations over all contacts the substep begins with.
  virtual int iterations(StepPart<D> part) const = 0;
  /// The i-th of them.
  virtual void iterate_contacts(int i) = 0;
  /// More of those that have not settled.
  virtual void settle_contacts(double h) = 0;
  /// The share that a substep has of the iterations of a quiet heap. With n times as many substeps a second
  /// as the fewest, 1 / n: iterations begin with the forces of the last substep, which is as much nearer. 1
  /// of what hardly moves, by `rate` widths a second: its forces are to be found once.
  double share_of_iterations(double rate) const {
    return rate < kAllButStill ? 1 : std::min(1.0, fewest_substeps_ / (substeps_ * value(model_.rate)));
  }
  /// Exactly what few of them do not settle.
  virtual void solve_exhausted() = 0;
  /// What follows each round of iterations, before temper() says whether there is another.
  virtual void end_round(StepPart<D> part) = 0;
  /// A contact that may bear, and its bodies; below zero: what is none. `place`: by which a run cut in two
  /// has them in the same order.
  struct TouchEnds {
    int place, number, a, b;
    bool passes = false;  // no impact is to be expected there
  };
  /// Its rows, normal first, as iterations have them: speeds less what is wanted, and impulses.
  struct TouchRows {
    std::array<Row<D>, D> rows;
    std::array<double, D> speed, impulse;  // m/s, N s
    double mu = 0, per_width = 0;          // 1/m: of the narrower body
  };
  virtual void list_touches(std::vector<TouchEnds>& touches) const = 0;
  virtual TouchRows read_touch(int number) const = 0;
  /// The rows where bodies stand as the substep begins.
  virtual std::array<Row<D>, D> begun_rows(int number) const = 0;
  virtual void write_touch(int number, const TouchRows& its) = 0;
  /// Takes back its impulse; iterations leave it out. False where an impact aims at its speed.
  virtual bool open_touch(int number) = 0;
  /// At the end of the substep: that it bears so much, N, beside what moves bodies.
  virtual void bear_touch(StepPart<D> part, int number, double force) = 0;
  /// Before read_touch() and after write_touch(), if there was any.
  virtual void begin_jointed() {}
  virtual void end_jointed(bool) {}
  /// Whether all that is to be done again, with less restitution.
  virtual bool temper(StepPart<D>, int) { return false; }
  /// The work of kinematic bodies and belts by the contacts of the substep, J.
  virtual double contact_work(StepPart<D> part) const = 0;

  /// Poses and velocities at the end of the substep, into the state: what end_round() has not put there.
  virtual void place_bodies(StepPart<D> part) = 0;
  /// Pushes bodies out of overlaps, where place_bodies() has not.
  virtual void correct_overlaps(StepPart<D>) {}
  /// The joints have moved a body: its pose in the state is new.
  virtual void moved_by_joints(const State<D>&, int) {}
  /// Forces of the substep, to where the next finds them.
  virtual void finish_substep(StepPart<D> part) = 0;
  /// The pairs that bear or are struck in the substep.
  virtual void list_touching(StepPart<D> part, std::vector<std::pair<int, int>>& pairs) const = 0;

  /// The contacts of an island that may fall asleep, by themselves, and the forces that they had. How many
  /// iterations they may take.
  virtual int begin_rest(const typename Sleep<D>::Island& island, const State<D>& state, double h) = 0;
  /// The i-th of them.
  virtual void iterate_rest(int i) = 0;
  /// Their forces, to where the next substep finds them and into the state.
  virtual void finish_rest(const typename Sleep<D>::Island& island, State<D>& state, double h) = 0;
  /// Some bodies have just fallen asleep.
  virtual void stop_sleeping(const State<D>&) {}

  // For these.

  Workers* workers() const { return model_.workers.get(); }
  bool moves(int body) const { return inverse_mass(moving_[std::size_t(body)]) > 0; }
  /// Whether this is the first substep of the run.
  static bool starts(StepPart<D> part) { return part.state.step == 0 && part.substep == 0; }
  /// Whether a formula of the time jumps within a substep of h s: what it drives has its new velocity all the
  /// while, so that it strikes what it touches.
  bool jumps(double h) const { return h < 2 * kJumpPiece * step_length(model_.rate); }
  /// Whether overlaps are those that the scene has, too small for it to refuse them.
  bool at_start(const State<D>& state) const { return state.step == 0 && model_.overlap == Overlap::refuse; }
  AllowedOverlap allowed_overlap(const State<D>& state) const {
    return at_start(state) ? kAllowedAtStart : allowed_overlap_;
  }
  /// m/s: what closes slower is no impact of its own. Of many bodies so is not what closes by clay as slowly
  /// as the fewest substeps follow. `width`: of the narrower body, m.
  double least_strike(double elasticity, double width) const {
    if (elasticity > 0 || !(allowed_overlap_.share > 0)) return restitution_threshold_;
    return std::max(restitution_threshold_, kCloser * kFewestSubsteps * width);
  }
  /// The share of overlaps that is corrected after `time` s.
  double corrected_share(const State<D>& state, double time) const {
    return at_start(state) ? 1 : sim::corrected_share(time);
  }
  /// Of the fastest point of a body, at most, m/s.
  double swiftness(int body) const {
    const MovingBody<D>& m = moving_[std::size_t(body)];
    return std::sqrt(velocity(m).squaredNorm()) +
           bounding_radius_[std::size_t(body)] * std::sqrt(spin(m).squaredNorm());
  }
  /// Whether the scheme sees accelerations as linear in time; if not, it leads what bears aside.
  bool smooth() const {
    return model_.integrator == Integrator::rk4 || model_.integrator == Integrator::midpoint;
  }
  /// Begins bearing_, the contacts of bodies that forces act on, and of what joints tie to these: what moves
  /// them may depend on how they move.
  void begin_bearing(const State<D>& state);
  bool bears(int a, int b) const {
    return forced_[std::size_t(a)] || (b >= 0 && b < int(forced_.size()) && forced_[std::size_t(b)]);
  }
  /// What the forces of bearing_ give to each body, into borne_, for a motion of h s. They are less where the
  /// body is held so stiffly that a wrong force would be answered by one that is as wrong.
  void find_borne(const State<D>& state, double h);
  void add_borne(int body, const Vec<D>& force, const Vec<D>& arm);
  bool wake_near_driven(StepPart<D> step, double span);
  /// How far the i-th kinematic body may be, within h s from t, from where its velocity at t takes it, m.
  double farther(int i, double t, double h);
  void foresee_speeds(StepPart<D> step);
  void begin_corrections();
  /// How much of a contact's force is what this step finds, the rest what it was: over a piece of a step,
  /// which may be a millionth of it, an impulse over its time is no force that lasts.
  double newness() const { return std::min(1.0, 2 * part_of_step_); }
  /// Whether contacts of a body may give energy, or give it not to that body alone.
  bool shares_forces(int body) const {
    return body < int(model_.bodies.size()) &&
           (joints_.has(body) || (!carries_.empty() && carries_[std::size_t(body)]));
  }
  /// To the joint solver: its bodies where the substep begins; velocities, of bodies on joints among these;
  /// and these back.
  void poses_to_joints();
  void velocities_to_joints(std::span<const int> of);
  void velocities_to_joints() { velocities_to_joints(joints_.bodies()); }
  void velocities_from_joints(std::span<const int> of);
  void velocities_from_joints() { velocities_from_joints(joints_.bodies()); }
  void solve_joint_velocities();
  // Before impacts and after them: given(body) is what they have given to one on joints.
  void begin_struck_joints(const State<D>& state) {
    if (joints_.empty()) return;
    struck_joints_.gather(state), struck_joints_.forget_places();
  }
  template <class Given>
  void end_struck_joints(double h, Given&& given) {
    if (joints_.empty()) return;
    for (const int i : joints_.bodies()) {
      const Twist<D> its = given(i);
      joints_.body_motion(i).v = its.v, joints_.body_motion(i).w = its.w;
    }
    joints_.keep_struck_speeds(struck_joints_, h);
  }

  const Model<D>& model_;
  ForwardDynamics<D> dynamics_;
  JointSolver<D> joints_;
  JointSolver<D> struck_joints_;  // where impacts find them
  Drives<D> drives_;
  Sleep<D> sleep_;
  WarmStart<D> warm_start_;
  Stages stages_;
  bool varies_ = false;                        // what moves bodies depends on how they move
  std::vector<PersistentContact<D>> bearing_;  // of the last substep, if it does
  std::vector<char> forced_;                   // one a body: see begin_bearing()
  std::vector<Tightness> tightness_;           // of bodies, but for hands
  std::vector<Twist<D>> borne_;                // one a body, m/s^2 and rad/s^2; empty: there are none
  std::vector<char> carries_;                  // one a body: kinematic or with a belt; empty: there are none
  std::vector<double> quicker_;  // one a body, m/s: how much faster the step moves it; empty: none are moved
  double g_ = 0;
  double restitution_threshold_ = 0;  // m/s: slower approaches do not bounce
  AllowedOverlap allowed_overlap_;
  double fewest_substeps_ = kFewestSubsteps;  // 1/s
  std::int64_t every_ = 1;                    // steps between two pair searches
  int substeps_ = 1;                          // of this step
  double part_of_step_ = 1;                   // how much of a whole one it is,
  double least_substep_ = 0;             // s: and if not all, how long its substeps would be in a whole one
  ClosingRates closing_rates_;           // at the start of the step; 0: not known yet
  std::vector<double> bounding_radius_;  // of bodies, m
  std::vector<MovingBody<D>> moving_;    // one a body, and one more that never moves, for walls
  std::vector<MovingBody<D>> kept_;      // those of the step, while others are in moving_
  std::vector<Vec<D>> corrections_;      // how far this step has pushed each body out of others, m
  bool corrected_ = false;

 private:
  void project_joints(StepPart<D> part);
  void open_locked();
  bool locks(int touch, typename JointSolver<D>::JointResponse& response);
  void bear_locked(StepPart<D> part);
  void solve_jointed();
  bool solve_jointed(std::span<const std::tuple<int, int, int>> island);
  void fall_from_rest(std::span<const typename Sleep<D>::Island> islands, double h);
  void find_equilibrium(typename Sleep<D>::Island& island, State<D>& state, double h);
  void note_touches(StepPart<D> part);

  TouchNotes<D> notes_;
  std::vector<std::pair<int, int>> touching_;
  // contacts that joints leave nothing to move (sim/solve/iterate/locked_contacts.cpp)
  struct {
    std::vector<TouchEnds> ends;
    std::vector<int> numbers;
    std::vector<typename JointSolver<D>::JointResponse> responses;  // to their normals
    std::vector<double> forces;
  } locked_;
  std::vector<char> on_joints_;  // bodies: of those that rest
  std::vector<char> on_motors_;  // bodies: of joints with motors
  struct {
    std::vector<TouchEnds> ends;
    Islands sets;
    std::vector<int> counts;
    std::vector<std::tuple<int, int, int>> few;  // roots of islands, places of contacts and these
    std::vector<TouchRows> touches;
    std::vector<typename JointSolver<D>::JointResponse> responses;
    ExactIsland<D> island;
  } jointed_;  // scratch
};

}  // namespace obscura::sim
