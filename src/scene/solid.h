#pragma once

#include <string>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "sim/shape.h"

namespace obscura::scene {

/// The form of a body that turns, about its centre of mass, and what its mass is spread over, seen from the
/// body's own origin.
struct Solid {
  sim::Shape<2> shape;
  sim::Bulk<2> bulk;
};

/// The form of the i-th of n copies of a ball, box, polygon or body. Complains, and gives some form, where
/// points make no convex polygon or a part is none.
Solid solid(const Fields& fields, const std::string& kind, int i, int n, Complaints& complaints);

}  // namespace obscura::scene
