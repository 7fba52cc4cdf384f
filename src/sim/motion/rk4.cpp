// Classical Runge-Kutta.
//   k1 = f(t, y)             k2 = f(t + h/2, y + h/2 k1)
//   k3 = f(t + h/2, y + h/2 k2)     k4 = f(t + h, y + h k3)
//   y += h (k1 + 2 (k2 + k3) + k4) / 6
// Divided by six last: under a constant force whose numbers are short binary fractions the step is exact.
// Source: Kutta (1901); Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), §II.1.

#include <cmath>

#include "sim/math/axpy.h"
#include "sim/motion/integrator.h"

namespace obscura::sim {

namespace {

void sum(std::size_t n, double h, const double* __restrict k1, const double* __restrict k2,
         const double* __restrict k3, const double* __restrict k4, double* __restrict y) {
  for (std::size_t i = 0; i < n; ++i) y[i] += h * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]) / 6;
}

constexpr double kRoughStep = 0.001;
constexpr double kSlowest = 0.02;  // of the fastest body

}  // namespace

void rk4(System& system, double t, double h, std::span<double> d, std::span<double> v, Stages& stages) {
  const std::size_t n = d.size();
  const auto ds = stages.row(0, n), vs = stages.row(1, n);
  const auto d1 = stages.row(2, n), v1 = stages.row(kRk4Rates[0], n);
  const auto d2 = stages.row(4, n), v2 = stages.row(kRk4Rates[1], n);
  const auto d3 = stages.row(6, n), v3 = stages.row(kRk4Rates[2], n);
  const auto d4 = stages.row(8, n), v4 = stages.row(kRk4Rates[3], n);

  system.rates(t, d, v, d1, v1);
  axpy(n, d.data(), 0.5 * h, d1.data(), ds.data());
  axpy(n, v.data(), 0.5 * h, v1.data(), vs.data());
  system.rates(t + 0.5 * h, ds, vs, d2, v2);
  axpy(n, d.data(), 0.5 * h, d2.data(), ds.data());
  axpy(n, v.data(), 0.5 * h, v2.data(), vs.data());
  system.rates(t + 0.5 * h, ds, vs, d3, v3);
  axpy(n, d.data(), h, d3.data(), ds.data());
  axpy(n, v.data(), h, v3.data(), vs.data());
  system.rates(t + h, ds, vs, d4, v4);
  sum(n, h, d1.data(), d2.data(), d3.data(), d4.data(), d.data());
  sum(n, h, v1.data(), v2.data(), v3.data(), v4.data(), v.data());
}

Roughness roughness(const VelocityRows& rows, double h, std::span<const double> v, double least,
                    Stages& stages, bool tied) {
  const auto k1 = stages.row(kRk4Rates[0], v.size()), k2 = stages.row(kRk4Rates[1], v.size());
  const auto k3 = stages.row(kRk4Rates[2], v.size()), k4 = stages.row(kRk4Rates[3], v.size());
  const auto look = [&](double more) {
    Roughness found;
    for (std::size_t body = 0; body < rows.bodies; ++body) {
      double change = 0, size = 0;
      for (std::size_t axis = 0; axis < rows.axes; ++axis) {
        const std::size_t i = rows.first + body * rows.body + axis * rows.axis;
        change += std::fabs((k1[i] - k2[i]) - (k3[i] - k4[i]));
        size += std::fabs(v[i]) + h * std::fabs(k2[i]);
      }
      const double error = h * change / 6;
      if (size > found.pace) found.pace = size;
      if (error > found.error) found.error = error;
      if (error > found.ratio * (size + more)) found.ratio = error / (size + more);
    }
    return found;
  };
  const Roughness found = look(least);
  // what others have just begun to move is told by what it does to them
  return found.ratio > kRoughStep ? look(least + (tied ? 1 : kSlowest) * found.pace) : found;
}

void note_roughness(LimitsMet& met, std::int64_t step, const Roughness& found, bool spins) {
  if (found.ratio > kRoughStep) met.rough.note(step);
  if (spins) return;
  WildestStep& wildest = met.wildest;
  if (found.pace > wildest.pace) wildest.pace = found.pace;
  if (found.ratio > kRoughStep && found.error > wildest.error)
    wildest.error = found.error, wildest.step = step;
}

}  // namespace obscura::sim
