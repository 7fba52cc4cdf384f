#pragma once

#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/name_range.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the bonds of a scene into its model: between two bodies, or between all of some that lie near each
/// other at the start. Requires the bodies. Answers which bonds each [[bond]] is.
template <int D>
std::vector<NameRange> bonds(const Node& top, const NameTable& roster, sim::World<D>& world,
                             Diagnostics& complaints);

}  // namespace obscura::scene
