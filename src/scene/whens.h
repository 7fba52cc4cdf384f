#pragma once

#include "scene/expressions.h"
#include "scene/when_actions.h"

namespace obscura::scene {

/// Puts the conditions of [[when]] and the changes that they make into a world, after all else. False: some
/// are left out, as a joint or a spring that they name is wrong, which has been told.
template <int D>
bool whens(const Node& top, const NameTable& roster, const std::vector<NameRange>& springs,
           const std::vector<NameRange>& bonds, Constants& constants, const Rebuild<D>& rebuild,
           sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
