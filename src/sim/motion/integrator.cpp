#include "sim/motion/integrator.h"

namespace obscura::sim {

void Stages::reserve(std::size_t n) {
  // an odd number of cache lines a row: rows 4096 bytes apart would be taken for one another
  const std::size_t lines = (n + 7) / 8;
  const std::size_t stride = 8 * (lines | 1);
  if (stride <= stride_) return;
  stride_ = stride;
  room_.assign(kMost * stride_, 0.0);
}

Integrate* integrate(Integrator which) {
  switch (which) {
    case Integrator::rk4:
      return rk4;
    case Integrator::midpoint:
      return midpoint;
    case Integrator::euler:
      return euler;
    case Integrator::semi_implicit:
      return semi_implicit;
  }
  return rk4;
}

}  // namespace obscura::sim
