#pragma once

#include <vector>

#include "draw/picture/convex.h"

namespace obscura::draw {

/// The corners of what lies in all of `halves`, which go once around as the edges of a convex polygon do,
/// either way; takes time linear in their number. Empty where nothing does. Requires that they bound it.
std::vector<Point> within_all(const std::vector<HalfPlane>& halves);

}  // namespace obscura::draw
