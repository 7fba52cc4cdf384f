#pragma once

#include <span>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/overrides.h"

namespace obscura::scene {

/// Complains of keys that can do nothing as the scene is written: an event, an explosion or a release after
/// the end, a wind where no body has drag, a field where none has a charge, and their like. What --set has
/// made so is no mistake of the scene: a shorter duration, a body held. `copies`: what --set gives to single
/// copies. Requires a checked scene.
void refuse_idle_keys(const Node& top, std::span<const CopySet> copies, Diagnostics& complaints);

}  // namespace obscura::scene
