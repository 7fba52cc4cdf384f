#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sim/math/body_motion.h"
#include "sim/model/model.h"
#include "sim/model/path.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// Pose, velocity and acceleration of a kinematic body at an instant.
template <int D>
struct DrivenMotion {
  BodyMotion<D> at;
  Vec<D> a = Vec<D>::Zero();                    // of its centre, m/s^2
  AngularVec<D> alpha = AngularVec<D>::Zero();  // rad/s^2, room's frame
  Orientation<D> turn = Orientation<D>::Zero();
};

/// The kinematic bodies of a model. Their motions are functions of time alone, with exact velocities and
/// accelerations. A fixed body that is only released later has no motion, and is not among them.
template <int D>
class Drives {
 public:
  /// Kept by reference.
  explicit Drives(const Model<D>& model);

  bool any() const { return !active_.empty(); }
  int size() const { return int(active_.size()); }
  int body(int i) const { return active_[std::size_t(i)].drive->body; }
  /// The number of a body here; negative: it is not kinematic.
  int number(int body) const { return body < 0 || number_.empty() ? -1 : number_[std::size_t(body)]; }

  /// The i-th at time t, s. Throws NotFinite.
  DrivenMotion<D> at(int i, double t);

  /// The largest distance (m) of the i-th body's centre, between t and t + h, from its place at t. A maximum
  /// of samples: the true one may be a little larger.
  double travel(int i, double t, double h);

  /// The largest speed of the i-th body's centre (m/s) and its largest spin (rad/s) between t and t + h:
  /// maxima of samples as above, with those of both ends.
  struct Pace {
    double speed = 0, spin = 0;

    /// How much faster than `now` a point within `reach` m of the centre may become, m/s.
    double beyond(const BodyMotion<D>& now, double reach) const {
      return std::max(0.0, speed - std::sqrt(now.v.squaredNorm())) +
             reach * std::max(0.0, spin - std::sqrt(now.w.squaredNorm()));
    }
  };
  Pace fastest(int i, double t, double h);

  /// Places and velocities of all at time t into a state.
  void put(State<D>& state, double t);

 private:
  struct Active {
    const Drive<D>* drive;
    std::vector<Evaluation> evaluation;  // one, of its formula
    std::vector<Path<D>> path;           // one, if it has one
  };

  const Model<D>& model_;
  std::vector<Active> active_;
  std::vector<int> number_;  // one a body
};

/// A motion as it is written: the ways along each axis of the room, and the angle. Left out: none.
struct MotionText {
  std::vector<std::string> ways;  // m, one an axis; empty: it does not move
  std::string angle;              // in the unit whose radians are `angle_unit`
  double angle_unit = 1;
};

/// A fault in one of the texts: the axis, or -1 of the angle.
struct MotionFault {
  int component = -1;
  ExpressionFault fault;
};

/// The formula of a motion: each way, its velocity and acceleration, D of them, then those of the angle. Its
/// variable is t; `constants` may be used in it.
template <int D>
std::variant<Program, MotionFault> drive_formula(
    const MotionText& text, const std::vector<std::pair<std::string, double>>& constants);

}  // namespace obscura::sim
