#pragma once

#include "media/glb.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// The surface of a body in its own frame. Bodies of the plane, which have no depth, get `depth` (m); a
/// point, which has no size, is a small ball of a tenth of it.
media::Glb::Mesh surface(const sim::SceneInfo::Body& body, double depth);

/// A round rod along y from -1/2 to 1/2, of radius one: a spring or a rod between two places is one, scaled.
media::Glb::Mesh rod();

/// A round rod along places, of a radius (m).
media::Glb::Mesh tube(const std::vector<sim::Vec3>& way, double radius);

/// A rectangle at y = 0, seen from above, that ends where `low` and `high` say in x and z.
media::Glb::Mesh floor(const sim::Vec3& low, const sim::Vec3& high);

}  // namespace obscura::app
