#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/energy/divergence_monitor.h"
#include "sim/energy/work.h"
#include "sim/force/explosion.h"
#include "sim/handout/handout.h"
#include "sim/model/script.h"
#include "sim/motion/forced_flight.h"
#include "sim/motion/forward_dynamics.h"
#include "sim/motion/integrator.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/jumps.h"

namespace obscura::sim {

template <int D>
class BondedBodies;
template <int D>
class ContactStep;
template <int D>
struct Course;
template <int D>
class Events;
template <int D>
class Releases;

/// Steps states of one model. All that a step depends on is in the model and the state; members are scratch
/// and follow from these. A step after the first allocates nothing. Keeps the model by reference.
template <int D>
class Stepper {
 public:
  explicit Stepper(const Model<D>& model);
  ~Stepper();

  /// Prepares a state that has not been stepped: does what the script does at its very instant.
  void begin(State<D>& state);

  /// Prepares a state that was changed from outside at time t (s), a whole step.
  void begin_anew(State<D>& state, double t);

  /// Whether a state that was saved can be one of this model's.
  bool fits(const State<D>& state);

  /// One whole step, cut at the edges of the script. Trouble leaves the state as it was when it was noticed.
  std::optional<Trouble> step(State<D>& state);

  /// A fraction of a step, 0 < fraction < 1, for a frame between two steps: of a copy, which is shown and
  /// then thrown away.
  std::optional<Trouble> partial_step(State<D>& state, double fraction);

  /// Whether a state holds far more energy than could have come from anywhere.
  std::optional<Trouble> diverges(const State<D>& state) const;

  /// The model as it is for this state: bodies that have been let go are free in it.
  const Model<D>& model(const State<D>& state) const;

  const std::vector<Path<D>>& paths() const { return paths_; }

  /// Whether mouse `mouse` is pressed at `at`.
  bool pressed(int mouse, TimeStamp at) const;

  /// From now on, notes how bodies go through a step; null: no more.
  void watch(Course<D>* course);

 private:
  friend class Events<D>;
  friend class Releases<D>;

  // bodies that nothing ties, side by side
  struct Block {
    int first, count;
  };

  std::optional<Trouble> go(State<D>& state, double from, double to);
  double next_cut(std::int64_t step, double from, double to);
  std::optional<Trouble> after_step(const State<D>& state);
  std::optional<Trouble> advance(State<D>& state, double from, double fraction);
  std::optional<Trouble> advance_pieces(State<D>& state, double from, double fraction);
  std::optional<Trouble> check_energy(const State<D>& state);
  void note_ropes(const State<D>& state);
  std::optional<Trouble> follow_pulleys(State<D>& state, double t, double done) const;
  bool may_gain(const State<D>& state) const;
  void touch_script(State<D>& state, TimeStamp at);
  void plan(const State<D>& state);
  bool integrate(State<D>& state, double t, double h);
  bool sound(const State<D>& state) const;
  std::int64_t turn_within_limits(const State<D>& state, std::size_t k) const;
  bool step_flying(State<D>& state, Block block, double t, double h);
  bool step_spins(State<D>& state, Block block, double t, double h);
  void step_spins(State<D>& state, int k, int pieces, double t, double h);
  bool step_tied(State<D>& state, double t, double h);

  const Model<D>& model_;
  std::vector<Path<D>> paths_;
  std::vector<ScriptEvent> edges_;
  std::vector<TimeStamp> press_times_, release_times_;  // one a mouse
  Integrate* integrate_;
  Handout<D> handout_;
  Blasts<D> blasts_;
  std::unique_ptr<ContactStep<D>> contact_;  // of `contact` and `event`
  std::unique_ptr<BondedBodies<D>> bonded_;  // of a model with bonds: all is done there
  std::unique_ptr<Releases<D>> releases_;    // of one that lets bodies go: likewise
  std::unique_ptr<Events<D>> events_;        // of one with conditions: likewise
  Jumps<D> jumps_;
  Drives<D> drives_;
  DivergenceMonitor<D> divergence_;
  ForwardDynamics<D> dynamics_;
  WorkBooks<D> work_;
  Forces<D> forces_;  // on bodies that fly
  ForcedFlight<D> forced_flight_;
  std::vector<int> gripped_;  // by each mouse, as the plan knows
  bool planned_ = false, blasting_ = false, books_by_stage_ = false;

  std::vector<Block> flying_, spinning_;  // centres, and turns
  std::vector<double> gravity_;           // a block of it
  std::vector<double> drag_;              // c/m of every component; empty where there is none
  std::vector<double> spin_limits_;       // of every body that turns, rad/s
  std::vector<AngularVec<D>> inertia_;    // likewise, principal moments, kg m^2
  std::vector<AngularVec<D>> base_;       // of a block, see sim/math/lie_step.h
  std::vector<double> d_, w_;
  std::vector<int> suspects_;
  std::vector<double> spring_angles_;
  std::vector<int> by_handout_;  // bodies with that law in `contact` and `event` too
  Stages stages_;
  std::int64_t watch_every_ = 1;             // steps
  bool springs_ = false;                     // something may ever feed it
  bool wound_ropes_ = false;                 // ropes run on wheels
  bool pulleys_ = false;                     // ropes run over anything
  std::vector<BodyMotion<D>> before_piece_;  // of a step: bodies on ropes on wheels
};

}  // namespace obscura::sim
