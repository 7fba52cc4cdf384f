// Kinematic bodies and belts in the plane: where bodies that are moved go within a substep, what arms that
// turn with them add to the slip, and the work that they do.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/plane.h"

namespace obscura::sim {

using plane::ContactBatch;
using plane::kLanes;
using plane::Pair;

// tells the pair search how far they may be from where their velocities at t take them
void PlaneIterative::foresee_driven(double t) {
  for (int i = 0; i < drives_.size(); ++i) pairs_.foresee(drives_.body(i), farther(i, t, span_));
}

// their velocities and displacements in the substep, from their motion
void PlaneIterative::move_driven(StepPart<D> part) {
  driven_gain_ = 0;
  for (int i = 0; i < drives_.size(); ++i) {
    const int body = drives_.body(i);
    const DrivenMotion<D>& to = driven_[i] = drives_.at(i, part.t + part.h);
    const DrivenMotion<D> from = jumps(part.h) ? to : drives_.at(i, part.t);
    const Motion o{from.at.v[0], from.at.v[1], from.at.w[0], 0}, v{to.at.v[0], to.at.v[1], to.at.w[0], 0};
    // no zeros below zero: threads write what does not move as it was
    old_[body] = o, moving_[body] = {v.x + 0.0, v.y + 0.0, v.w + 0.0, 0};
    dv_[body] = {v.x - o.x, v.y - o.y, v.w - o.w, 0};
    dx_[body] = {to.at.x[0] - poses_[body].x, to.at.x[1] - poses_[body].y, to.turn[0] - turns_[body], 0};
    const Motion& gain = dv_[body];
    driven_gain_ = std::max(driven_gain_, std::fabs(gain.x) + std::fabs(gain.y) +
                                              std::fabs(gain.w) * cores_.bounding_radius[body]);
  }
}

void PlaneIterative::place_driven(State<D>& state) {
  const int still = int(turns_.size() - state.turn.size());
  for (int i = 0; i < drives_.size(); ++i) {
    const int body = drives_.body(i);
    const DrivenMotion<D>& to = driven_[i];
    state.x[body] = to.at.x, state.v[body] = to.at.v;
    poses_[body].x = to.at.x[0], poses_[body].y = to.at.x[1];
    if (body < still) continue;
    state.turn[body - still] = to.turn, state.spin[body - still] = to.at.w, turns_[body] = to.turn[0];
  }
}

// each force times the displacement of the carrying surface
double PlaneIterative::contact_work(StepPart<D> part) const {
  const auto mean = [&](int body) {
    Motion m{};
    if (drives_.number(body) < 0) return m;
    const Motion &o = old_[body], &v = moving_[body];
    m.x = 0.5 * (o.x + v.x), m.y = 0.5 * (o.y + v.y), m.w = 0.5 * (o.w + v.w);
    return m;
  };
  const int room = int(model_.bodies.size());
  double sum = 0;
  for (const Pair& pair : pairs_.all()) {
    if (pair.slot < 0 || !(carries_[pair.a] || (pair.b >= 0 && carries_[pair.b]))) continue;
    const ContactBatch& g = batches_[pair.slot / kLanes];
    const int lane = pair.slot % kLanes;
    const Motion a = mean(pair.a), b = mean(pair.b);
    for (int k = 0; k < pair.touches; ++k) {
      const double fx = g.p[k][lane], fy = g.q[k][lane];
      if (fx == 0 && fy == 0) continue;
      const plane::TouchRow r =
          plane::middle_row(g, lane, k, middle_[pair.a], middle_[pair.b < 0 ? room : pair.b]);
      const double n = fx * r.nx + fy * r.ny, t = fy * r.nx - fx * r.ny;
      sum -= n * plane::normal_speed(r, a, b) + t * (plane::tangent_speed(r, a, b) + g.belt[lane]);
    }
  }
  return part.h * sum;
}

}  // namespace obscura::sim
