#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/model/model.h"
#include "sim/model/state.h"

namespace obscura::sim {

/// A system of ordinary differential equations of first order. Its unknowns are v, the velocity, and d, the
/// displacement since the step began. Positions stay outside: x = x0 + d, an orientation is turned by d.
class System {
 public:
  virtual ~System() = default;

  /// d' and v' at time t (s), into d_rate and v_rate. All four have one length; none overlap.
  virtual void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
                     std::span<double> v_rate) = 0;

  /// Whether no force in them may set in or end within a step, as those of contacts and joints do.
  virtual bool smooth() const { return true; }
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

/// Where the velocities of bodies lie among the numbers v of a system: that of body b along axis k at
/// b * body + k * axis.
struct VelocityRows {
  std::size_t bodies, axes, body, axis;
};

/// How long the last step of rk4(), of h (s), was for the forces: the largest of all bodies of
///   h/6 |k1 - k2 - k3 + k4| / (|v| + h |k2| + least)
/// where k are the stages' accelerations and |.| sums over the axes. `v`: the numbers as they are now;
/// `least`: m/s, below which errors do not count. Of bodies far slower than the fastest, a part of its size
/// is added.
double roughness(const VelocityRows& rows, double h, std::span<const double> v, double least, Stages& stages);
/// Notes a step that is rough: from 0.001 on, for an oscillator of whose energy Runge-Kutta takes 1e-5 in a
/// step (h w = .3) nearly half of its steps, for what goes round so all; and one that is wild, in which a
/// force changed by as much as itself.
void note_roughness(LimitsMet& met, std::int64_t step, double roughness);

/// The function behind a name of the model.
Integrate* integrate(Integrator which);

}  // namespace obscura::sim
