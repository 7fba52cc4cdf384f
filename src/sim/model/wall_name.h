#pragma once

#include <optional>
#include <string_view>

#include "sim/math/vec.h"

namespace obscura::sim {

/// What a wall of the room is called, by its normal, which points into the room: "the floor", "the left
/// wall"; none where it is not along an axis.
template <int D>
std::optional<std::string_view> wall_name(const Vec<D>& normal) {
  constexpr double kAlong = 0.999;
  if (normal.y() > kAlong) return "the floor";
  if (normal.y() < -kAlong) return "the ceiling";
  if (normal.x() > kAlong) return "the left wall";
  if (normal.x() < -kAlong) return "the right wall";
  if constexpr (D == 3) {
    if (normal.z() > kAlong) return "the back wall";
    if (normal.z() < -kAlong) return "the front wall";
  }
  return {};
}

}  // namespace obscura::sim
