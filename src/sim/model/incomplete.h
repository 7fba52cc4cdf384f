#pragma once

#include <optional>

#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// What a world lacks to be stepped: velocities that are missing or no numbers, bodies without mass, ends
/// that name bodies which are not there. None: it is whole. Looks at what a caller gives, not at what
/// Stepper::begin() makes.
template <int D>
std::optional<Trouble> incomplete(const World<D>& world);

}  // namespace obscura::sim
