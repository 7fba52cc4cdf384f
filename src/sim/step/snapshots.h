#pragma once

#include "sim/model/snapshot.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

// Converts states of the plane and of space to the types of sim/model/snapshot.h, which both share.

/// Names, shapes and masses of all that takes part in the run that begins with the state `start`.
template <int D>
SceneInfo cast(const Model<D>& model, const State<D>& start, const std::vector<Path<D>>& paths);

/// The instant `at` of a state, at time `t` (s).
template <int D>
Snapshot snapshot(const Model<D>& model, const State<D>& state, const Stepper<D>& stepper, TimeStamp at,
                  double t);

}  // namespace obscura::sim
