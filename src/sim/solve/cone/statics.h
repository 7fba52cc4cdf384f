#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/constraint/mobility.h"
#include "sim/constraint/response.h"
#include "sim/math/orientation.h"
#include "sim/model/model.h"
#include "sim/solve/cone/cone.h"

namespace obscura::sim {

/// Forces under which an island stays at rest, exactly: one cone complementarity problem of all its contacts.
/// Iterations would take long to find those of an arch.
template <int D>
class Statics {
 public:
  /// The most contacts of an island.
  static constexpr int kMost = 250;

  explicit Statics(const Model<D>& model);

  /// `touches`: all contacts of an island, with their forces (out). `turns`: of all bodies, room from body.
  /// False (and the forces mean nothing) if a body would accelerate by more than 1e-9 of gravity, or if no
  /// forces were found.
  bool in_equilibrium(std::vector<BearingContact<D>>& touches, const std::vector<Rotation<D>>& turns);

 private:
  using Way = typename Side<D>::Way;

  const Model<D>& model_;
  Cone<D> cone_;
  std::vector<int> columns_, bodies_;  // of a body; of the columns
  std::vector<std::array<Side<D>, 2>> rows_;
  std::vector<Way> rates_;  // m/s^2, rad/s^2
  std::vector<ConeBlock<D>> blocks_;
  std::vector<ConeMode<D>> modes_;
  Eigen::MatrixXd K_;
  Eigen::VectorXd b_, f_;
};

}  // namespace obscura::sim
