#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/cone.h"
#include "sim/model.h"
#include "sim/state.h"

namespace obscura::sim::sweep {

/// Forces under which an island stays at rest, exactly: all its touches as one problem of cones. Sweeps take
/// long to find those of an arch.
class Statics {
 public:
  /// Touches of an island, at most.
  static constexpr int kMost = 100;

  explicit Statics(const Model<2>& model);

  struct Touch {
    int contact = 0;  // in state.contacts; its normal and point are where the touch is now
    double friction = 0;
  };

  /// Writes the forces (N) into the contacts of the touches where none of the bodies that `free` says
  /// accelerates by more than 1e-9 of gravity; else returns false and writes nothing.
  bool hold(State<2>& state, const std::vector<Touch>& touches, const std::vector<char>& free);

 private:
  // what a row pushes on one of its bodies, over the root of its mass
  struct Side {
    int column = -1;
    Vec3 push = Vec3::Zero();
  };

  const Model<2>& model_;
  Cone<2> cone_;
  std::vector<int> columns_, bodies_;  // of a body; of the columns
  std::vector<std::array<Side, 2>> rows_;
  std::vector<Vec3> a_;  // times the root of the mass
  std::vector<ConeBlock<2>> blocks_;
  std::vector<ConeMode<2>> modes_;
  Eigen::MatrixXd K_;
  Eigen::VectorXd b_, f_;
};

}  // namespace obscura::sim::sweep
