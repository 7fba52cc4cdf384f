#pragma once

#include <span>
#include <vector>

namespace obscura::sim {

/// A square matrix as a product of factors of full rank, A = F diag(d) G, where rows may depend on one
/// another, and its pseudo-inverse. Matrices lie column by column. Grows only: a warm one allocates nothing.
class FullRank {
 public:
  /// Room for matrices of n x n, and of leaning ones of as many rows in all.
  void reserve(int n);

  /// A: n x n, symmetric, positive semidefinite; G = F^T. By Cholesky's method with diagonal pivots; the
  /// remainder counts as zero once no pivot exceeds `tolerance` of the first.
  void symmetric(std::span<const double> A, int n, double tolerance);

  /// A: n x n, any; overwritten. By elimination with complete pivoting; tolerance as above.
  void general(std::span<double> A, int n, double tolerance);

  /// For sliding contacts, whose friction is tied to their normal force by f_t = -mu f_n d: unsymmetric,
  ///   A = E B (E + T share)^T
  /// B: all x all, symmetric, positive semidefinite, of the n normal (and other free) rows first, then of the
  /// friction rows. E selects the first n rows, T the others; friction row j has `share[j]` times the force
  /// of row `to[j]`. Then solve() gives the x in the span of A, which is the limit of (A + eps)^-1 r: the
  /// solution for slightly soft rows. False, and nothing is factorised, if the limit does not exist; then
  /// call general().
  bool leaning(std::span<const double> B, int all, int n, std::span<const int> to,
               std::span<const double> share, double tolerance);

  /// A: n x n, symmetric, positive definite, its diagonal no larger than 1: without pivoting, so that zeros
  /// stay zeros. False, and nothing else, where a pivot is below `least`.
  bool definite(std::span<const double> A, int n, double least);

  /// A: n x n, any; by elimination with row pivoting. False, and nothing else, where a pivot is below `least`
  /// of the largest entry.
  bool regular(std::span<const double> A, int n, double least);

  int rank() const { return rank_; }

  /// Column k of F, n numbers: 1 in the row of pivot k, no number larger.
  std::span<const double> column(int k) const { return {f_.data() + std::size_t(k) * n_, std::size_t(n_)}; }

  /// Pivot k.
  double pivot(int k) const { return d_[k]; }

  /// x = A^+ r: the least-squares solution of least norm. n numbers each; `x` may be `r`.
  void solve(std::span<const double> r, std::span<double> x);

 private:
  enum class Kind : char { symmetric, general, leaning, definite, regular };

  void factor(std::span<const double> B, int all, int n, double tolerance);

  int n_ = 0, rank_ = 0;
  Kind kind_ = Kind::symmetric;
  std::vector<double> f_, g_;     // n x rank, G^T in the second
  std::vector<double> d_;         // pivots
  std::vector<int> rows_, cols_;  // of the pivots
  std::vector<double> ff_, gg_;   // Cholesky factors of F^T F and G G^T, where they are not triangular
  std::vector<double> lu_;        // G F of a leaning one, eliminated; Cholesky's factor of a definite one
  std::vector<int> swaps_;
  std::vector<double> left_, t_;  // scratch
  std::vector<int> open_;         // columns without a pivot
  std::vector<int> top_;          // in each column, the row of its largest
};

/// Eliminates a dense A in place with row pivoting. A: n x n, column by column; swaps: n. False where a pivot
/// is no more than `tolerance` of the largest entry in its column at the start.
bool eliminate(std::span<double> A, int n, double tolerance, std::span<int> swaps);

/// x = A^-1 x of an eliminated A.
void substitute(std::span<const double> A, int n, std::span<const int> swaps, std::span<double> x);

}  // namespace obscura::sim
