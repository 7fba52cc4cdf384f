#pragma once

#include "draw/page/chart.h"
#include "draw/page/figure.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// What the scene says of a figure of it. Reports names that do not exist.
template <int D>
draw::Figure figure(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                    Diagnostics& complaints);

/// What of the run its film shows beside the picture.
template <int D>
std::vector<draw::Chart> charts(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                Diagnostics& complaints);

}  // namespace obscura::scene
