#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim/model/contact.h"
#include "sim/model/model.h"

namespace obscura::sim {

/// The grip of a pressed mouse.
template <int D>
struct Grip {
  int body = -1;  // -1: nothing
  Vec<D> local = Vec<D>::Zero();

  bool operator==(const Grip&) const = default;
};

/// A touch in the last step: its place, and the wall's impulse (N s).
template <int D>
struct Touch {
  int body = -1;
  int wall = -1;
  Vec<D> point = Vec<D>::Zero();  // world frame, after displacement
  Vec<D> impulse = Vec<D>::Zero();

  bool operator==(const Touch&) const = default;
};

/// The angular velocity of a body in space in its own frame, and the rounding error of its sum so far: near
/// its middle axis a top doubles every error in a fraction of a second, that of rounding too. A cache: it
/// counts only while `w`, turned into the room's frame, is State::spin to the bit. Code that changes `spin`
/// or `turn` need not update it.
template <int D>
struct BodySpin {
  AngularVec<D> w = AngularVec<D>::Zero();         // rad/s
  AngularVec<D> residual = AngularVec<D>::Zero();  // rad/s; to be added

  bool operator==(const BodySpin&) const = default;
};

/// The energy that was added since t = 0 other than by forces, J.
struct Ledger {
  double displacement = 0;  // gained (+) or lost by putting bodies back on a wall, or out of each other
  double impacts = 0;       // lost (-) in impacts

  bool operator==(const Ledger&) const = default;
};

/// Steps since t = 0 in which a limit of a solver's work was met, so that they are less exact.
struct LimitMet {
  std::int64_t steps = 0, first = 0, last = -1;  // how many; which of them

  void note(std::int64_t step) {
    if (step == last) return;
    if (steps++ == 0) first = step;
    last = step;
  }
  bool operator==(const LimitMet&) const = default;
};

/// The step in which a force changed most within it, by Runge-Kutta: its error of a velocity, and the largest
/// speed of all that the run has seen, m/s.
struct WildestStep {
  std::int64_t step = -1;
  double error = 0, pace = 0;

  bool operator==(const WildestStep&) const = default;
};

/// All limits that a solver may meet.
struct LimitsMet {
  LimitMet work;      // the exact solver went on by impulses, to the first order in the step
  LimitMet substeps;  // bodies met faster than the most substeps of the iterative one share out
  LimitMet rough;     // the step was long for forces, by Runge-Kutta: see sim/motion/integrator.h
  LimitMet passages;  // bodies passed each other more closely than the pieces of a step follow
  WildestStep wildest;

  bool operator==(const LimitsMet&) const = default;
};

/// The energy that a run may have: that at the start and that which hands can give. The divergence monitor
/// compares with it (sim/energy/divergence_monitor.cpp).
struct EnergyBudget {
  double level = 0;   // gravity's potential at the start, J
  double amount = 0;  // energy that could be there, J
  double work = 0;    // what the books had then, J

  bool operator==(const EnergyBudget&) const = default;
};

/// An explosion of the model at an instant.
template <int D>
struct Blast {
  char on = 0;
  std::vector<Vec<D>> forces;          // held through the interval at hand, one a body, N; of Scheme::paper
  std::vector<AngularVec<D>> torques;  // likewise, N m

  bool operator==(const Blast&) const = default;
};

/// The pose of a part in the frame of the bonded body that it belongs to.
template <int D>
struct PartPose {
  Vec<D> x = Vec<D>::Zero();  // m
  Orientation<D> turn = no_rotation<D>();

  bool operator==(const PartPose&) const = default;
};

/// Positions and velocities of a chain's joints, in the order of its tree (sim/multibody/chain.h); the poses
/// of its bodies follow from them.
struct ChainState {
  std::vector<double> q, v;

  bool operator==(const ChainState&) const = default;
};

/// One firing of a condition of the model: of which of its things, and when.
struct Happening {
  int when = 0, which = 0;
  std::int64_t step = 0;
  double fraction = 0;  // of a step, below 1

  bool operator==(const Happening&) const = default;
};

/// What the conditions of a model have seen and done so far.
struct EventLog {
  std::vector<char> on;    // of each condition, for each of its things: whether it is true; of `crosses` on
                           // which side it is
  std::vector<char> done;  // one a condition: whether it has fired
  std::vector<Happening> happenings;
  std::vector<int> changes;  // of the model that are in force, in the order in which they were made
  char stopped = 0;          // nothing moves any more

  bool operator==(const EventLog&) const = default;
};

/// How far the rope of a pulley has turned at the wheels at its ends since the start, rad, all rounds
/// counted. Of one with friction: its first and last pieces; and what friction takes of its tension.
struct Wound {
  double a = 0, b = 0;
  double drag = 0;  // N: the tension at a less that at b
  // Of one with friction: so many of the wheels that it slides over, from a and from b on, it has left.
  int off_a = 0, off_b = 0;
  // Of one on wheels: the joint is one with so many pieces of its rope after it, which has left the wheels
  // between them. Below zero: it is one with that so many before it, and holds nothing.
  int with = 0;
  double given = 0;  // m: what it has got of its rope, from the others, while that was off a wheel

  bool operator==(const Wound&) const = default;
};

/// A wheel that a rope has left, and how far it would be wrapped around it, all rounds counted.
struct WheelLeft {
  int joint = 0;    // the piece that slides over it, or that ends there
  int wheel = 0;    // which of Joint::around
  double wrap = 0;  // rad, below zero but for what it still was as it left

  bool operator==(const WheelLeft&) const = default;
};

/// Of a joint in State::broken.
inline constexpr char kGoneApart = 2;

/// How the ends of a joint stood when an event made it, which is how it holds them.
template <int D>
struct Made {
  Vec<D> place = Vec<D>::Zero();               // of its end on b, as End::local; zero if its ends are apart
  AngularVec<D> turn = AngularVec<D>::Zero();  // as Joint::turn
  double length = 0;                           // as Joint::length

  bool operator==(const Made&) const = default;
};

/// All that changes while the room runs, as a plain value: it copies, compares, and hashes. Time is
/// step / rate, plus `beyond` in the copy that a frame between two steps shows.
template <int D>
struct State {
  // each compiled once, in state.cpp: a state is copied in many places
  State();
  State(const State&);
  State(State&&) noexcept;
  State& operator=(const State&);
  State& operator=(State&&) noexcept;
  ~State();

  std::int64_t step = 0;
  double beyond = 0;                 // s; 0 on the trajectory
  std::vector<Vec<D>> x;             // centres of mass, m, one a body
  std::vector<Vec<D>> v;             // m/s
  std::vector<Orientation<D>> turn;  // one a body that turns, in their order
  std::vector<AngularVec<D>> spin;   // rad/s (in space: world frame)
  std::vector<Grip<D>> grips;        // one a mouse
  std::vector<Touch<D>> touches;     // of `handout`
  Ledger ledger;
  LimitsMet limits_met;  // the hash does without
  EnergyBudget energy_budget;
  std::vector<BodySpin<D>> body_spin;    // in space: one a body that turns
  std::vector<Blast<D>> blasts;          // one an explosion
  std::vector<ChainState> chain_states;  // one a chain of the model
  std::vector<double> work;    // of a model that books it one number: what forces without a potential, drag,
                               // motors and bodies that are moved did, J
  std::vector<char> released;  // one a drive: whether its body has been let go
  EventLog events;             // of a model with conditions
  std::vector<int> on_piece;   // of a model with wires one a joint: the piece of the wire that its a is on
  std::vector<Wound> wound;    // of a model with ropes on wheels, or with friction, one a joint
  std::vector<WheelLeft> wheels_left;  // by ropes, in the order in which they left (follow_ropes())
  std::vector<Made<D>> made;           // of a model whose events make joints one a joint

  // bonded bodies (sim/step/bonded_bodies.h): then all above describes the parts, and `bonded` is stepped
  std::vector<char> intact;             // one a bond: whether it is whole
  std::vector<PartPose<D>> part_poses;  // one a body
  std::vector<State> bonded = {};       // one: that of the bonded bodies

  // for `contact` and `event`
  std::vector<Contact<D>> contacts;  // sorted by key
  std::vector<char> frozen;          // one a body: asleep, at rest by proof; steps leave it alone
  std::vector<double> quiet;         // one a body: sleep timer, how long it has been still, s
  std::vector<char> broken;  // one a joint: 1 where it has broken or was let go, kGoneApart where its two
                             // bodies have been apart since, and touch as others do
  std::vector<Vec<D>> joint_forces;  // one a joint: on its a, N
  // and the torque on it about its place, N m; the hash does without, as all is said by the rest
  std::vector<AngularVec<D>> joint_torques;

  bool operator==(const State&) const;
};

/// The state as 64-bit words in a fixed order, -0 as 0. State hashes are computed from them.
template <int D>
std::vector<std::uint64_t> words(const State<D>& state);

/// Whether every place, velocity, turn and spin is a finite number.
template <int D>
bool finite(const State<D>& state) {
  const auto all = [](const auto& of) {
    return std::all_of(of.begin(), of.end(), [](const auto& one) { return one.array().isFinite().all(); });
  };
  return all(state.x) && all(state.v) && all(state.turn) && all(state.spin);
}

template <int D>
struct World {
  Model<D> model;
  State<D> state;
};

}  // namespace obscura::sim
