#pragma once

#include "sim/math/body_motion.h"
#include "sim/shape/form.h"

namespace obscura::sim {

/// What of a shape lies below a level of the room (y, m).
template <int D>
struct Displaced {
  double content = 0;              // m^2; in space m^3
  Vec<D> center = Vec<D>::Zero();  // its centroid in the room, m; of no content, anywhere
};

/// Of parts of a compound that overlap, what they share counts once for each, as in its mass. A point
/// displaces nothing.
template <int D>
Displaced<D> displaced(const Shape<D>& shape, const BodyMotion<D>& at, double level);

}  // namespace obscura::sim
