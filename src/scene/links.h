#pragma once

#include "scene/bodies.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/state.h"

namespace obscura::scene {

/// Puts the springs, the nets and the mice of a scene into its world. Requires the bodies, and model.scale
/// for the mice.
void springs(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints);
void nets(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints);
void mice(const Node& top, sim::World<2>& world, Complaints& complaints);

}  // namespace obscura::scene
