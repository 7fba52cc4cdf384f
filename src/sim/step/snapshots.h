#pragma once

#include "sim/model/snapshot.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

// The one place where the dimension is left behind.

/// What takes part in the run.
template <int D>
SceneInfo cast(const Model<D>& model, const std::vector<Path<D>>& paths);

/// The instant `at` of a state, at time `t` (s).
template <int D>
Snapshot snapshot(const Model<D>& model, const State<D>& state, const Stepper<D>& stepper, TimeStamp at,
                  double t);

/// A place of the plane at z = 0.
template <int D>
Vec3 to_3d(const Vec<D>& x) {
  Vec3 place = Vec3::Zero();
  place.head<D>() = x;
  return place;
}

}  // namespace obscura::sim
