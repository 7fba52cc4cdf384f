#pragma once

#include <vector>

#include "sim/collide/narrow_phase.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// The contact candidates of body a with body b, or with the wall -1 - b if that is negative, whose gaps are
/// below `margin` (m), where a state has both.
template <int D>
std::vector<ContactCandidate<D>> pair_candidates(const Model<D>& model, const State<D>& state, int a, int b,
                                                 double margin) {
  std::vector<ContactCandidate<D>> near;
  const Shape<D>& shape = model.bodies[std::size_t(a)].shape;
  const BodyMotion<D> at = body_motion(state, a);
  if (b < 0)
    collide(a, shape, at, -1 - b, model.walls[std::size_t(-1 - b)], margin, near);
  else
    collide(a, shape, at, b, model.bodies[std::size_t(b)].shape, body_motion(state, b), margin, near);
  return near;
}

}  // namespace obscura::sim
