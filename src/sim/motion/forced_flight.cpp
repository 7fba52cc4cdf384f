#include "sim/motion/forced_flight.h"

#include <algorithm>

#include "sim/math/limits.h"

namespace obscura::sim {

template <int D>
ForcedFlight<D>::ForcedFlight(const Model<D>& model, FlyingForces<D>& forces)
    : model_(model), forces_(forces), passages_(model), x_(D * kMost), d_(D * kMost), v_(D * kMost) {
  bool drag = false;
  for (const Body<D>& body : model.bodies) {
    drag_.push_back(body.drag / body.mass);
    drag = drag || body.drag != 0;
  }
  if (!drag) drag_.clear();
}

template <int D>
double ForcedFlight<D>::step(Integrate* integrate, State<D>& state, int first, int count, double t, double h,
                             Stages& stages) {
  if (!passages_.any()) return piece(integrate, state, first, count, t, h, stages);
  double work = 0;
  int begun = first;  // bodies that are far go together
  const auto go_together = [&](int end) {
    if (end > begun) work += piece(integrate, state, begun, end - begun, t, h, stages);
    begun = end + 1;
  };
  for (int body = first; body < first + count; ++body) {
    if (passages_.fastest(state, h, body) == 0) continue;
    go_together(body);
    step_by_passages(
        model_.integrator, t, h, state.step, state.limits_met.passages,
        [&](double) { return passages_.fastest(state, h, body); },
        [&](double from, double length) { work += piece(integrate, state, body, 1, from, length, stages); });
  }
  go_together(first + count);
  return work;
}

template <int D>
double ForcedFlight<D>::piece(Integrate* integrate, State<D>& state, int first, int count, double t, double h,
                              Stages& stages) {
  first_ = first, count_ = count, stage_ = 0;
  const std::size_t n = std::size_t(D * count);
  double *const places = state.x[std::size_t(first)].data(), *const velocities =
                                                                 state.v[std::size_t(first)].data();
  for (int axis = 0; axis < D; ++axis) {
    double *const x = x_.data() + axis * count, *const v = v_.data() + axis * count;
    for (int i = 0; i < count; ++i) x[i] = places[D * i + axis], v[i] = velocities[D * i + axis];
  }
  const std::span<double> d(d_.data(), n), v(v_.data(), n);
  std::fill(d.begin(), d.end(), 0.0);
  integrate(*this, t, h, d, v, stages);
  if (model_.integrator == Integrator::rk4)
    note_roughness(
        state.limits_met, state.step,
        roughness({std::size_t(count), D, 1, std::size_t(count)}, h, v, kFaintest * model_.scale, stages));
  for (int axis = 0; axis < D; ++axis) {
    const double *const moved = d_.data() + axis * count, *const now = v_.data() + axis * count;
    for (int i = 0; i < count; ++i) places[D * i + axis] += moved[i], velocities[D * i + axis] = now[i];
  }
  const double* const p = powers_;
  if (model_.integrator == Integrator::rk4) return h * (p[0] + 2 * (p[1] + p[2]) + p[3]) / 6;
  return h * p[model_.integrator == Integrator::midpoint ? 1 : 0];
}

template <int D>
void ForcedFlight<D>::rates(double t, std::span<const double> d, std::span<const double> v,
                            std::span<double> d_rate, std::span<double> v_rate) {
  std::copy(v.begin(), v.end(), d_rate.begin());
  for (int axis = 0; axis < D; ++axis) {
    const double g = model_.gravity[axis];
    const double* const speed = v.data() + axis * count_;
    double* const out = v_rate.data() + axis * count_;
    if (drag_.empty()) {
      std::fill_n(out, count_, g);
    } else {
      const double* const drag = drag_.data() + first_;
      for (int i = 0; i < count_; ++i) out[i] = g - drag[i] * speed[i];
    }
  }
  const double power = forces_.accelerate(t, first_, count_, x_.data(), d.data(), v.data(), v_rate.data());
  if (stage_ < 4) powers_[stage_++] = power;
}

template class ForcedFlight<2>;
template class ForcedFlight<3>;

}  // namespace obscura::sim
