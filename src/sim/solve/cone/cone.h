#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "sim/math/full_rank.h"
#include "sim/solve/cone/cone_law.h"
#include "sim/solve/cone/cone_newton.h"

namespace obscura::sim {

/// The outcome of a solve.
struct ConeReport {
  bool found = false;   // all conditions hold to Cone::kTolerance
  double residual = 0;  // the worst violation, of the largest term in the row it is in
  int tries = 0;        // linear systems solved
};

/// Forces that obey joints, limits and Coulomb's cone, exactly: w = K f + b with one of the laws above a
/// block. K: n x n, symmetric, positive semidefinite, J M^-1 J^T; b: n, what the rows would do without f
/// (m/s^2, or m/s and then f are impulses).
/// Sets of modes are guessed by Newton's method on slightly soft contacts and then solved as equalities,
/// after Baraff, "Fast contact force computation for nonpenetrating rigid bodies", 1994. Redundant rows leave
/// f undetermined. Then f is the one of least norm, each block weighed by its own response; if some contacts
/// are on their cones, it is the limit of f for contacts that get ever less soft. Either way symmetric
/// problems have symmetric solutions. Memory is kept from solve to solve; a solve of the same size allocates
/// nothing.
template <int D>
class Cone {
 public:
  /// The tolerance: violations relative to the largest term in their row.
  static constexpr double kTolerance = 1e-10;

  /// Whether a solve tries all strategies before it gives up, however long that takes.
  bool thorough = true;

  /// A residual above kTolerance that is accepted if no strategy finds a smaller one.
  double enough = kTolerance;

  /// After so many linear systems a solve starts no further strategy, and after so many it gives up.
  int patience = std::numeric_limits<int>::max(), most_systems = std::numeric_limits<int>::max();

  /// Responses w this small, in b's unit, count as zero: for rows all of whose terms are rounding errors.
  double negligible = 0;

  /// Room for problems of so many contacts, so that none of these allocates.
  void reserve(int contacts);

  /// Finds modes and f (n). `modes` is the first guess: one a block, those of the last step, or default
  /// ones; so is f: forces of the last step, or zeros. Without a solution (sliding contacts can have none:
  /// Painleve) found is false, modes and f are the best that was met, and the time it took is bounded. Never
  /// throws.
  ConeReport solve(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                   std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes,
                   Eigen::Ref<Eigen::VectorXd> f);

  /// Approximate forces by projected Gauss-Seidel from those in `f`: at most `sweeps` sweeps over the rows,
  /// fewer if nothing changes. `modes` (out) are those at the end.
  void sweep(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
             std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes,
             Eigen::Ref<Eigen::VectorXd> f, int sweeps);

  /// f where the modes are known. Each mode is a set of equalities; inequalities are ignored:
  ///   free, stick                 w = 0
  ///   open                        f = 0
  ///   slide, at_friction_limit    w_n = 0, f_t = -mu f_n `along` (the mode's, not the block's)
  ///   at a bound                  f is the bound
  /// The residual is that of the equalities; found is false where they contradict one another.
  ConeReport solve_modes(const Eigen::Ref<const Eigen::MatrixXd>& K,
                         const Eigen::Ref<const Eigen::VectorXd>& b, std::span<const ConeBlock<D>> blocks,
                         std::span<const ConeMode<D>> modes, Eigen::Ref<Eigen::VectorXd> f);

  /// K x = r on the rows `rows` (ascending), x = 0 elsewhere: the x of least norm, each row weighed by its
  /// own response; the least-squares solution if rows contradict one another, and then found is false.
  ConeReport least(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& r,
                   std::span<const int> rows, Eigen::Ref<Eigen::VectorXd> x);

 private:
  using Modes = std::vector<ConeMode<D>>;

  // one unknown of the equalities: a force on a row, along a contact's slide, or a turn of that slide
  struct Unknown {
    enum class Kind : char { row, cone, turn } kind;
    int row, block;
  };

  void scale(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
             std::span<const ConeBlock<D>> blocks);
  bool attempt(std::span<const ConeBlock<D>> blocks, int switches);
  bool enumerate(std::span<const ConeBlock<D>> blocks);
  bool search(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
              std::span<const ConeBlock<D>> blocks, Eigen::Ref<Eigen::VectorXd> f);

  // cone_equalities.cpp: modes as equalities
  void balance(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes);
  bool turn(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes);
  void start(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes);
  void gather(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes, bool turning);
  void factor_symmetric();
  void lay_leaning(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes, bool turning);
  bool factor_leaning(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes);
  void refine(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes);
  void answer();
  double misfit() const;
  double contradiction(std::span<const ConeBlock<D>> blocks);

  // cone_residual.cpp: the laws looked at
  double check(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes);
  double check(const ConeBlock<D>& block, const ConeMode<D>& mode, int row, ConeMode<D>& better) const;

  int n_ = 0, tries_ = 0;
  std::vector<int> first_;             // row of each block
  std::vector<double> sigma_, K_, b_;  // K_ = sigma K sigma, b_ = sigma b: no K_ii over 1
  std::vector<double> g_, w_, size_;   // f = sigma g; w = K_ g + b_; the largest terms of w
  FullRank factors_;
  std::vector<Unknown> unknowns_;
  std::vector<double> A_, x_;  // of the equalities
  std::vector<int> rows_, to_;
  std::vector<double> share_;
  Modes trial_, better_, best_;
  std::vector<double> wrong_;  // violation, one a block
  std::vector<double> best_g_;
  double best_residual_ = 0;
  std::vector<std::uint64_t> seen_;  // sets of modes tried
  ConeGuess<D> guess_;
  std::vector<int> starts_, places_;  // of K's columns: what is not zero
  std::vector<double> entries_, begun_;
};

}  // namespace obscura::sim
