#pragma once

#include <optional>
#include <string>

#include "scene/complaints.h"
#include "scene/expressions.h"
#include "scene/fields.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Where the path of a body's motion begins, if it has one.
template <int D>
std::optional<sim::Vec<D>> path_start(const Fields& fields);

/// Gives the last body of a world the motion, the release and the belt of its table, and puts it where its
/// motion begins. `copy`: its number among copies; `seat`: how it lies in what was typed.
template <int D>
void motion(const Fields& fields, const std::string& kind, int copy, bool copied, const Seat<D>& seat,
            Constants& constants, sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
