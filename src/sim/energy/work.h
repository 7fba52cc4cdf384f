#pragma once

#include <vector>

#include "sim/force/forces.h"

namespace obscura::sim {

/// What forces without a potential, and drag, do to the bodies of a model with forces: booked in the state,
/// J. Of fourth order in the step, as the path through the step is known: by the cubic between its ends.
template <int D>
class WorkBooks {
 public:
  /// Kept by reference.
  explicit WorkBooks(const Model<D>& model);

  /// Notes how bodies stand and move before they are moved.
  void open(const State<D>& state);
  /// Adds the work from there, t, to `state` at t + h.
  void close(State<D>& state, double t, double h);

 private:
  const Model<D>& model_;
  Forces<D> forces_;
  bool any_ = false, drag_ = false, gathered_ = false;
  std::vector<Vec<D>> x_, v_;
  std::vector<Orientation<D>> turn_;
  std::vector<AngularVec<D>> spin_;
  std::vector<BodyMotion<D>> motions_;
  std::vector<double> flat_;  // places, no displacement, velocities and accelerations, side by side
};

}  // namespace obscura::sim
