#pragma once

#include <vector>

#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// Bodies whose joints leave them motions only to the first order, as those of a chain that is straight
/// between two walls: an infinitesimal mechanism. What acts across it would need forces along it without
/// bound, and no step finds these. Each as the Trouble that a run may end in; empty if there are none. Ropes,
/// pulleys, gears and screws are left out, and so are linkages of several hundred rows.
std::vector<Trouble> infinitesimal_motions(const Model<2>& model, const State<2>& state);
std::vector<Trouble> infinitesimal_motions(const Model<3>& model, const State<3>& state);

}  // namespace obscura::sim
