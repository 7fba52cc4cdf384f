// The midpoint rule.
//   y += h f(t + h/2, y + h/2 f(t, y))
// Source: Runge (1895); Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), §II.1.

#include "sim/math/axpy.h"
#include "sim/motion/integrator.h"

namespace obscura::sim {

void midpoint(System& system, double t, double h, std::span<double> d, std::span<double> v, Stages& stages) {
  const std::size_t n = d.size();
  const auto ds = stages.row(0, n), vs = stages.row(1, n);
  const auto dk = stages.row(2, n), vk = stages.row(3, n);

  system.rates(t, d, v, dk, vk);
  axpy(n, d.data(), 0.5 * h, dk.data(), ds.data());
  axpy(n, v.data(), 0.5 * h, vk.data(), vs.data());
  system.rates(t + 0.5 * h, ds, vs, dk, vk);
  axpy(n, d.data(), h, dk.data(), d.data());
  axpy(n, v.data(), h, vk.data(), v.data());
}

}  // namespace obscura::sim
