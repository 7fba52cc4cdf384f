#pragma once

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Makes the chains of a scene of its bodies and joints, which are in the world already.
template <int D>
void chains(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
