// Pseudo-inverse by factors of full rank.
//   A = F d G        F: n x r with independent columns, G: r x n with independent rows, d diagonal
//   A^+ = G^T (G G^T)^-1 d^-1 (F^T F)^-1 F^T
// Pivots are the largest entry left, so entries of F and G stay within 1, and d carries all of A's condition.
// Source: Ben-Israel and Greville, Generalized Inverses (2003), full-rank factorization.

#include "sim/math/full_rank.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kAlike = 1e-10;  // of a column's square, what others may leave of it at least

// y += a x
void add(int n, double a, const double* __restrict x, double* __restrict y) {
  for (int i = 0; i < n; ++i) y[i] += a * x[i];
}

// y += X a for the columns of X where a is not zero, four at a time
void add_columns(int n, int count, const double* X, const double* a, int* some, double* __restrict y) {
  int k = 0;
  for (int j = 0; j < count; ++j) {
    if (a[j] != 0) some[k++] = j;
  }
  int j = 0;
  for (; j + 4 <= k; j += 4) {
    const double* __restrict x0 = X + std::size_t(some[j]) * n;
    const double* __restrict x1 = X + std::size_t(some[j + 1]) * n;
    const double* __restrict x2 = X + std::size_t(some[j + 2]) * n;
    const double* __restrict x3 = X + std::size_t(some[j + 3]) * n;
    const double a0 = a[some[j]], a1 = a[some[j + 1]], a2 = a[some[j + 2]], a3 = a[some[j + 3]];
    for (int i = 0; i < n; ++i) y[i] += (a0 * x0[i] + a1 * x1[i]) + (a2 * x2[i] + a3 * x3[i]);
  }
  for (; j < k; ++j) add(n, a[some[j]], X + std::size_t(some[j]) * n, y);
}

double dot(int n, const double* x, const double* y) {
  double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    s0 += x[i] * y[i], s1 += x[i + 1] * y[i + 1], s2 += x[i + 2] * y[i + 2], s3 += x[i + 3] * y[i + 3];
  }
  for (; i < n; ++i) s0 += x[i] * y[i];
  return (s0 + s1) + (s2 + s3);
}

// out = X^T y for `count` columns of X
void dots(int n, const double* y, const double* X, int count, double* out) {
  int j = 0;
  for (; j + 4 <= count; j += 4) {
    const double *x0 = X + std::size_t(j) * n, *x1 = x0 + n, *x2 = x1 + n, *x3 = x2 + n;
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (int i = 0; i < n; ++i)
      s0 += y[i] * x0[i], s1 += y[i] * x1[i], s2 += y[i] * x2[i], s3 += y[i] * x3[i];
    out[j] = s0, out[j + 1] = s1, out[j + 2] = s2, out[j + 3] = s3;
  }
  for (; j < count; ++j) out[j] = dot(n, y, X + std::size_t(j) * n);
}

// the lower Cholesky factor of X^T X, r x r; X: n x r. False where columns all but depend on one another.
bool factor_gram(int n, int r, const double* X, std::vector<double>& out) {
  out.resize(std::size_t(r) * r);
  double* const c = out.data();
  for (int k = 0; k < r; ++k) {
    const double* const xk = X + std::size_t(k) * n;
    dots(n, xk, xk, r - k, c + std::size_t(k) * r + k);
  }
  for (int k = 0; k < r; ++k) {
    double* ck = c + std::size_t(k) * r;
    for (int j = 0; j < k; ++j) {
      const double* cj = c + std::size_t(j) * r;
      if (cj[k] != 0) add(r - k, -cj[k], cj + k, ck + k);
    }
    const double* xk = X + std::size_t(k) * n;
    if (!(ck[k] > kAlike * dot(n, xk, xk))) return false;
    const double root = std::sqrt(ck[k]);
    for (int i = k; i < r; ++i) ck[i] /= root;
  }
  return true;
}

// x = (C C^T)^-1 x
void solve_gram(int r, const std::vector<double>& C, double* x) {
  for (int k = 0; k < r; ++k) {
    const double* c = C.data() + std::size_t(k) * r;
    x[k] /= c[k];
    add(r - k - 1, -x[k], c + k + 1, x + k + 1);
  }
  for (int k = r - 1; k >= 0; --k) {
    const double* c = C.data() + std::size_t(k) * r;
    x[k] = (x[k] - dot(r - k - 1, c + k + 1, x + k + 1)) / c[k];
  }
}

}  // namespace

void FullRank::symmetric(std::span<const double> A, int n, double tolerance) {
  kind_ = Kind::symmetric;
  factor(A, n, n, tolerance);
  if (rank_ < n) factor_gram(n, rank_, f_.data(), ff_);
}

void FullRank::reserve(int n) {
  const auto many = std::size_t(n);
  for (auto* square : {&f_, &g_, &ff_, &gg_, &lu_}) square->reserve(many * many);
  for (auto* numbers : {&rows_, &cols_, &swaps_, &open_, &top_}) numbers->reserve(many);
  d_.reserve(many), left_.reserve(many), t_.reserve(2 * many);
}

// the first n rows hold the pivots
void FullRank::factor(std::span<const double> B, int all, int n, double tolerance) {
  n_ = n, rank_ = 0;
  f_.resize(std::size_t(all) * n), d_.resize(n), rows_.resize(n), left_.resize(n), t_.resize(2 * n);
  open_.resize(n);
  for (int i = 0; i < n; ++i) left_[i] = B[std::size_t(i) * all + i];

  double least = 0;
  for (int k = 0; k < n; ++k) {
    // the largest pivot left; the first of equals
    int p = 0;
    for (int i = 1; i < n; ++i) {
      if (left_[i] > left_[p]) p = i;
    }
    if (k == 0) least = tolerance * left_[p];
    if (!(left_[p] > least)) break;

    // its column, less what the columns before it explain
    double* const c = f_.data() + std::size_t(k) * all;
    std::copy_n(B.data() + std::size_t(p) * all, all, c);
    for (int j = 0; j < k; ++j) t_[j] = -d_[j] * f_[std::size_t(j) * all + p];
    add_columns(all, k, f_.data(), t_.data(), open_.data(), c);
    const double pivot = c[p];
    if (!(pivot > least)) {
      left_[p] = 0, --k;  // its diagonal had drifted by rounding
      continue;
    }
    for (int j = 0; j < k; ++j) c[rows_[j]] = 0;
    for (int i = 0; i < all; ++i) c[i] /= pivot;
    c[p] = 1;
    for (int i = 0; i < n; ++i) left_[i] -= pivot * c[i] * c[i];
    left_[p] = 0;
    d_[k] = pivot, rows_[k] = p, rank_ = k + 1;
  }
}

void FullRank::general(std::span<double> A, int n, double tolerance) {
  n_ = n, rank_ = 0, kind_ = Kind::general;
  f_.resize(std::size_t(n) * n), g_.resize(std::size_t(n) * n);
  d_.resize(n), rows_.resize(n), cols_.resize(n), t_.resize(2 * n), open_.resize(n), top_.resize(n);
  const auto at = [&](int row, int col) -> double& { return A[std::size_t(col) * n + row]; };
  const auto climb = [&](int col) {
    int top = 0;
    for (int i = 1; i < n; ++i) {
      if (std::fabs(at(i, col)) > std::fabs(at(top, col))) top = i;
    }
    top_[col] = top;
  };
  for (int j = 0; j < n; ++j) open_[j] = j, climb(j);

  double least = 0;
  for (int k = 0; k < n; ++k) {
    // the largest entry left; the first of equals
    int q = 0;
    for (int j = 1; j < n - k; ++j) {
      if (std::fabs(at(top_[open_[j]], open_[j])) > std::fabs(at(top_[open_[q]], open_[q]))) q = j;
    }
    const int col = open_[q], row = top_[col];
    const double pivot = at(row, col);
    if (k == 0) least = tolerance * std::fabs(pivot);
    if (!(std::fabs(pivot) > least)) break;

    double* const f = f_.data() + std::size_t(k) * n;
    double* const g = g_.data() + std::size_t(k) * n;
    for (int i = 0; i < n; ++i) f[i] = at(i, col) / pivot;
    std::fill_n(g, n, 0.0);
    for (int j = 0; j < n - k; ++j) g[open_[j]] = at(row, open_[j]) / pivot;
    f[row] = 1, g[col] = 1;
    open_.erase(open_.begin() + q);
    open_.push_back(col);
    for (int j = 0; j < n - k - 1; ++j) {
      const int c = open_[j];
      if (g[c] == 0) continue;
      add(n, -pivot * g[c], f, A.data() + std::size_t(c) * n);
      at(row, c) = 0;
      climb(c);
    }
    d_[k] = pivot, rows_[k] = row, cols_[k] = col, rank_ = k + 1;
  }
  if (rank_ == n_) return;
  factor_gram(n_, rank_, f_.data(), ff_);
  factor_gram(n_, rank_, g_.data(), gg_);
}

bool FullRank::leaning(std::span<const double> B, int all, int n, std::span<const int> to,
                       std::span<const double> share, double tolerance) {
  kind_ = Kind::leaning;
  factor(B, all, n, tolerance);
  const int r = rank_;
  g_.resize(std::size_t(n) * n);
  for (int k = 0; k < r; ++k) {
    const double* const b = f_.data() + std::size_t(k) * all;
    double* const f = f_.data() + std::size_t(k) * n;
    double* const g = g_.data() + std::size_t(k) * n;
    std::copy_n(b, n, g);
    for (int j = n; j < all; ++j) g[to[j - n]] += share[j - n] * b[j];
    std::copy(b, b + n, f);  // closer together, front to back
  }
  if (r < n && !factor_gram(n, r, f_.data(), ff_)) return false;
  lu_.resize(std::size_t(r) * r), swaps_.resize(r);
  for (int k = 0; k < r; ++k)
    dots(n, f_.data() + std::size_t(k) * n, g_.data(), r, lu_.data() + std::size_t(k) * r);
  return eliminate(lu_, r, kAlike, swaps_);
}

bool FullRank::definite(std::span<const double> A, int n, double least) {
  lu_.assign(A.begin(), A.begin() + std::ptrdiff_t(n) * n);
  for (int k = 0; k < n; ++k) {
    double* const c = lu_.data() + std::size_t(k) * n;
    if (!(c[k] > least)) return false;
    const double root = std::sqrt(c[k]);
    for (int i = k; i < n; ++i) c[i] /= root;
    for (int j = k + 1; j < n; ++j) {
      if (c[j] != 0) add(n - j, -c[j], c + j, lu_.data() + std::size_t(j) * n + j);
    }
  }
  n_ = rank_ = n, kind_ = Kind::definite;
  return true;
}

bool FullRank::regular(std::span<const double> A, int n, double least) {
  lu_.assign(A.begin(), A.begin() + std::ptrdiff_t(n) * n), swaps_.resize(n);
  if (!eliminate(lu_, n, least, swaps_)) return false;
  n_ = rank_ = n, kind_ = Kind::regular;
  return true;
}

void FullRank::solve(std::span<const double> r, std::span<double> x) {
  if (kind_ == Kind::definite || kind_ == Kind::regular) {
    if (x.data() != r.data()) std::copy_n(r.data(), n_, x.data());
    kind_ == Kind::definite ? solve_gram(n_, lu_, x.data()) : substitute(lu_, n_, swaps_, x);
    return;
  }
  // F's part
  const int n = n_;
  double* const t = t_.data();
  if (rank_ == n) {
    double* const left = t + n;
    std::copy_n(r.data(), n, left);
    for (int k = 0; k < n; ++k) {
      t[k] = left[rows_[k]];
      add(n, -t[k], f_.data() + std::size_t(k) * n, left);
    }
  } else {
    for (int k = 0; k < rank_; ++k) t[k] = dot(n, f_.data() + std::size_t(k) * n, r.data());
    solve_gram(rank_, ff_, t);
  }
  for (int k = 0; k < rank_; ++k) t[k] /= d_[k];

  // G's part
  std::fill_n(x.data(), n, 0.0);
  if (kind_ == Kind::leaning) {
    substitute(lu_, rank_, swaps_, {t, std::size_t(rank_)});
    for (int k = 0; k < rank_; ++k) add(n, t[k], f_.data() + std::size_t(k) * n, x.data());
    return;
  }
  const std::vector<double>& g = kind_ == Kind::symmetric ? f_ : g_;
  if (rank_ == n) {
    const std::vector<int>& cols = kind_ == Kind::symmetric ? rows_ : cols_;
    for (int k = n - 1; k >= 0; --k) x[cols[k]] = t[k] - dot(n, g.data() + std::size_t(k) * n, x.data());
  } else {
    solve_gram(rank_, kind_ == Kind::symmetric ? ff_ : gg_, t);
    for (int k = 0; k < rank_; ++k) add(n, t[k], g.data() + std::size_t(k) * n, x.data());
  }
}

// column by column, by all before it: four at a time, each entry less one product after another
bool eliminate(std::span<double> A, int n, double tolerance, std::span<int> swaps) {
  double most = 0;
  for (const double a : A.first(std::size_t(n) * n)) most = std::max(most, std::fabs(a));
  const auto column = [&](int k) { return A.data() + std::size_t(k) * n; };
  for (int j = 0; j < n; ++j) {
    double* __restrict const c = column(j);
    for (int k = 0; k < j; ++k) std::swap(c[k], c[swaps[k]]);
    int k = 0;
    for (; k + 4 <= j; k += 4) {
      const double* __restrict const l0 = column(k);
      const double* __restrict const l1 = column(k + 1);
      const double* __restrict const l2 = column(k + 2);
      const double* __restrict const l3 = column(k + 3);
      const double u0 = c[k];
      const double u1 = c[k + 1] -= u0 * l0[k + 1];
      const double u2 = c[k + 2] = (c[k + 2] - u0 * l0[k + 2]) - u1 * l1[k + 2];
      const double u3 = c[k + 3] = ((c[k + 3] - u0 * l0[k + 3]) - u1 * l1[k + 3]) - u2 * l2[k + 3];
      if (u0 == 0 && u1 == 0 && u2 == 0 && u3 == 0) continue;
      for (int i = k + 4; i < n; ++i) c[i] = (((c[i] - u0 * l0[i]) - u1 * l1[i]) - u2 * l2[i]) - u3 * l3[i];
    }
    for (; k < j; ++k) {
      if (c[k] != 0) add(n - k - 1, -c[k], column(k) + k + 1, c + k + 1);
    }

    int p = j;
    for (int i = j + 1; i < n; ++i) {
      if (std::fabs(c[i]) > std::fabs(c[p])) p = i;
    }
    if (!(std::fabs(c[p]) > tolerance * most)) return false;
    swaps[j] = p;
    for (int i = 0; i <= j && p != j; ++i) std::swap(column(i)[p], column(i)[j]);
    for (int i = j + 1; i < n; ++i) c[i] /= c[j];
  }
  return true;
}

void substitute(std::span<const double> A, int n, std::span<const int> swaps, std::span<double> x) {
  for (int k = 0; k < n; ++k) std::swap(x[k], x[swaps[k]]);
  for (int k = 0; k < n; ++k) add(n - k - 1, -x[k], A.data() + std::size_t(k) * n + k + 1, x.data() + k + 1);
  for (int k = n - 1; k >= 0; --k) {
    x[k] /= A[std::size_t(k) * n + k];
    add(k, -x[k], A.data() + std::size_t(k) * n, x.data());
  }
}

}  // namespace obscura::sim
