#pragma once

#include <map>
#include <utility>

#include "scene/when_settings.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Makes the bodies that [[when]] lets go ready for it. Before forces, which leave out what never moves.
template <int D>
void ready_to_let_go(const Node& top, const NameTable& roster, Constants& constants, sim::World<D>& world,
                     Diagnostics& complaints);

/// The joints that `join` and `stick` make of two bodies: each two have one.
using Glued = std::map<std::pair<int, int>, int>;

/// Reads what a [[when]] does into `when`, whose condition is known, and the changes and joints that it makes
/// into the world. Complains where it does nothing, or what cannot be done.
template <int D>
void actions(const Fields& fields, const WhenNames<D>& names, const Rebuild<D>& rebuild, sim::World<D>& world,
             Glued& glued, sim::When<D>& when, Diagnostics& complaints);

}  // namespace obscura::scene
