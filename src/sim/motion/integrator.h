#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// A system of ordinary differential equations of first order. Its unknowns are v, the velocity, and d, the
/// displacement since the step began. Positions stay outside: x = x0 + d, an orientation is turned by d.
class System {
 public:
  virtual ~System() = default;

  /// d' and v' at time t (s), into d_rate and v_rate. All four have one length; none overlap.
  virtual void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
                     std::span<double> v_rate) = 0;
};

/// Workspace of an integrator: a row of numbers for each stage. Kept from step to step.
class Stages {
 public:
  static constexpr int kMost = 10;

  /// Sizes it for systems of n numbers. Allocates when n grows.
  void reserve(std::size_t n);

  /// Row i of n numbers, not cleared.
  std::span<double> row(int i, std::size_t n) { return {room_.data() + i * stride_, n}; }

 private:
  std::size_t stride_ = 0;
  std::vector<double> room_;
};

/// One step of length h from time t: d and v go in as they are at t and come out as they are at t + h.
/// Requires stages.reserve(d.size()).
using Integrate = void(System& system, double t, double h, std::span<double> d, std::span<double> v,
                       Stages& stages);

Integrate rk4;            ///< classical Runge-Kutta, order 4
Integrate midpoint;       ///< order 2
Integrate euler;          ///< explicit, order 1
Integrate semi_implicit;  ///< velocity first, order 1; holds the energy of an oscillator

/// The function behind a name of the model.
Integrate* integrate(Integrator which);

}  // namespace obscura::sim
