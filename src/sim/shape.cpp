// Moments of inertia about the centre, handout §3.1.
//   I_z = m (x^2 + y^2) / 12        x, y  sides of the box

#include "sim/shape.h"

namespace obscura::sim {

template <int D>
Spin<D> inertia(const Shape<D>& shape, double mass) {
  Spin<D> moments = Spin<D>::Zero();
  if (shape.kind != ShapeKind::box) return moments;
  const Vec<D> side = 2 * shape.half;
  if constexpr (D == 2) {
    moments[0] = mass * (side[0] * side[0] + side[1] * side[1]) / 12;
  } else {
    for (int axis = 0; axis < D; ++axis) {
      moments[axis] = mass * (side.squaredNorm() - side[axis] * side[axis]) / 12;
    }
  }
  return moments;
}

template <int D>
double reach(const Shape<D>& shape) {
  switch (shape.kind) {
    case ShapeKind::point:
      return 0;
    case ShapeKind::ball:
      return shape.radius;
    case ShapeKind::box:
      return shape.half.norm();
  }
  return 0;
}

template Spin<2> inertia<2>(const Shape<2>&, double);
template double reach<2>(const Shape<2>&);

}  // namespace obscura::sim
