// Semi-implicit (symplectic) Euler.
//   v += h a(t, d, v)
//   d += h v                 the new v
// Source: Hairer, Lubich and Wanner, Geometric Numerical Integration (2006), §I.1.2.

#include "sim/math/axpy.h"
#include "sim/motion/integrator.h"

namespace obscura::sim {

void semi_implicit(System& system, double t, double h, std::span<double> d, std::span<double> v,
                   Stages& stages) {
  const std::size_t n = d.size();
  const auto dk = stages.row(0, n), vk = stages.row(1, n);

  system.rates(t, d, v, dk, vk);
  axpy(n, v.data(), h, vk.data(), v.data());
  axpy(n, d.data(), h, v.data(), d.data());
}

}  // namespace obscura::sim
