#pragma once

#include <span>
#include <vector>

#include "sim/collide/broad_phase.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

/// Bodies that in this step can meet only walls and fixed bodies without a belt, and strike them faster than
/// resting bodies do, or roll or rock on them. The exact solver moves them, whichever solver moves all
/// others: each impact at its own time, however many there are.
template <int D>
class LoneBodies {
 public:
  /// Both are kept by reference.
  LoneBodies(const Model<D>& model, const std::vector<Path<D>>& paths);

  /// Finds them in a state before its step from t to t + h (s), and saves their poses and velocities.
  void find(const State<D>& state, double t, double h);

  /// After the step of the other solver: puts them back to the start of the step and moves them. Leaves out
  /// those that met others after all.
  void step(State<D>& state, double t, double h);

  /// Whether the last step() moved a body: its motion by the other solver is then discarded.
  bool moved(int body) const { return moved_[body] != 0; }

  /// Notes how they go through a step, from now on.
  void watch(Course<D>* course) { direct_.watch(course); }

 private:
  struct Began {
    int body;
    Vec<D> x, v;
    Orientation<D> turn;
    AngularVec<D> spin;
    BodySpin<D> body_spin;
  };

  bool strikes(const State<D>& state, int body, double h) const;
  void find_rolling(const State<D>& state);
  void leave_out_near(const State<D>& state);
  // whether a lone body must not meet this one
  bool meets(int body) const { return !model_.bodies[body].fixed || carries_[body]; }

  const Model<D>& model_;
  ExactSolver<D> direct_;
  Drives<D> drives_;
  double g_ = 0;                                // m/s^2
  std::vector<char> free_;                      // one a body: no joint, spring or pair force acts on it
  std::vector<char> still_;                     // one a body: it is not to be moved
  std::vector<char> moved_;                     // one a body
  std::vector<char> rolls_;                     // one a body: 1 on what stands still, 2 on others, too
  std::vector<char> points_;                    // one a body
  std::vector<char> carries_;                   // one a body: it is kinematic or has a belt
  std::vector<int> fixed_;                      // bodies
  std::vector<double> bounding_radius_, ways_;  // one a body: bounding radius, how far it gets in the step, m
  std::vector<int> candidates_;
  std::vector<Bounds<D>> bounds_;
  BroadPhase<D> broad_;
  std::vector<Began> began_;
};

}  // namespace obscura::sim
