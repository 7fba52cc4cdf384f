#pragma once

#include <vector>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {

/// An impact of several contacts in one instant, with friction, all together, and with the ends of joints
/// that are reached there, taut ropes and limits, which only push:
///   w = K p + J v,   p_n >= 0,   w_n + e v_n >= 0,   p_n (w_n + e v_n) = 0,   p_t in Coulomb's cone
/// Before it what rests there holds what has pulled it since the step began: contacts that are too slow to
/// bounce, and ends, by the same laws with e = 0; J v is what that leaves. Newton's law can raise the energy,
/// with friction or where something already parts; then e is less, so that it does not. Rows: of each contact
/// its normal, then those across it; then one of each end.
template <int D>
class InstantImpact {
 public:
  /// The most contacts of one impact, and the most ends; so many of crowds, of more than kCrowd bodies; and
  /// so many that hang together are solved so whatever they cost.
  static constexpr int kMost = D == 2 ? 55 : 36, kMostEnds = 16, kMostOfCrowds = 16, kFew = D == 2 ? 8 : 16;
  static constexpr int kCrowd = 50;

  /// So many that hang together are solved so whatever strikes, of `bodies` in all: more of what is on
  /// joints, which blows pair after pair would bend.
  static constexpr int few(bool tied, int bodies) { return tied && bodies <= kCrowd ? kMost : kFew; }

  // with room for the most, so that no size allocates
  static constexpr int kMostRows = D * kMost + kMostEnds;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;

  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

  Matrix K;                          // rows x rows, 1/kg
  Rows speeds, p;                    // m/s before the impact; impulses, N s
  std::vector<ConeBlock<D>> blocks;  // one a contact, with its friction, and one an end
  std::vector<double> elasticity;    // one a contact
  std::vector<char> strikes;         // one a contact; 0: too slow to bounce
  bool driven = false;               // a belt, or what is moved, takes part

  /// Room for them; without friction and bounce.
  void resize(int contacts, int ends = 0);
  /// Finds p. False where no impulses are found.
  bool solve();
  /// Whether none were found as no impulses hold it: friction of what moves, as of a belt, wedges bodies in.
  bool jams() const { return jams_; }
  /// What of p has held what rests since the step began, N s.
  const Rows& rested() const { return rested_; }

 private:
  bool find(const Matrix& response, const Rows& speeds, const std::vector<ConeBlock<D>>& of, Rows& impulses);
  void rest();
  double rise() const;
  double attempt(double share);
  bool solve_without_bounce();

  bool jams_ = false;
  Rows b_, rested_, part_;
  Matrix rest_rows_;
  std::vector<int> resting_;  // rows
  std::vector<ConeBlock<D>> rest_blocks_;
  Cone<D> cone_;
  std::vector<ConeMode<D>> modes_;
};

}  // namespace obscura::sim
