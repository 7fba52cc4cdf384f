#pragma once

#include <span>
#include <vector>

#include "sim/math/full_rank.h"
#include "sim/solve/cone/cone_law.h"

namespace obscura::sim {

/// A pivot this small beside the first is rounding.
inline constexpr double kDependent = 1e-11;

/// Guesses the modes by solving soft rows: f = -w / softness, projected onto its law. Rows are scaled so that
/// the largest K_ii of each block is 1. Works in the space of independent motions, whose dimension is less
/// than the number of rows if rows are redundant.
template <int D>
class ConeGuess {
 public:
  /// Room for so many contacts.
  void reserve(int contacts);

  /// K: n x n, scaled, column by column; b: n; first: the row of each block; sigma: f = sigma * scaled f.
  /// Kept by reference until the next begin.
  void begin(std::span<const double> K, std::span<const double> b, std::span<const ConeBlock<D>> blocks,
             std::span<const int> first, std::span<const double> sigma);

  /// Modes of the rows of this softness, one a block. Starts from the solution of the last call. If Newton's
  /// method fails, `follow` lets it approach the softness by continuation, in steps. False if that fails too:
  /// the modes are then those of the last softness that was solved.
  bool guess(double softness, std::span<ConeMode<D>> modes, bool follow = true);

  /// Linear systems solved since begin().
  int systems() const { return systems_; }

 private:
  using VecD = Eigen::Matrix<double, D, 1>;
  using SquareD = Eigen::Matrix<double, D, D>;
  enum class Friction { associated, coulomb };

  bool newton(double softness, Friction friction, int iterations);
  double evaluate(double softness, Friction friction, std::span<const double> u);
  double law(int block, double softness, Friction friction, const double* w, VecD& f, SquareD& slope) const;
  double stiffen(double softness);
  bool step(double softness);
  void modes(double softness, std::span<ConeMode<D>> modes) const;

  int n_ = 0, r_ = 0, systems_ = 0;
  std::span<const double> b_, sigma_;
  std::span<const ConeBlock<D>> blocks_;
  std::span<const int> first_;
  FullRank factors_;
  std::vector<double> L_;                      // r x n: K = L^T L, one column a row of K
  std::vector<double> u_, w_, f_;              // L f, answers, forces
  std::vector<double> F_, du_, tried_, kept_;  // u - L f(u), step, u tried, u to come back to
  std::vector<SquareD> slopes_, built_;        // df/dy a block; those H_ was built with
  std::vector<double> H_, work_;               // sum of L slope L^T
  std::vector<double> shift_;  // a row: mu |w_t| on normals, friction on those that slide already
  std::vector<int> swaps_;
  bool fresh_ = true;
};

}  // namespace obscura::sim
