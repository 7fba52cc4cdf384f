#pragma once

#include <vector>

#include "sim/shape/form.h"

namespace obscura::scene {

/// The convex hull of points in space: of all that lie on it the corners, and its faces, flat ones whole,
/// loops counter-clockwise seen from outside. No faces where the points lie in a plane.
sim::Hull hull(const std::vector<sim::Vec3>& typed);

}  // namespace obscura::scene
