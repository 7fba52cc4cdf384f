#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sim/vec.h"

namespace obscura::sim {

/// The tangential part of a contact: one component in the plane, two in space.
template <int D>
using Tangent = Eigen::Matrix<double, D - 1, 1>;

/// What a block of rows asks of its force f and of what it answers, w = K f + b.
enum class Law : std::uint8_t {
  equal,    // one row: w = 0, f free. Joints
  bounded,  // one row: lower <= f <= upper; w = 0 inside, w >= 0 at lower, w <= 0 at upper. Motors, limits
  contact   // D rows, normal first: f_n >= 0, w_n >= 0, f_n w_n = 0, and Coulomb's cone |f_t| <= mu f_n
};

/// How a block obeys its law.
enum class Hold : std::uint8_t {
  free,      // w = 0: equal, or bounded between its bounds
  at_lower,  // bounded: f = lower
  at_upper,  // bounded: f = upper
  open,      // contact: f = 0
  stick,     // contact: w = 0, f inside the cone
  brink,     // contact: on the cone's surface, f_t = -mu f_n d, and w = 0 all the same, as others hold it
  slide      // contact: w_n = 0, f_t = -mu f_n d
};

/// One block of rows. A block's rows follow those of the block before it.
template <int D>
struct ConeBlock {
  Law law = Law::contact;
  double lower = -std::numeric_limits<double>::infinity();  // bounded
  double upper = std::numeric_limits<double>::infinity();   // bounded
  double mu = 0;                                            // contact
  bool sliding = false;                       // contact: moves already, so f_t = -mu f_n d whatever w_t
  Tangent<D> direction = Tangent<D>::Zero();  // d where it is sliding: unit, of its tangential velocity

  int rows() const { return law == Law::contact ? D : 1; }
};

/// What a block does: its mode, and d of a contact on the cone's surface.
template <int D>
struct ConeMode {
  Hold hold = Hold::stick;
  Tangent<D> along = Tangent<D>::Zero();  // unit where hold is brink or slide: where it (would) slip to

  bool operator==(const ConeMode&) const = default;
};

/// What came of a solve.
struct ConeReport {
  bool found = false;   // all conditions hold to Cone::kTolerance
  double residual = 0;  // the worst violation, of the largest term in the row it is in
  int tries = 0;        // linear systems solved
};

/// Forces that obey joints, limits and Coulomb's cone, exactly: w = K f + b with one of the laws above a
/// block. K: n x n, symmetric, positive semidefinite, J M^-1 J^T; b: n, what the rows would do without f
/// (m/s^2, or m/s and then f are impulses). Where rows are redundant, of the forces that solve with the modes
/// found, those of least norm (each block weighed by its own response), so that what is symmetric stays so.
/// Sets of modes are guessed by Newton's method on slightly soft contacts and then solved as equalities,
/// after Baraff, "Fast contact force computation for nonpenetrating rigid bodies", 1994. Room is kept from
/// solve to solve; a warm one allocates nothing.
template <int D>
class Cone {
 public:
  /// What counts as solved: violations beside the largest term in their row.
  static constexpr double kTolerance = 1e-10;

  /// Answers w this small, in b's unit, are rounding: for rows whose every term is.
  double negligible = 0;

  /// Finds modes and f (n, out). `modes` is the first guess: one a block, those of the last step, or default
  /// ones. Without a solution (sliding contacts can have none: Painleve) found is false, modes and f are the
  /// best that was met, and the time it took is bounded. Never throws.
  ConeReport solve(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                   std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes,
                   Eigen::Ref<Eigen::VectorXd> f);

  /// f where the modes are known, as equalities; inequalities are not looked at: free and stick: w = 0; open:
  /// f = 0; slide and brink: w_n = 0, f_t = -mu f_n `along` (the mode's, not the block's); at a bound: f is
  /// the bound. The residual is that of the equalities; found is false where they contradict one another.
  ConeReport hold(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                  std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes,
                  Eigen::Ref<Eigen::VectorXd> f);

  /// K x = r on the rows `rows` (ascending), x = 0 elsewhere: the x of least norm, each row weighed by its
  /// own response; of least squares where the rows contradict one another, and then found is false.
  ConeReport least(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& r,
                   std::span<const int> rows, Eigen::Ref<Eigen::VectorXd> x);
};

}  // namespace obscura::sim
