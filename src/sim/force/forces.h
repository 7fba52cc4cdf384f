#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/force/flying_forces.h"
#include "sim/math/spatial.h"
#include "sim/model/body_motion.h"
#include "sim/model/drives.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// The forces of a model (sim/model/model.h) on bodies as they stand at an instant: formulas block by block,
/// pairs by two loops. Their order and their sums are the same on every machine. Once gathered it allocates
/// nothing.
template <int D>
class Forces {
 public:
  /// Kept by reference.
  explicit Forces(const Model<D>& model);

  bool any() const { return !model_.forces.empty(); }
  /// Whether any force may ever push body `body`.
  bool push(int body) const { return pushed_[std::size_t(body)] != 0; }

  /// Those on bodies on which nothing else acts.
  FlyingForces<D>& flying() { return flying_; }
  const FlyingForces<D>& flying() const { return flying_; }
  /// Whether any force has a potential.
  bool potentials() const { return potentials_; }

  /// Sets the numbering of bodies: `member` is the index of each body in the `motions` of apply(); negative:
  /// the body stands still where `state` has it.
  void gather(const State<D>& state, std::span<const int> member);
  /// The same, where every body moves and `motions` lists them in the order of the model.
  void gather(const State<D>& state);

  /// Bodies have the angles of this state, or turn by less than half a turn from there.
  void refer(const State<D>& state);

  /// Adds the force and torque on each member at time t, room's frame, torque about its centre.
  void apply(double t, const std::vector<BodyMotion<D>>& motions, std::vector<Wrench<D>>& wrenches);

  /// The same at one instant of those that are drag, or of all others.
  void apply_drag(double t, bool drag, const std::vector<BodyMotion<D>>& motions,
                  std::vector<Wrench<D>>& wrenches);

  /// The power (W) that kinematic bodies supplied against forces with a potential in the last apply().
  double driven_power() const { return driven_power_; }

  /// The sum of all potentials, J. Adds each body's part to `each` (one a member) if it is given: half of the
  /// potential between two bodies to each of them.
  double energy(double t, const std::vector<BodyMotion<D>>& motions, std::vector<double>* each = nullptr);

  /// The potential (J) that body `body` has with the pose `at`, of forces on single bodies. All other bodies
  /// are as in `state`.
  double energy_of(const State<D>& state, int body, const BodyMotion<D>& at, double t);

  /// The power of those without a potential, and of drag, W.
  double power(double t, const std::vector<BodyMotion<D>>& motions);

 private:
  // a force, and which of its subjects move
  struct Active {
    const Force<D>* force;
    std::vector<int> subjects, members;      // numbers in the force's list; below zero: still_[-1 - member]
    std::vector<std::vector<double>> fixed;  // numbers that stay, by slot
    int center = 0;                          // its member
    std::vector<Evaluation> evaluations;     // of the force; of the energy, if it has one
  };

  const BodyMotion<D>& motion(int member, const std::vector<BodyMotion<D>>& motions) const {
    return member < 0 ? still_[std::size_t(-1 - member)] : motions[std::size_t(member)];
  }
  void move_driven(double t) {
    for (const auto& [place, drive] : driven_) still_[std::size_t(place)] = drives_.at(drive, t).at;
  }
  int member_of(const State<D>& state, const Subject<D>& subject, std::span<const int> member);
  BodyMotion<D> point(const Subject<D>& subject, int member, const std::vector<BodyMotion<D>>& motions) const;
  double angle(const Subject<D>& subject, const BodyMotion<D>& at) const;
  template <class Found>
  void each_force(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                  Found&& found);
  template <class Found>
  void each_pair(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies,
                 Found&& found);
  template <class Found>
  void attract(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies, Found&& found);
  template <class Found>
  void call(Active& it, double t, const std::vector<BodyMotion<D>>& motions, Found&& found);
  template <class Found>
  void float_up(Active& it, const std::vector<BodyMotion<D>>& motions, bool energies, Found&& found);
  void apply(Active& it, double t, const std::vector<BodyMotion<D>>& motions,
             std::vector<Wrench<D>>& wrenches);
  template <class Found>
  void all(Active& it, double t, const std::vector<BodyMotion<D>>& motions, bool energies, Found&& found);
  const Model<D>& model_;
  std::vector<char> pushed_;
  FlyingForces<D> flying_;
  bool potentials_ = false;
  std::vector<Active> active_;
  std::vector<BodyMotion<D>> still_;
  Drives<D> drives_;
  std::vector<std::pair<int, int>> driven_;  // of still_ those that are moved: place there, number of drives_
  double driven_power_ = 0;
  std::vector<int> gathered_;  // member, as last gathered
  ForceStage<D> stage_;        // what functions are given, and what they answer
  std::vector<Vec<D>> answered_forces_;
  std::vector<AngularVec<D>> answered_torques_;
  std::vector<double> lanes_;  // rows of Program::kLanes
  std::vector<double> places_, pairs_;
  std::vector<double> angles_;  // of each body in the plane, where a force asks for it
  bool reads_angle_ = false;
};

/// How all bodies of a state stand.
template <int D>
void stand(const State<D>& state, std::vector<BodyMotion<D>>& motions);

}  // namespace obscura::sim
