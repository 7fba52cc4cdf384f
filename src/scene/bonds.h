#pragma once

#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Bonds of one [[bond]]: its name, and which of the model's they are, from one to before another.
struct BondRange {
  std::string name;
  int first = 0, end = 0;
};

/// Puts the bonds of a scene into its model: between two bodies, or between all of some that lie near each
/// other at the start. Requires the bodies. Answers which bonds each [[bond]] is.
template <int D>
std::vector<BondRange> bonds(const Node& top, const NameTable& roster, sim::World<D>& world,
                             Diagnostics& complaints);

}  // namespace obscura::scene
