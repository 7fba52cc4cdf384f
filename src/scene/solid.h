#pragma once

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

/// A body of the form that was typed.
template <int D>
Solid<D> solid(const sim::Shape<D>& typed);

/// The convex form of points: a polygon in the plane, a hull in space. Complains, and gives some, where they
/// make none.
template <int D>
sim::Shape<D> convex(const Node& points, Diagnostics& complaints);
template <>
sim::Shape<2> convex(const Node& points, Diagnostics& complaints);
template <>
sim::Shape<3> convex(const Node& points, Diagnostics& complaints);

/// A capsule by its length from end to end, m. Complains, and gives a longer one, where that is not more than
/// twice its radius.
sim::Capsule capsule(const Fields& fields, double length, double radius, Diagnostics& complaints);

/// The parts of a body as one. Complains, and gives some, where a part is none.
template <int D>
sim::Shape<D> compound(const Node& shapes, Diagnostics& complaints);

/// The same body with another centre of mass, in the frame that was typed; its second moment about it is what
/// it was about the centroid.
template <int D>
Solid<D> with_center(const Solid<D>& solid, const sim::Vec<D>& center);

/// The form of a body that is turned so from now on, and cannot turn otherwise.
template <int D>
sim::Shape<D> held(const sim::Shape<D>& shape, const sim::Orientation<D>& turn);

}  // namespace obscura::scene
