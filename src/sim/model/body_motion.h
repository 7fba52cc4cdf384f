#pragma once

#include "sim/math/body_motion.h"
#include "sim/model/state.h"

namespace obscura::sim {

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

/// Where a point of a body, or a place of the room, is, m.
template <int D>
Vec<D> place(const State<D>& state, const End<D>& end) {
  if (end.body < 0) return end.local;
  const BodyMotion<D> at = body_motion(state, end.body);
  return at.x + at.arm(end.local);
}

/// And how it moves, m/s.
template <int D>
Vec<D> velocity(const State<D>& state, const End<D>& end) {
  if (end.body < 0) return Vec<D>::Zero();
  const BodyMotion<D> at = body_motion(state, end.body);
  return at.velocity(at.arm(end.local));
}

/// A body, of this orientation, after h s at its velocity.
template <int D>
BodyMotion<D> ahead(BodyMotion<D> at, const Orientation<D>& turn, double h) {
  at.x += h * at.v;
  if (!at.w.isZero(0)) at.room_from_body = rotation<D>(turned<D>(turn, AngularVec<D>(h * at.w)));
  return at;
}

}  // namespace obscura::sim
