#pragma once

#include <Eigen/Core>

namespace obscura::sim {

/// The most rows a small complementarity problem has.
inline constexpr int kMostRows = 16;

/// Matrices and vectors of up to kMostRows rows, on the stack.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostRows, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostRows, kMostRows>;

/// p >= 0 with A p + b >= 0 and p . (A p + b) = 0, by trying sets of active rows, exactly to rounding. A: n x
/// n, symmetric, positive semidefinite, of rank at most `rank`. Where rows are redundant, the p of least norm
/// if that is positive. False (and p = 0) where there is none.
bool solve_lcp(const Square& A, const SmallVector& b, int rank, SmallVector& p);

}  // namespace obscura::sim
