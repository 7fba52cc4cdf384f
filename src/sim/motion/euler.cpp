// Explicit Euler.
//   y += h f(t, y)
// Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I (1993), §I.7.

#include "sim/math/axpy.h"
#include "sim/motion/integrator.h"

namespace obscura::sim {

void euler(System& system, double t, double h, std::span<double> d, std::span<double> v, Stages& stages) {
  const std::size_t n = d.size();
  const auto dk = stages.row(0, n), vk = stages.row(1, n);

  system.rates(t, d, v, dk, vk);
  axpy(n, d.data(), h, dk.data(), d.data());
  axpy(n, v.data(), h, vk.data(), v.data());
}

}  // namespace obscura::sim
