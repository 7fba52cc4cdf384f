#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/bonds.h"
#include "scene/complaints.h"
#include "scene/expressions.h"
#include "scene/fields.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Makes the bodies that [[when]] lets go ready for it. Before forces, which leave out what never moves.
template <int D>
void ready_to_let_go(const Node& top, const NameTable& roster, sim::World<D>& world, Diagnostics& complaints);

/// The model of the same scene with one more key set; none, and a complaint at the place, where that is
/// wrong.
template <int D>
using Rebuild =
    std::function<std::optional<sim::Model<D>>(const std::string& set, Place place, Diagnostics& complaints)>;

/// Puts the conditions of [[when]] and the changes that they make into a world, after all else.
template <int D>
void whens(const Node& top, const NameTable& roster, const std::vector<BondRange>& bonds,
           Constants& constants, const Rebuild<D>& rebuild, sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
