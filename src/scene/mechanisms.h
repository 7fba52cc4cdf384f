#pragma once

#include <string>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the rope of a pulley into the world, as one joint for each piece of it between wheels: `name`, or
/// name[0], name[1], ... of several.
template <int D>
void pulley(const Fields& fields, const std::string& name, const Seating<D>& roster, sim::World<D>& world,
            Diagnostics& complaints);

/// Puts a gear into the world, after all other joints.
template <int D>
void gear(const Node& top, const Fields& fields, const std::string& name, sim::World<D>& world,
          Diagnostics& complaints);

}  // namespace obscura::scene
