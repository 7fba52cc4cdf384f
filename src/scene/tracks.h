#pragma once

#include "draw/picture/look.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/expressions.h"
#include "scene/room.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the tracks of a scene into its world: rails, with a body of their own where they are part of none,
/// and wires, whose beads it puts onto them. Requires the bodies.
template <int D>
void tracks(const Node& top, Constants& constants, Seating<D>& roster, sim::World<D>& world, draw::Look& look,
            Diagnostics& complaints);

/// Complains of bodies that might come upon a track and cannot touch it, of tracks beside bonds, and of what
/// else no solver has. Requires all else of the model.
template <int D>
void refuse_off_tracks(const Node& top, const sim::Model<D>& model, Diagnostics& complaints);

}  // namespace obscura::scene
