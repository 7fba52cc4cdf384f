#pragma once

#include <optional>

#include "scene/complaints.h"
#include "scene/fields.h"

namespace obscura::scene {

/// `static_friction` of a wall, a track, or the i-th of n bodies, if it is given: at least its `friction`.
std::optional<double> static_friction(const Fields& fields, std::optional<double> friction,
                                      Diagnostics& complaints, int i = 0, int n = 1);

}  // namespace obscura::scene
