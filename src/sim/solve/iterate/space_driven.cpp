// Kinematic bodies and belts in space: where bodies that are moved go within a substep, what belts and arms
// that turn with them add to the slip, and the work that they do.

#include <algorithm>
#include <cmath>

#include "sim/solve/iterate/space.h"

namespace obscura::sim {

// what belts add to the speed of a's surface against b's
Vec<3> SpaceIterative::belt(const ContactConstraint& touch) const {
  Vec<D> u = Vec<D>::Zero();
  const auto add = [&](int body, double sign) {
    if (!carries(body) || model_.bodies[body].belt.isZero(0)) return;
    u += sign * belt_velocity<D>(model_.bodies[body], stances_[body].room_from_body, Vec<D>(-sign * touch.n));
  };
  add(touch.a, 1), add(touch.b, -1);
  return u;
}

// where they are and how they move at the end of the step, into the state and among those that others touch
void SpaceIterative::move_driven(State<D>& state, double t, double h) {
  for (int i = 0; i < drives_.size(); ++i) {
    const int body = drives_.body(i);
    const DrivenMotion<D> to = drives_.at(i, t + h);
    state.x[body] = to.at.x, state.v[body] = moving_[body].v = to.at.v;
    if (const int k = turning(state, body); k >= 0)
      state.turn[k] = to.turn, state.spin[k] = moving_[body].w = to.at.w;
  }
}

// what they give, J, by an impulse on a, and back on b, at arms from their centres
double SpaceIterative::given(const Vec<D>& impulse, const BodyMotion<D>& a, int body_a, const Vec<D>& arm_a,
                             const BodyMotion<D>& b, int body_b, const Vec<D>& arm_b) const {
  double sum = 0;
  if (drives_.number(body_a) >= 0) sum -= impulse.dot(a.velocity(arm_a));
  if (body_b < int(model_.bodies.size()) && drives_.number(body_b) >= 0)
    sum += impulse.dot(b.velocity(arm_b));
  return sum;
}

// what they give by an impulse of a touch, J: by the mean of their velocities
double SpaceIterative::given_at(const ContactConstraint& touch, const Vec<D>& impulse) const {
  if ((!carries(touch.a) && !carries(touch.b)) || impulse.isZero(0)) return 0;
  const auto mean = [&](int body) {
    BodyMotion<D> at;
    if (body == int(model_.bodies.size())) return at;
    at.v = 0.5 * (stances_[body].v + moving_[body].v), at.w = 0.5 * (stances_[body].w + moving_[body].w);
    return at;
  };
  return given(impulse, mean(touch.a), touch.a, touch.arm_a, mean(touch.b), touch.b, touch.arm_b) -
         impulse.dot(touch.belt);
}

double SpaceIterative::contact_work(StepPart<D>) const {
  double sum = given_by_blows_;
  for (const ContactConstraint& touch : touches_)
    sum += given_at(touch, touch.normal_impulse * touch.n + touch.tangent_impulse);
  return sum;
}

}  // namespace obscura::sim
