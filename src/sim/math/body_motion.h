#pragma once

#include "sim/math/orientation.h"

namespace obscura::sim {

/// Pose and velocity of a body, at its centre of mass: x, v (m, m/s), orientation, angular velocity w
/// (rad/s). A body that does not turn has w = 0.
template <int D>
struct BodyMotion {
  Vec<D> x = Vec<D>::Zero(), v = Vec<D>::Zero();
  Rotation<D> room_from_body = Rotation<D>::Identity();
  AngularVec<D> w = AngularVec<D>::Zero();

  Vec<D> arm(const Vec<D>& local) const { return room_from_body * local; }
  Vec<D> velocity(const Vec<D>& arm) const { return v + cross_velocity<D>(w, arm); }
};

}  // namespace obscura::sim
