#pragma once

#include "draw/figure.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "sim/state.h"

namespace obscura::scene {

/// What the scene says of a figure of it. Complains of who is not there.
template <int D>
draw::Figure figure(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                    Complaints& complaints);

}  // namespace obscura::scene
