#include "sim/force/mouse.h"

#include <limits>

#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

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
    const BodyMotion<D> at = body_motion(state, body);
    for (const SupportVertex<D>& tip : support_vertices(b.shape)) offer(body, tip.at, at.x + at.arm(tip.at));
  }
  return grip;
}

template Grip<2> closest<2>(const Model<2>&, const State<2>&, const Vec<2>&);
template Grip<3> closest<3>(const Model<3>&, const State<3>&, const Vec<3>&);

}  // namespace obscura::sim
