// A small linear complementarity problem by enumeration (Cottle, Pang and Stone, 1992, §1).
//   w = A p + b,  p >= 0,  w >= 0,  p . w = 0
// A is a Gram matrix: w is unique, and some solution has at most rank(A) positive entries, on rows that are
// independent.

#include "sim/math/lcp.h"

#include <Eigen/QR>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kDependentPivot = 1e-11;  // a pivot this small beside its diagonal is rounding
constexpr double kSlack = 1e-12;           // of the largest term that went into a sum
constexpr double kLoosest = 1e-5;  // where rows all but depend on one another, their p is no better known

struct Active {
  int rows[kMostRows];
  int count = 0;
};

// A_SS p_S = -b_S by symmetric elimination; false where the rows of S depend on one another
bool balance(const Square& A, const SmallVector& b, const Active& active, SmallVector& p) {
  p.setZero();
  const int k = active.count;
  const int* r = active.rows;
  if (k == 0) return true;
  if (k == 1) {
    if (!(A(r[0], r[0]) > 0)) return false;
    p[r[0]] = -b[r[0]] / A(r[0], r[0]);
    return true;
  }
  if (k == 2) {
    // by determinants, which favour neither row: two corners that strike alike get the same impulse to the
    // bit
    const double a00 = A(r[0], r[0]), a11 = A(r[1], r[1]), a01 = A(r[0], r[1]);
    const double det = a00 * a11 - a01 * a01;
    if (!(det > kDependentPivot * a00 * a11)) return false;
    p[r[0]] = (b[r[1]] * a01 - b[r[0]] * a11) / det;
    p[r[1]] = (b[r[0]] * a01 - b[r[1]] * a00) / det;
    return true;
  }
  double m[kMostRows][kMostRows + 1];
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) m[i][j] = A(r[i], r[j]);
    m[i][k] = -b[r[i]];
  }
  for (int i = 0; i < k; ++i) {
    if (!(m[i][i] > kDependentPivot * A(r[i], r[i]))) return false;
    for (int j = i + 1; j < k; ++j) {
      const double f = m[j][i] / m[i][i];
      for (int c = i; c <= k; ++c) m[j][c] -= f * m[i][c];
    }
  }
  for (int i = k - 1; i >= 0; --i) {
    double sum = m[i][k];
    for (int j = i + 1; j < k; ++j) sum -= m[i][j] * p[r[j]];
    p[r[i]] = sum / m[i][i];
  }
  return true;
}

// p >= 0 and w >= 0 to rounding; sets numbers that are negative by rounding to zero
bool feasible(const Square& A, const SmallVector& b, double slack, SmallVector& p) {
  const double most = p.cwiseAbs().maxCoeff();
  for (int i = 0; i < p.size(); ++i) {
    if (p[i] < -slack * most) return false;
  }
  p = p.cwiseMax(0.0);
  for (int i = 0; i < p.size(); ++i) {
    const double scale = A.row(i).cwiseAbs().dot(p) + std::fabs(b[i]);
    if (A.row(i).dot(p) + b[i] < -slack * scale) return false;
  }
  return true;
}

// the next set of `count` rows out of n in lexical order
bool next(Active& active, int n) {
  for (int i = active.count - 1; i >= 0; --i) {
    if (active.rows[i] < n - active.count + i) {
      ++active.rows[i];
      for (int j = i + 1; j < active.count; ++j) active.rows[j] = active.rows[j - 1] + 1;
      return true;
    }
  }
  return false;
}

// spreads p over all rows that are active, with the least norm; leaves p where that would pull
void spread(const Square& A, const SmallVector& b, SmallVector& p) {
  Active active;
  for (int i = 0; i < p.size(); ++i) {
    const double scale = A.row(i).cwiseAbs().dot(p) + std::fabs(b[i]);
    if (std::fabs(A.row(i).dot(p) + b[i]) <= 1e3 * kSlack * scale) active.rows[active.count++] = i;
  }
  const int k = active.count;
  if (k < 2) return;
  Square part(k, k);
  SmallVector right(k);
  for (int i = 0; i < k; ++i) {
    for (int j = 0; j < k; ++j) part(i, j) = A(active.rows[i], active.rows[j]);
    right[i] = -b[active.rows[i]];
  }
  Eigen::CompleteOrthogonalDecomposition<Square> factors(k, k);
  factors.setThreshold(kDependentPivot);
  factors.compute(part);
  if (factors.rank() == k) return;
  const SmallVector least = factors.solve(right);
  SmallVector all = SmallVector::Zero(p.size());
  for (int i = 0; i < k; ++i) all[active.rows[i]] = least[i];
  if (feasible(A, b, kSlack, all)) p = all;
}

}  // namespace

bool solve_lcp(const Square& A, const SmallVector& b, int rank, SmallVector& p) {
  const int n = int(b.size());
  p = SmallVector::Zero(n);
  if (n == 0) return true;
  for (double slack = kSlack; slack <= kLoosest; slack *= 1e3) {
    for (int size = std::min(n, rank); size >= 0; --size) {
      Active active;
      active.count = size;
      for (int i = 0; i < size; ++i) active.rows[i] = i;
      do {
        if (balance(A, b, active, p) && feasible(A, b, slack, p)) {
          if (n > size) spread(A, b, p);
          return true;
        }
      } while (next(active, n));
    }
  }
  p.setZero();
  return false;
}

}  // namespace obscura::sim
