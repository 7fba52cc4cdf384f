#pragma once

#include <string>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "sim/model.h"

namespace obscura::scene {

/// The form of a body that turns, and what its mass is spread over.
struct Solid {
  sim::Shape<2> shape;                       // about its centroid
  sim::Vec<2> center = sim::Vec<2>::Zero();  // the centroid, seen from the body's own origin, m
  double area = 0;                           // m^2; of parts, the sum of theirs
  double moment = 0;                         // about the centroid, of density 1, m^4
};

/// The form of the i-th of n copies of a ball, box, polygon or body. Complains, and gives some form, where
/// points make no convex polygon or a part is none.
Solid solid(const Fields& fields, const std::string& kind, int i, int n, Complaints& complaints);

}  // namespace obscura::scene
