#pragma once

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/expressions.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the joints of a scene into its world. Requires the bodies.
template <int D>
void joints(const Node& top, const Seating<D>& roster, Constants& constants, sim::World<D>& world,
            Diagnostics& complaints);

}  // namespace obscura::scene
