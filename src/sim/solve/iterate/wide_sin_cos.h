#pragma once

#include "sim/collide/core_shapes.h"

namespace obscura::sim::plane {

/// Cosines and sines of many turns (rad), into poses: to the bit those of sim/math/trig.h.
void turn_all(const double* turns, Pose* poses, int count);

}  // namespace obscura::sim::plane
