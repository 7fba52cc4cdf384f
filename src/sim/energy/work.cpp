// Work of forces along the path of a step, by Gauss's rule of two points:
//   W = h/2 (P(s1) + P(s2)),   s = 1/2 -+ 1/(2 sqrt 3),   P = sum f . v
// of the cubic through places and velocities at both ends. Its velocity errs by h^3 at either point, with
// opposite signs.

#include "sim/energy/work.h"

#include <algorithm>

#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

constexpr double kGaussPoint = 0.21132486540518713;  // 1/2 - 1/(2 sqrt 3)

}  // namespace

template <int D>
WorkBooks<D>::WorkBooks(const Model<D>& model) : model_(model), forces_(model) {
  for (const Body<D>& body : model.bodies) drag_ = drag_ || body.drag != 0;
  any_ = drag_;
  for (const Force<D>& force : model.forces) any_ = any_ || force.does_work();
}

template <int D>
void WorkBooks<D>::open(const State<D>& state) {
  if (!any_) return;
  x_ = state.x, v_ = state.v;
  if (!forces_.any()) return;
  turn_ = state.turn, spin_ = state.spin;
  if (gathered_) return;
  forces_.gather(state);
  gathered_ = true;
}

template <int D>
void WorkBooks<D>::close(State<D>& state, double t, double h) {
  if (!any_ || !(h > 0)) return;
  const int n = int(state.x.size()), still = n - int(state.turn.size());
  if (!forces_.any()) {
    state.work[0] -= h * dragged(state, h);
    return;
  }
  if (forces_.flying().all()) {
    const std::size_t size = std::size_t(D * n);
    flat_.resize(4 * size);
    double *const x = flat_.data(), *const none = x + size, *const v = none + size, *const rates = v + size;
    const double *const x0 = x_[0].data(), *const v0 = v_[0].data(), *const x1 = state.x[0].data(),
                        *const v1 = state.v[0].data();
    for (const double s : {kGaussPoint, 1 - kGaussPoint}) {
      const double r = 1 - s, a = r * r * (1 + 2 * s), b = s * s * (3 - 2 * s), c = h * s * r * r,
                   e = h * s * s * r;
      const double p = 6 * s * r / h, q = r * (1 - 3 * s), w = s * (3 * s - 2);
      for (int axis = 0; axis < D; ++axis) {
        double *const places = x + axis * n, *const speeds = v + axis * n;
        for (int k = 0; k < n; ++k) {
          const int i = D * k + axis;
          places[k] = a * x0[i] + b * x1[i] + c * v0[i] - e * v1[i];
          speeds[k] = p * (x1[i] - x0[i]) + q * v0[i] + w * v1[i];
        }
      }
      state.work[0] += 0.5 * h * forces_.flying().accelerate(t + s * h, 0, n, x, none, v, rates);
    }
    return;
  }
  motions_.resize(std::size_t(n));
  forces_.refer(state);
  double sum = 0;
  for (const double s : {kGaussPoint, 1 - kGaussPoint}) {
    const double r = 1 - s;
    for (int i = 0; i < n; ++i) {
      BodyMotion<D>& at = motions_[std::size_t(i)];
      const Vec<D>&x0 = x_[i], &x1 = state.x[i], &v0 = v_[i], &v1 = state.v[i];
      at.x = r * r * (1 + 2 * s) * x0 + s * s * (3 - 2 * s) * x1 + h * s * r * (r * v0 - s * v1);
      at.v = 6 * s * r / h * (x1 - x0) + r * (1 - 3 * s) * v0 + s * (3 * s - 2) * v1;
      if (i < still) continue;
      const int k = i - still;
      at.room_from_body = rotation<D>(between<D>(turn_[k], spin_[k], state.turn[k], state.spin[k], h, s));
      at.w = spin_between<D>(turn_[k], spin_[k], state.turn[k], state.spin[k], h, s);
    }
    double power = forces_.power(t + s * h, motions_);
    for (int i = 0; drag_ && i < n; ++i) {
      const Body<D>& body = model_.bodies[std::size_t(i)];
      if (body.drag != 0 && !body.fixed) power -= body.drag * motions_[std::size_t(i)].v.squaredNorm();
    }
    sum += 0.5 * h * power;
  }
  state.work[0] += sum;
}

// what drag alone takes, the mean through the step, W
template <int D>
double WorkBooks<D>::dragged(const State<D>& state, double h) const {
  double sum = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    const Body<D>& body = model_.bodies[i];
    if (body.drag == 0 || body.fixed) continue;
    for (const double s : {kGaussPoint, 1 - kGaussPoint}) {
      const double r = 1 - s;
      const Vec<D> v =
          6 * s * r / h * (state.x[i] - x_[i]) + r * (1 - 3 * s) * v_[i] + s * (3 * s - 2) * state.v[i];
      sum += 0.5 * body.drag * v.squaredNorm();
    }
  }
  return sum;
}

template class WorkBooks<2>;
template class WorkBooks<3>;

}  // namespace obscura::sim
