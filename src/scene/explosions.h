#pragma once

#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the explosions of a scene into its model.
template <int D>
void explosions(const Node& top, sim::Model<D>& model, Diagnostics& complaints);

}  // namespace obscura::scene
