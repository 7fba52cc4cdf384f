// An explosion as force from a point, the explosion paper's Method.
//   F = S r / (|r|^2 + eps^2)^(3/2)           S  strength, N m^2;  r  from the centre to the point
//   m dv/dt = sum F,   I dw/dt + w x I w = sum arm x F

#include "sim/force/explosion.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

template <int D>
Vec<D> blast(const Explosion<D>& explosion, const Vec<D>& place) {
  const Vec<D> r = place - explosion.center;
  const double distance2 = r.squaredNorm() + explosion.softening * explosion.softening;
  if (distance2 == 0) return Vec<D>::Zero();
  return explosion.strength / (distance2 * std::sqrt(distance2)) * r;
}

template <int D>
Blasts<D>::Blasts(const Model<D>& model) : model_(model), tips_(model.bodies) {}

template <int D>
Wrench<D> Blasts<D>::push(const Explosion<D>& explosion, int body, const BodyMotion<D>& at) const {
  Wrench<D> sum;
  for (const SupportVertex<D>& tip : tips_[body]) {
    const Vec<D> arm = at.arm(tip.at), force = blast<D>(explosion, at.x + arm);
    sum.f += force;
    sum.n += moment<D>(arm, force);
  }
  return sum;
}

namespace {

template <int D>
void wake(State<D>& state) {
  std::fill(state.frozen.begin(), state.frozen.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0.0);
}

}  // namespace

template <int D>
void Blasts<D>::begin(State<D>& state, int explosion) const {
  const Explosion<D>& it = model_.explosions[explosion];
  Blast<D>& now = state.blasts[explosion];
  if (!now.on) wake(state);
  now.on = 1;
  if (it.scheme == Explosion<D>::Scheme::smooth) return;
  now.forces.assign(model_.bodies.size(), Vec<D>::Zero());
  now.torques.assign(model_.bodies.size(), AngularVec<D>::Zero());
  for (int body = 0; body < int(model_.bodies.size()); ++body) {
    if (model_.bodies[body].fixed) continue;
    const Wrench<D> all = push(it, body, body_motion(state, body));
    now.forces[body] = all.f, now.torques[body] = all.n;
  }
}

template <int D>
void Blasts<D>::end(State<D>& state, int explosion) const {
  wake(state);
  state.blasts[explosion] = {};
}

template Vec<2> blast<2>(const Explosion<2>&, const Vec<2>&);
template Vec<3> blast<3>(const Explosion<3>&, const Vec<3>&);
template class Blasts<2>;
template class Blasts<3>;

}  // namespace obscura::sim
