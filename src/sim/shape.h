#pragma once

#include "sim/model.h"
#include "sim/turning.h"

namespace obscura::sim {

/// Principal moments of inertia of `shape` about its centre of mass, kg m^2, of uniform density: in the plane
/// m (x^2 + y^2) / 12 of a box with sides x and y (handout §3.1). Zero for what does not turn: points and
/// balls, which are particles; see solid_inertia for a ball that rolls.
template <int D>
Spin<D> inertia(const Shape<D>& shape, double mass);

/// The same, and of a ball what it has when it turns: in the plane m r^2 / 2. Zero for a point.
template <int D>
Spin<D> solid_inertia(const Shape<D>& shape, double mass);

/// How much of the plane (or of space) a shape fills, and how it lies there. Where parts of a compound
/// overlap, what they share counts once for each.
template <int D>
struct Bulk {
  double content = 0;                // m^2; in space m^3
  Vec<D> center = Vec<D>::Zero();    // centroid, in the shape's frame, m
  Spin<D> second = Spin<D>::Zero();  // second moment about the centroid, m^4; in space principal ones, m^5
};

/// Of a point: nothing.
template <int D>
Bulk<D> bulk(const Shape<D>& shape);

/// Corners of a box: corner i lies on the positive side of axis a where bit a of i is set.
template <int D>
inline constexpr int kCorners = 1 << D;

/// Corner i of a box in its own frame, m.
template <int D>
Vec<D> corner(const Shape<D>& shape, int i) {
  Vec<D> place = shape.half;
  for (int axis = 0; axis < D; ++axis) {
    if (!(i >> axis & 1)) place[axis] = -place[axis];
  }
  return place;
}

/// The farthest the shape reaches from its centre (the origin of its frame), m.
template <int D>
double reach(const Shape<D>& shape);

/// An upright box in the room, m.
template <int D>
struct Bounds {
  Vec<D> lower = Vec<D>::Zero(), upper = Vec<D>::Zero();

  bool meets(const Bounds& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
};

/// The smallest upright box around a shape.
template <int D>
Bounds<D> bounds(const Shape<D>& shape, const Stance<D>& at);

}  // namespace obscura::sim
