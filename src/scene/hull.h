#pragma once

#include <vector>

#include "sim/shape/form.h"

namespace obscura::scene {

/// The convex hull of points in space: the vertices on it, and its faces, coplanar triangles merged, loops
/// counter-clockwise seen from outside. No faces if the points lie in a plane.
sim::Hull hull(const std::vector<sim::Vec3>& typed);

}  // namespace obscura::scene
