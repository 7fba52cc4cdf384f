#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "sim/shape/shape.h"

namespace obscura::scene {

/// Calls `meet(a, b)`, a < b, once for each two boxes that meet and whose kinds `matter` to each other, until
/// it returns false. `kinds`: one a box; negative ones are left out. Returns how many pairs of boxes were
/// compared: nearly linear in the number of boxes, whatever their sizes, where few of them meet. Boxes at the
/// same place whose kinds do not matter to each other cost nothing.
template <int D>
std::int64_t meetings(std::span<const sim::Bounds<D>> boxes, std::span<const int> kinds,
                      const std::function<bool(int, int)>& matter, const std::function<bool(int, int)>& meet);

}  // namespace obscura::scene
