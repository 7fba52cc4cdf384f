#pragma once

#include <vector>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {

/// An impact of several contacts in one instant, with friction, all together:
///   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   p_t in Coulomb's cone
/// Newton's law can raise the energy, with friction or where something already parts; then e is less, so that
/// it does not. Rows: of each contact its normal, then those across it.
template <int D>
class InstantImpact {
 public:
  /// The most contacts of one impact.
  static constexpr int kMost = 8;
  /// Where joints leave a push less than this of what it moves without them, it moves nothing.
  static constexpr double kLockedPush = 1e-9;

  // with room for the most, so that no size allocates
  static constexpr int kMostRows = D * kMost;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows> K;  // rows x rows, 1/kg
  Rows speeds, p;                    // m/s before the impact; impulses, N s
  std::vector<ConeBlock<D>> blocks;  // one a contact, with its friction
  std::vector<double> elasticity;    // one a contact; 0: too slow to bounce

  void resize(int contacts);
  /// Finds p. False where no impulses are found.
  bool solve();

 private:
  double rise() const;
  double attempt(double share);

  Rows b_;
  Cone<D> cone_;
  std::vector<ConeMode<D>> modes_;
};

}  // namespace obscura::sim
