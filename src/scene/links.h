#pragma once

#include <vector>

#include "scene/bodies.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/state.h"

namespace obscura::scene {

/// The ends that one side of `between` means: a place in the room is one, "ball[*]" is many. Complains and
/// gives none where there are none such.
std::vector<sim::End<2>> ends(const Node& node, const Roster& roster, const sim::World<2>& world,
                              Complaints& complaints);

/// Where an end is at the start.
sim::Vec<2> start(const sim::World<2>& world, const sim::End<2>& end);

/// Puts the springs, the nets and the mice of a scene into its world. Requires the bodies, and model.scale
/// for the mice.
void springs(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints);
void nets(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints);
void mice(const Node& top, sim::World<2>& world, Complaints& complaints);

}  // namespace obscura::scene
