#pragma once

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "sim/math/elementary.h"
#include "sim/math/expression.h"
#include "sim/model/model.h"

namespace obscura::sim {

/// What the motors of a model's joints aim at: a speed of the joint's free coordinate c, constant or a
/// function of time. One that follows a coordinate s(t) aims at
///   c' = s' + k (s - c)       k  kFollow, 1/s
/// so that it goes along exactly once it is there, and comes back where it was not strong enough. The angle of
/// a hinge in space counts no whole turns, so s - c is within half a turn there.
template <int D>
class Motors {
 public:
  static constexpr double kFollow = 30;  // 1/s

  struct Aim {
    double speed = 0;  // rad/s or m/s
    double rate = 0;   // of that, rad/s^2 or m/s^2
  };

  /// Kept by reference.
  explicit Motors(const Model<D>& model) : model_(model), evaluations_(model.joints.size()) {
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      const auto& motor = model.joints[i].motor;
      if (motor && motor->aim) evaluations_[i].emplace(*motor->aim);
    }
  }

  /// Whether a motor follows a coordinate, and at() asks for that of its joint.
  bool follows(int joint) const {
    const auto& motor = model_.joints[std::size_t(joint)].motor;
    return motor && motor->follows;
  }

  /// The coordinate h s after t of a joint that is at c at t and keeps its motor's aim:
  ///   s(t + h) + (c - s(t)) e^(-k h),  or c and the integral of the speed, by Simpson's rule
  double lead(int joint, double t, double h, double c) {
    if (!follows(joint)) {
      const auto speed = [&](double time) { return at(joint, time, 0, 0).speed; };
      return c + h * (speed(t) + 4 * speed(t + 0.5 * h) + speed(t + h)) / 6;
    }
    auto& evaluation = *evaluations_[std::size_t(joint)];
    const auto place = [&](double time) {
      const double at[] = {time};
      evaluation.begin(at);
      evaluation.run(1, {});
      return evaluation.output(6)[0];
    };
    const double off = -behind(joint, place(t) - c);
    return place(t + h) + off * elementary::exp(-kFollow * h);
  }

  /// The aim of a joint's motor at time t where its coordinate is c and changes by `speed`.
  Aim at(int joint, double t, double c, double speed) {
    const auto& motor = *model_.joints[std::size_t(joint)].motor;
    auto& evaluation = evaluations_[std::size_t(joint)];
    if (!evaluation) return {motor.speed, 0};
    const double time[] = {t};
    evaluation->begin(time);
    evaluation->run(1, {});
    // the angle of a drive_formula<2>, with its first two derivatives
    const auto output = [&](int k) { return evaluation->output(6 + k)[0]; };
    if (!motor.follows) return {output(0), output(1)};
    return {output(1) + kFollow * behind(joint, output(0) - c), output(2) + kFollow * (output(1) - speed)};
  }

 private:
  double behind(int joint, double way) const {
    if (D == 2 || model_.joints[std::size_t(joint)].kind != JointKind::hinge) return way;
    constexpr double kTurn = 2 * std::numbers::pi;
    return way - kTurn * std::floor(way / kTurn + 0.5);
  }

  const Model<D>& model_;
  std::vector<std::optional<Evaluation>> evaluations_;  // one a joint
};

}  // namespace obscura::sim
