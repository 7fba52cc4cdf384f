#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "sim/energy/energy_guard.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/exact/lone_bodies.h"

namespace obscura::sim {

/// One step of bodies in contact, with any solver: the solver's stages, then lone bodies by the exact solver
/// (sim/solve/exact/lone_bodies.h), then the energy guard, which takes away energy that contacts have added.
template <int D>
class ContactStep {
 public:
  /// Both are kept by reference.
  ContactStep(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Moves `state` from t to t + h (s): bodies, contacts, joints, and which bodies sleep.
  void step(State<D>& state, double t, double h);

  /// Velocities at the start that joints allow: the nearest ones, by the bodies' masses.
  void begin(State<D>& state) const;

  /// The next step knows nothing of the one before: bodies have been let go.
  void begin_anew() { solver_->begin_anew(); }

  /// Notes how bodies go through a step, from now on.
  void watch(Course<D>* course) {
    course_ = course;
    solver_->watch(course);
    if (lone_bodies_) lone_bodies_->watch(course);
  }

 private:
  void let_touch(const State<D>& state);
  void build(const Model<D>& model);
  void find_apart(State<D>& state);
  void take_energy_back(State<D>& state);

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  Course<D>* course_ = nullptr;
  std::vector<char> apart_;          // by joint: it no longer holds its bodies (kGoneApart)
  std::unique_ptr<Model<D>> freed_;  // the model without what these forbid; null: there are none
  bool exact_;
  std::unique_ptr<ContactSolver<D>> solver_;
  EnergyGuard<D> energy_guard_;
  std::vector<Vec<D>> pushed_;                  // m: how far each body has been put right
  std::unique_ptr<LoneBodies<D>> lone_bodies_;  // beside a solver for many
  std::vector<std::pair<int, int>> touched_;
  std::vector<char> jointed_;  // one a body
};

}  // namespace obscura::sim
