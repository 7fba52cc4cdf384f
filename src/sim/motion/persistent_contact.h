#pragma once

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// A contact that bears in a step, as forces that depend on the motion see it: the motion is that under the
/// force which the contact had last. It keeps its size and turns as its normal does, so that a pair that
/// turns keeps its angular momentum.
template <int D>
struct PersistentContact {
  int a = -1, b = -1;  // bodies; -1: the room
  ContactCandidate<D> gap;
  Vec<D> normal = Vec<D>::Zero(), point = Vec<D>::Zero();  // where the step begins, in the room
  Vec<D> force = Vec<D>::Zero();                           // N, on a there

  struct Push {
    Vec<D> force, point;  // on a, N; where, in the room
  };
  /// As the bodies stand within the step.
  Push at(const BodyMotion<D>& a_at, const BodyMotion<D>& b_at) const {
    const EvaluatedContact<D> now = evaluate(gap, a_at, b_at);
    // by the least turn from the one normal to the other: f + u x f + u x (u x f) / (1 + n . n')
    const double cos = normal.dot(now.normal);
    if (!(cos > 0)) return {force, now.point};
    const AngularVec<D> u = moment<D>(normal, now.normal);
    const Vec<D> across = cross_velocity<D>(u, force);
    return {force + across + cross_velocity<D>(u, across) / (1 + cos), now.point};
  }
};

}  // namespace obscura::sim
