#pragma once

#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/name_range.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// The ends that one side of `between` means: a place in the room is one, "ball[*]" is many. Complains and
/// gives none where there are none such.
template <int D>
std::vector<sim::End<D>> ends(const Node& node, const Seating<D>& roster, const sim::World<D>& world,
                              Diagnostics& complaints);

/// The place of an end at the start.
template <int D>
sim::Vec<D> start(const sim::World<D>& world, const sim::End<D>& end);

/// Puts the springs, the nets and the mice of a scene into its world. Requires the bodies, and model.scale
/// for the mice. Answers which springs each [[spring]] is.
template <int D>
std::vector<NameRange> springs(const Node& top, const Seating<D>& roster, sim::World<D>& world,
                               Diagnostics& complaints);
template <int D>
void nets(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints);
template <int D>
void mice(const Node& top, sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
