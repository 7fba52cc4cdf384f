#pragma once

#include <vector>

#include "sim/force/forces.h"

namespace obscura::sim {

/// The work (J) of forces without a potential, and of drag, added to State::work. The path and the
/// turn through a step are cubics between its ends; the power along it is integrated by Gauss's rule of two points, so the error
/// is of fourth order in the step.
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
  double dragged(const State<D>& state, double h) const;

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
