#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim/model/contact.h"
#include "sim/model/model.h"

namespace obscura::sim {

/// What a pressed mouse holds.
template <int D>
struct Grip {
  int body = -1;  // -1: nothing
  Vec<D> local = Vec<D>::Zero();

  bool operator==(const Grip&) const = default;
};

/// A touch in the last step: where, and the impulse (N s) that the wall gave.
template <int D>
struct Touch {
  int body = -1;
  int wall = -1;
  Vec<D> point = Vec<D>::Zero();  // world frame, after displacement
  Vec<D> impulse = Vec<D>::Zero();

  bool operator==(const Touch&) const = default;
};

/// The spin of a body in space as the body sees it, and what rounding has taken from it since: near its
/// middle axis a top doubles every error in a fraction of a second, that of rounding too. It counts while
/// `spin` of the state is what it gives in the room's frame, to the bit; code that changes that or the turn
/// need not know of it.
template <int D>
struct BodySpin {
  AngularVec<D> w = AngularVec<D>::Zero();         // rad/s
  AngularVec<D> residual = AngularVec<D>::Zero();  // rad/s; to be added

  bool operator==(const BodySpin&) const = default;
};

/// What the displacement and the impulses of `handout` did to the energy since t = 0, J.
struct Ledger {
  double displacement = 0;  // gained (+) or lost by putting bodies back on the wall
  double impacts = 0;       // lost (-) in impacts

  bool operator==(const Ledger&) const = default;
};

/// What energy there may be: what there was at the start and what hands can give. The watch over runs that
/// go wrong measures by it (sim/energy/divergence_monitor.cpp).
struct EnergyBudget {
  double level = 0;   // gravity's potential at the start, J
  double amount = 0;  // energy that could be there, J

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

/// How a part sits in the body that bonds make it part of: in that body's frame.
template <int D>
struct Seat {
  Vec<D> x = Vec<D>::Zero();  // m
  Orientation<D> turn = no_rotation<D>();

  bool operator==(const Seat&) const = default;
};

/// How an articulated body stands and moves, in the numbers of its tree (sim/multibody/chain.h); the places
/// of its bodies follow from them.
struct ChainState {
  std::vector<double> q, v;

  bool operator==(const ChainState&) const = default;
};

/// All that changes while the room runs, as a plain value: it copies, compares, and hashes. Time is
/// step / rate, plus `beyond` in the copy that a frame between two steps shows.
template <int D>
struct State {
  std::int64_t step = 0;
  double beyond = 0;                 // s; 0 on the trajectory
  std::vector<Vec<D>> x;             // centres of mass, m, one a body
  std::vector<Vec<D>> v;             // m/s
  std::vector<Orientation<D>> turn;  // one a body that turns, in their order
  std::vector<AngularVec<D>> spin;   // rad/s (in space: world frame)
  std::vector<Grip<D>> grips;        // one a mouse
  std::vector<Touch<D>> touches;     // of `handout`
  Ledger ledger;
  EnergyBudget energy_budget;
  std::vector<BodySpin<D>> own;      // in space: one a body that turns
  std::vector<Blast<D>> blasts;      // one an explosion
  std::vector<ChainState> postures;  // one a chain of the model
  std::vector<double> work;  // of a model with forces one number: what those without a potential did, J

  // of what is bonded, see sim/step/bonded_bodies.h: everything above is then told of the parts, and this is
  // what moves
  std::vector<char> holds;        // one a bond
  std::vector<Seat<D>> seats;     // one a body
  std::vector<State> whole = {};  // one: of the bodies that the bonds make

  // of `contact` and `event`
  std::vector<Contact<D>> contacts;  // sorted by key
  std::vector<char> frozen;          // one a body: at rest by proof, steps leave it alone
  std::vector<double> quiet;         // one a body: how long it has been still, s
  std::vector<char> broken;          // one a joint
  std::vector<Vec<D>> joint_forces;  // one a joint: on its a, N

  bool operator==(const State&) const = default;
};

/// The state as 64-bit words in a fixed order, -0 as 0: what a state hash is taken of.
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
