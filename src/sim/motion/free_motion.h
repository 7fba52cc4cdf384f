#pragma once

#include "sim/motion/integrator.h"

namespace obscura::sim {

// Bodies without springs and hands move freely: the centre under gravity and drag, the rotation without
// torque. A run of such bodies is integrated in blocks that fit the first cache, component by component, so
// that a body's motion does not depend on which others share its block.

/// Centres of free bodies: x' = v, v' = g - (c/m) v, on flat components.
class FreeTranslation final : public System {
 public:
  /// `gravity` and `drag` (c/m, 1/s) component by component, as long as the system; no drag where `drag` is
  /// empty.
  FreeTranslation(std::span<const double> gravity, std::span<const double> drag)
      : gravity_(gravity), drag_(drag) {}

  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;

 private:
  std::span<const double> gravity_, drag_;
};

/// Free turning, see sim/math/lie_step.h: in the plane the spin stays, in space it wobbles.
template <int D>
class TorqueFreeRotation final : public System {
 public:
  /// Principal moments (kg m^2) and base spins of the bodies of the system.
  TorqueFreeRotation(std::span<const AngularVec<D>> inertia, std::span<const AngularVec<D>> base)
      : inertia_(inertia), base_(base) {}

  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;

 private:
  std::span<const AngularVec<D>> inertia_, base_;
};

/// v_rate = gravity - drag v, on n components; the same for bodies with springs and without.
void unconstrained_rates(std::span<const double> gravity, std::span<const double> drag,
                         std::span<const double> v, std::span<double> v_rate);

/// A step of a free centre under gravity and drag, x' = v, v' = g + (z / h) v with z = -h c/m:
///   v := v + p v + h q g      x := x + h (u v + h r g)
/// by the polynomials in z of the integrator that the scene names.
struct FreeStep {
  double p = 0, q = 1, u = 1, r = 0.5;
};
inline FreeStep free_step(Integrator integrator, double z) {
  switch (integrator) {
    case Integrator::rk4: {
      if (z == 0) return {};
      const double q = 1 + z / 2 * (1 + z / 3 * (1 + z / 4));
      return {z * q, q, q, 0.5 * (1 + z / 3 * (1 + z / 4))};
    }
    case Integrator::midpoint:
      return {z * (1 + z / 2), 1 + z / 2, 1 + z / 2, 0.5};
    case Integrator::euler:
      return {z, 1, 1, 0};
    case Integrator::semi_implicit:
      return {z, 1, 1 + z, 1};
  }
  return {};
}

}  // namespace obscura::sim
