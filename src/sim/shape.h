#pragma once

#include "sim/model.h"

namespace obscura::sim {

/// Principal moments of inertia of `shape` about its centre, kg m^2: in the plane m (x^2 + y^2) / 12 of a box
/// with sides x and y (handout §3.1). Zero for what does not turn.
template <int D>
Spin<D> inertia(const Shape<D>& shape, double mass);

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

/// The farthest the shape reaches from its centre, m.
template <int D>
double reach(const Shape<D>& shape);

}  // namespace obscura::sim
