#pragma once

#include <limits>
#include <vector>

#include "sim/solve/cone/cone.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

/// An island of few contacts that iterations do not settle, as where something heavy stands on something
/// light, exactly:
///   w = K p + u,  of all contacts at once by their laws        u  how fast they pass without impulses
/// Rows: of each contact its normal, then those across it.
template <int D>
class ExactIsland {
 public:
  // with room for the most, so that no size allocates
  static constexpr int kMostRows = D * kFewSolved;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows> K;  // rows x rows, 1/kg
  Rows speeds, p;                    // m/s with the impulses p less what is wanted; N s
  std::vector<ConeBlock<D>> blocks;  // one a contact

  /// Room for the most that there may be.
  void reserve() { cone_.reserve(kFewSolved), blocks.reserve(kFewSolved), modes_.reserve(kFewSolved); }
  void resize(int contacts) {
    const int rows = D * contacts;
    K.resize(rows, rows), speeds.resize(rows), p.resize(rows), blocks.resize(std::size_t(contacts));
  }
  /// Replaces p. False where none is found.
  bool solve() {
    modes_.assign(blocks.size(), {});
    speeds -= K * p;
    cone_.patience = cone_.most_systems = kSolvedSystems;
    cone_.sweep(K, speeds, blocks, modes_, p, 1);
    return cone_.solve(K, speeds, blocks, modes_, p).found;
  }

 private:
  Cone<D> cone_;
  std::vector<ConeMode<D>> modes_;
};

}  // namespace obscura::sim
