#pragma once

#include <memory>

#include "sim/step/run.h"

namespace obscura::sim {

/// A run as one of its bodies sees it. In snapshots and ways places, orientations and velocities are those
/// against that body, in a frame that turns with it and lies in the room as it did at the start; forces are
/// those that act, in the same frame. Times, energies, momenta and all else are the room's. `place` (m),
/// `orientation` and, in the plane, `angle` (rad) are the body's at the start.
std::unique_ptr<Run> seen_from(std::unique_ptr<Run> run, int body, const Vec3& place,
                               const Eigen::Quaterniond& orientation, double angle);

}  // namespace obscura::sim
