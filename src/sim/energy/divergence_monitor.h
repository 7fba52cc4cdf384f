#pragma once

#include <optional>
#include <vector>

#include "sim/model/body_motion.h"
#include "sim/model/path.h"
#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// Finds the body that diverged and the likely cause, energy that nothing could have supplied, and joints
/// that do not hold. The step itself detects overflow and NaN at no cost (sim/math/limits.h); this class
/// names them.
template <int D>
class DivergenceMonitor {
 public:
  /// Both are kept by reference.
  DivergenceMonitor(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// The first body with a velocity or position beyond its limit, in a state at time t (s).
  std::optional<Trouble> check_bounds(const State<D>& state, double t) const;

  /// Takes `state` at time t as the start: the energy budget is counted from it.
  void start(State<D>& state, double t) const;

  /// Whether the springs hold far more energy than could have come from anywhere. Only springs can make it
  /// so.
  std::optional<Trouble> check_energy(const State<D>& state, double t) const;

  /// The angles of hinges with springs in space, which count no whole turns, rad, from -pi to pi; 0 of those
  /// that broke. None in the plane.
  void spring_angles(const State<D>& state, std::vector<double>& angles) const;
  /// The first of them whose angle has come beyond half a turn, and so to the other end of its range, since
  /// it was as in `before`, less than a step ago.
  std::optional<Trouble> check_turns(const std::vector<double>& before, const State<D>& state,
                                     double t) const;
  /// The first unbroken joint whose equations are off by more than a hundredth of its size, or of a radian.
  std::optional<Trouble> check_joints(const State<D>& state, double t) const;
  /// The first body that is pressed by a tenth of its width into what does not give way on two sides, of
  /// which one is moved. By the contacts of the state.
  std::optional<Trouble> check_squeezed(const State<D>& state, double t) const;

 private:
  std::string likely(const State<D>& state, int body) const;

  const Model<D>& model_;
  const std::vector<Path<D>>& paths_;
  bool drives_ = false;                    // bodies are moved
  std::vector<int> coils_;                 // joints: hinges with springs in space
  std::vector<Trouble> too_long_;          // what the step is too long for, from the start
  mutable std::vector<BodyMotion<D>> at_;  // of check_joints()
};

}  // namespace obscura::sim
