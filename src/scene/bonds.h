#pragma once

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the bonds of a scene into its model: between two bodies, or between all of some that lie near each
/// other at the start. Requires the bodies.
template <int D>
void bonds(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
