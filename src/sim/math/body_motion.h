#pragma once

#include "sim/math/orientation.h"

namespace obscura::sim {

/// How a body stands and moves, and from it how its points do. A body that does not turn has no spin.
template <int D>
struct BodyMotion {
  Vec<D> x = Vec<D>::Zero(), v = Vec<D>::Zero();
  Rotation<D> room_from_body = Rotation<D>::Identity();
  AngularVec<D> w = AngularVec<D>::Zero();

  Vec<D> arm(const Vec<D>& local) const { return room_from_body * local; }
  Vec<D> velocity(const Vec<D>& arm) const { return v + cross_velocity<D>(w, arm); }
};

}  // namespace obscura::sim
