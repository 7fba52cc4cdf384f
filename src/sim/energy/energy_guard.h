#pragma once

#include <vector>

#include "sim/force/forces.h"
#include "sim/math/islands.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// Compares the energy after a step with that before it, and removes what contacts added: contact only takes
/// energy. A step that finds forces at one configuration and moves through it to another errs by its own
/// order, up or down; energy added by this error is removed from the motion of the bodies that touched.
template <int D>
class EnergyGuard {
 public:
  /// Kept by reference.
  explicit EnergyGuard(const Model<D>& model);

  /// Records the energy before a step from t: kinetic, of height, of springs and of fields.
  void open(const State<D>& state, double t = 0);
  /// Records work (J) that was done on a body on purpose since then: it may stay.
  void book(int body, double work) { booked_[body] += work; }
  /// The same of ways (m, one a body) by which `state` has been put right since then: against gravity, fields
  /// and springs. Returns its sum, J.
  double book_ways(State<D>& state, const std::vector<Vec<D>>& ways);
  /// Whether the total energy has risen by more than rounding, bodies driven by hands, motors and explosions
  /// included.
  bool risen(const State<D>& state);
  /// By how much body i has more since open(), as risen() found it, J.
  double gain(int body) const { return now_[body] - before_[body] - booked_[body]; }

  /// If it has risen: records that a and b (a body; a wall if negative) touched in the step.
  void touch(int a, int b);
  /// The same of a body that something has pushed which its joints tell.
  void touch(int body) {
    if (weights_[body].mass > 0) touched_[body] = 1;
  }
  /// If it has risen: allows the island of `body` to gain share * m g * (height of the room).
  void excuse(int body, double share) { granted_[body] = share; }
  /// Removes from each island of touching bodies the energy that it gained: where it touches something fixed,
  /// by scaling what the step has changed of its velocities, so that what no contact brakes goes on; where
  /// that is not enough, and where joints hold it, by scaling its velocities, what it slides as one along the
  /// ground last; where it touches nothing fixed, its velocities relative to each other, so that momentum and
  /// angular momentum stay. If the motion has too little energy and `lower` is true, bodies that rose are
  /// lowered; in a crowd they would be lowered into each other. Islands on which hands, motors or explosions
  /// do work are left alone. `state` is that of risen(). Returns the energy (J) that remains: that of risen
  /// height.
  double take_back(State<D>& state, bool lower);

 private:
  // a body's mass and inertia; zero if it does not count
  struct Weight {
    double mass = 0;                                // kg
    AngularVec<D> inertia = AngularVec<D>::Zero();  // kg m^2
  };
  // bodies that touch each other, directly or through others
  struct Island {
    double gain = 0, granted = 0, kinetic = 0, mass = 0,
           height = 0;                                          // J, J, J, kg; J of new height of what rose
    Vec<D> momentum = Vec<D>::Zero(), middle = Vec<D>::Zero();  // kg m/s; kg m
    int bodies = 0;
    bool touched = false, rooted = false, chained = false, driven = false;
    bool tied = false, jointed = false;  // by springs; by joints
    bool held = false;                   // by any joint
    // of the changes of velocity: their energy, and its rate along them, J
    double changes = 0, rate = 0;
    double more = 0;                // of the changes: so much of them is added
    Vec<D> along = Vec<D>::Zero();  // m/s: what it slides as one, which goes on
    // as it moves as one: about its middle
    AngularVec<D> turning = AngularVec<D>::Zero();  // angular momentum, then spin
    Eigen::Matrix<double, kAngular<D>, kAngular<D>> inertia =
        Eigen::Matrix<double, kAngular<D>, kAngular<D>>::Zero();
    double keeps = 1, lowers = 0;  // of its velocities; of the height
  };
  // bodies that joints tie together
  struct Bound {
    double lift = 0, mass = 0;  // J of new height, kg
    bool held = false;          // by the room too, or links of a chain: cannot be lowered
  };

  double kinetic(const State<D>& state, int body) const;
  double in_spring(const State<D>& state, int i) const;
  void add_fields(const State<D>& state, std::vector<double>& to);
  void gather(const State<D>& state);
  void move_as_one(const State<D>& state);
  void share_changes(const State<D>& state);

  const Model<D>& model_;
  const double g_;  // m/s^2
  Forces<D> forces_;
  std::vector<int> all_;      // the numbers of all bodies
  std::vector<char> driven_;  // one a body: a force works on it whose energy is not known here
  std::vector<BodyMotion<D>> motions_;
  double t_ = 0;
  std::vector<Weight> weights_;
  double size_ = 0;            // J: m g times the room's height
  std::vector<Vec<D>> x_, v_;  // at open()
  std::vector<Vec<D>> placed_;
  std::vector<AngularVec<D>> spin_;
  std::vector<char> broken_;                          // joints, at open()
  std::vector<double> before_, now_, booked_;         // one a body, J
  std::vector<int> sprung_;                           // joints with a spring
  std::vector<double> springs_before_, springs_now_;  // J: of springs, then of those
  Islands islands_, groups_;
  std::vector<char> touched_, rooted_, tied_, jointed_, held_;
  std::vector<char> shares_;     // one a body: a force between bodies acts on it
  std::vector<char> carried_;    // one a body: something that is moved, or a belt, works on it
  std::vector<int> attracts_;    // one a body that counts as still: one of those with which it shares a force
  std::vector<double> granted_;  // one a body
  std::vector<Island> sums_;     // at the lowest of their bodies
  std::vector<Bound> bound_;     // likewise
};

}  // namespace obscura::sim
