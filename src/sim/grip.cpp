#include "sim/grip.h"

#include <limits>

#include "sim/shape.h"
#include "sim/turning.h"

namespace obscura::sim {

template <int D>
Grip<D> closest(const Model<D>& model, const State<D>& state, const Vec<D>& place) {
  Grip<D> grip;
  double nearest = std::numeric_limits<double>::infinity();
  const auto offer = [&](int body, const Vec<D>& local, const Vec<D>& at) {
    const double distance = (at - place).squaredNorm();
    if (distance < nearest) nearest = distance, grip = {body, local};
  };
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    const Body<D>& b = model.bodies[body];
    if (b.fixed) continue;
    if (!b.turns()) {
      offer(body, Vec<D>::Zero(), state.x[body]);
      continue;
    }
    const Stance<D> at = stance(state, body);
    const auto offer_shape = [&](const Shape<D>& shape) {
      if (shape.kind == ShapeKind::ball) offer(body, shape.center, at.x + at.arm(shape.center));
      for (int i = 0; i < kCorners<D> && shape.kind == ShapeKind::box; ++i) {
        const Vec<D> local = shape.center + corner(shape, i);
        offer(body, local, at.x + at.arm(local));
      }
      for (const Vec<D>& vertex : shape.vertices) offer(body, vertex, at.x + at.arm(vertex));
    };
    offer_shape(b.shape);
    for (const Shape<D>& part : b.shape.parts) offer_shape(part);
  }
  return grip;
}

template Grip<2> closest<2>(const Model<2>&, const State<2>&, const Vec<2>&);

}  // namespace obscura::sim
