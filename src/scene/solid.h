#pragma once

#include <string>

#include "scene/complaints.h"
#include "scene/fields.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

/// The form of a body that turns as its body sees it, about its centre of mass and along its principal axes,
/// and what its mass is spread over, seen from the frame in which it was typed.
template <int D>
struct Solid {
  sim::Shape<D> shape;
  sim::MassProperties<D> bulk;
};

/// The form of the i-th of n copies of a ball, box, capsule, polygon, hull or body. Complains, and gives some
/// form, where points make no solid or a part is none.
template <int D>
Solid<D> solid(const Fields& fields, const std::string& kind, int i, int n, Diagnostics& complaints);

/// The form of a body that is turned so from now on, and cannot turn otherwise.
template <int D>
sim::Shape<D> held(const sim::Shape<D>& shape, const sim::Orientation<D>& turn);

}  // namespace obscura::scene
