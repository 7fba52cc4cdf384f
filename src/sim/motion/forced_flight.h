#pragma once

#include <span>
#include <vector>

#include "sim/force/close_passages.h"
#include "sim/force/flying_forces.h"
#include "sim/model/state.h"
#include "sim/motion/integrator.h"

namespace obscura::sim {

/// Centres of bodies that fly (sim/force/flying_forces.h): x' = v, v' = g - (c/m) v + f/m. They are stepped
/// in blocks that fit the first cache, by rows: all x, then all y. A body's motion does not depend on which
/// others share its block.
template <int D>
class ForcedFlight final : public System {
 public:
  /// How many bodies a block has at most.
  static constexpr int kMost = 128;

  /// Both are kept by reference.
  ForcedFlight(const Model<D>& model, FlyingForces<D>& forces);

  /// One step of h (s) from time t (s) of `count` bodies, at most kMost, from body `first` on; of a body that
  /// passes an attractor closely, in pieces. Answers what the forces that are booked did in it, J, by the
  /// scheme's own quadrature. Throws NotFinite.
  double step(Integrate* integrate, State<D>& state, int first, int count, double t, double h,
              Stages& stages);

 private:
  double piece(Integrate* integrate, State<D>& state, int first, int count, double t, double h,
               Stages& stages);
  void rates(double t, std::span<const double> d, std::span<const double> v, std::span<double> d_rate,
             std::span<double> v_rate) override;

  const Model<D>& model_;
  FlyingForces<D>& forces_;
  ClosePassages<D> passages_;
  std::vector<double> drag_;  // c/m, 1/s, one a body; empty where there is none
  int first_ = 0, count_ = 0, stage_ = 0;
  double powers_[4] = {};
  std::vector<double> x_, d_, v_;  // rows
};

}  // namespace obscura::sim
