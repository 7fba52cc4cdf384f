#pragma once

#include <vector>

#include "sim/force/forces.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// What everything has of energy before a step and after it, and what is done where a step has made some:
/// contact may only take. A step that finds forces at one configuration and moves through it to another is
/// wrong by its own order either way; what it would so add is taken out of the motion of those that touched.
template <int D>
class EnergyGuard {
 public:
  /// Kept by reference.
  explicit EnergyGuard(const Model<D>& model);

  /// Notes what there is, of motion, height, springs and fields, before a step from t.
  void open(const State<D>& state, double t = 0);
  /// Whether there is more now, beyond rounding: of all together. What hands, motors and blasts work on
  /// counts too.
  bool risen(const State<D>& state);
  /// By how much body i has more since open(), as risen() found it, J.
  double gain(int body) const { return now_[body] - before_[body]; }

  /// Where it has risen: a and b (a body; below zero a wall) have touched in the step.
  void touch(int a, int b);
  /// Where it has risen: what this body's island has gained is granted up to `share` of what the body could
  /// fall through the room for, and up to `part` of the energy of its motion before the step.
  void excuse(int body, double share, double part = 0) { granted_[body] = share, parts_[body] = part; }
  /// Takes from each island of what touched what it has gained: of its motion, in proportion; of what touches
  /// nothing that stays, of its motion against each other, so that momentum and angular momentum stay. Where
  /// there is not so much it lies as much lower. Islands that hands, motors or blasts work on keep what they
  /// have. `state` is that of risen().
  void take_back(State<D>& state);

 private:
  // what a body weighs; nothing of what does not count
  struct Weight {
    double mass = 0;                                // kg
    AngularVec<D> inertia = AngularVec<D>::Zero();  // kg m^2
  };
  // what touches together
  struct Island {
    double gain = 0, granted = 0, kinetic = 0, mass = 0,
           height = 0;                                          // J, J, J, kg; J of new height of what rose
    Vec<D> momentum = Vec<D>::Zero(), middle = Vec<D>::Zero();  // kg m/s; kg m
    bool touched = false, rooted = false, chained = false, driven = false;
    bool tied = false, jointed = false;  // by springs; by joints
    // as it moves as one: about its middle
    AngularVec<D> turning = AngularVec<D>::Zero();  // angular momentum, then spin
    Eigen::Matrix<double, kAngular<D>, kAngular<D>> inertia =
        Eigen::Matrix<double, kAngular<D>, kAngular<D>>::Zero();
    double keeps = 1, lowers = 0;  // of its velocities; of the height
  };
  // what joints make move together
  struct Bound {
    double lift = 0, mass = 0;  // J of new height, kg
    bool held = false;          // by the room too, or links of a chain: cannot be lowered
  };

  double kinetic(const State<D>& state, int body) const;
  void add_fields(const State<D>& state, std::vector<double>& to);
  void gather(const State<D>& state);
  void move_as_one(const State<D>& state);

  const Model<D>& model_;
  const double g_;  // m/s^2
  Forces<D> forces_;
  std::vector<char> driven_;  // one a body: a force works on it whose energy is not known here
  std::vector<BodyMotion<D>> motions_;
  double t_ = 0;
  std::vector<Weight> weights_;
  double size_ = 0;  // J: m g times the room's height
  std::vector<Vec<D>> x_;
  std::vector<double> moved_, before_, now_;          // one a body, J
  std::vector<double> springs_before_, springs_now_;  // J
  Islands islands_, groups_;
  std::vector<char> touched_, rooted_, tied_, jointed_;
  std::vector<double> granted_, parts_;  // one a body
  std::vector<Island> sums_;             // at the lowest of their bodies
  std::vector<Bound> bound_;             // likewise
};

}  // namespace obscura::sim
