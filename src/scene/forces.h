#pragma once

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/expressions.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the forces of a scene into its world: those of expressions ([[force]]), attractors, and those that
/// the room has beside gravity and drag. Requires the bodies.
template <int D>
void forces(const Node& top, Constants& constants, const Seating<D>& roster, sim::World<D>& world,
            Diagnostics& complaints);

}  // namespace obscura::scene
