#pragma once

#include <cstddef>

namespace obscura::sim {

// Loops the integrators share. Pointers overlap nowhere, except that `out` may be `y`.

/// out = y + h k
inline void axpy(std::size_t n, const double* y, double h, const double* __restrict k,
                 double* __restrict out) {
  for (std::size_t i = 0; i < n; ++i) out[i] = y[i] + h * k[i];
}

}  // namespace obscura::sim
