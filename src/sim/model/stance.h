#pragma once

#include "sim/math/orientation.h"
#include "sim/model/state.h"

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

/// Index of a body among those that turn; negative for one that does not.
template <int D>
int turning(const State<D>& state, int body) {
  return body - int(state.x.size() - state.turn.size());
}

template <int D>
BodyMotion<D> body_motion(const State<D>& state, int body) {
  BodyMotion<D> at;
  at.x = state.x[body];
  at.v = state.v[body];
  if (const int k = turning(state, body); k >= 0) {
    at.room_from_body = rotation<D>(state.turn[k]);
    at.w = state.spin[k];
  }
  return at;
}

}  // namespace obscura::sim
