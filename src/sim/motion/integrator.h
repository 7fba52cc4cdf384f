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

  /// Whether no force in them may set in or end within a step, as those of contacts, ropes and limits do.
  virtual bool smooth() const { return true; }
  /// Whether joints tie its bodies to each other.
  virtual bool tied() const { return false; }
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

/// Where velocities lie among the numbers v of a system: that of body b along axis k at first + b * body + k
/// * axis.
struct VelocityRows {
  std::size_t bodies, axes, body, axis, first = 0;
};

/// The rows of Stages where rk4 leaves v' of its four stages.
inline constexpr int kRk4Rates[] = {3, 5, 7, 9};

/// How long the last step of rk4(), of h (s), was for the forces. With k the stages' accelerations and |.|
/// the sum over the axes, of each body
///   error = h/6 |k1 - k2 - k3 + k4|      size = |v| + h |k2| + least
struct Roughness {
  double ratio =
      0;  // the largest error / size; of bodies far slower than the fastest a part of its size is added
  double error = 0;  // the largest error
  double pace = 0;   // the largest size
};
/// `v`: the numbers as they are now. `least`: below this, in units of v, errors do not count.
/// `tied`: they hang together, and errors count as against the fastest: what one that is slow errs by is
/// little beside what the others have.
Roughness roughness(const VelocityRows& rows, double h, std::span<const double> v, double least,
                    Stages& stages, bool tied = false);

/// Notes a step whose ratio is above 0.001. What goes round is so from h w = .3 on in every step, and an
/// oscillator in nearly half of them: Runge-Kutta then takes 1e-5 of its energy in a step. And whether it is
/// the wildest of all, unless the velocities are spins.
void note_roughness(LimitsMet& met, std::int64_t step, const Roughness& found, bool spins = false);

/// The function behind a name of the model.
Integrate* integrate(Integrator which);

}  // namespace obscura::sim
