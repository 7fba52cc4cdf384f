// The equality solve: forces of given modes.
//   E (K S x + K f0 + b) = 0      E: rows with zero response; S: the force of each unknown; f0: at bounds
// A row that may push either way is an unknown by itself; a contact on its cone pushes along n - mu d. Then K
// between rows and unknowns is no longer symmetric. In space d is unknown too if a contact slips from rest:
// its angle joins the unknowns, and a zero component of the response w_t across d joins the rows (Newton).

#include <algorithm>
#include <cmath>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {

namespace {

constexpr double kLargestTurn = 0.5;  // of a slip's direction at once, rad
constexpr int kRefinements = 3;
constexpr double kSafe = 1e-5;  // no pivot is so small where rows are far from dependent

bool on_cone(ModeKind kind) { return kind == ModeKind::slide || kind == ModeKind::at_friction_limit; }

// a quarter turn
Eigen::Matrix<double, 1, 1> across(const Eigen::Matrix<double, 1, 1>&) {
  return Eigen::Matrix<double, 1, 1>::Zero();
}
Eigen::Vector2d across(const Eigen::Vector2d& d) { return {-d.y(), d.x()}; }

}  // namespace

// w and the largest terms that go into it
template <int D>
void Cone<D>::answer() {
  std::copy(b_.begin(), b_.end(), w_.begin());
  for (int i = 0; i < n_; ++i) size_[i] = std::fabs(b_[i]);
  // by two columns at once, each in its turn
  const auto next = [&](int j) {
    while (j < n_ && g_[j] == 0) ++j;
    return j;
  };
  for (int j = next(0); j < n_;) {
    const int other = next(j + 1);
    const double* __restrict const one = K_.data() + std::size_t(j) * n_;
    const double* __restrict const two = K_.data() + std::size_t(other < n_ ? other : j) * n_;
    double* __restrict const w = w_.data();
    double* __restrict const size = size_.data();
    const double g = g_[j], h = other < n_ ? g_[other] : 0;
    for (int i = 0; i < n_; ++i) {
      const double p = one[i] * g, q = two[i] * h;
      w[i] = (w[i] + p) + q, size[i] = (size[i] + std::fabs(p)) + std::fabs(q);
    }
    j = next(other + 1);
  }
}

// forces at bounds; all others zero
template <int D>
void Cone<D>::start(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes) {
  std::fill(g_.begin(), g_.end(), 0.0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const int row = first_[i];
    if (modes[i].kind == ModeKind::at_lower) g_[row] = blocks[i].lower / sigma_[row];
    if (modes[i].kind == ModeKind::at_upper) g_[row] = blocks[i].upper / sigma_[row];
  }
}

// the unknowns, and A_ factored
template <int D>
void Cone<D>::gather(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes, bool turning) {
  using Kind = typename Unknown::Kind;
  unknowns_.clear();
  bool symmetric = true;
  for (int i = 0; i < int(blocks.size()); ++i) {
    const int row = first_[i];
    const ConeMode<D>& mode = modes[i];
    if (mode.kind == ModeKind::free || mode.kind == ModeKind::stick) {
      for (int k = 0; k < blocks[i].rows(); ++k) unknowns_.push_back({Kind::row, row + k, i});
    } else if (on_cone(mode.kind)) {
      unknowns_.push_back({Kind::cone, row, i});
      symmetric = symmetric && (blocks[i].mu == 0 || mode.along.isZero(0));
      if (turning && mode.kind == ModeKind::slide && !blocks[i].sliding && blocks[i].mu > 0 && g_[row] > 0) {
        unknowns_.push_back({Kind::turn, row, i});
        symmetric = false;
      }
    }
  }

  ++tries_;
  if (symmetric && !turning) return factor_symmetric();
  lay_leaning(blocks, modes, turning);
  if (factors_.regular(A_, int(unknowns_.size()), kSafe)) return;
  if (!turning) {
    if (factor_leaning(blocks, modes)) return;
    lay_leaning(blocks, modes, false);
  }
  factors_.general(A_, int(unknowns_.size()), kDependent);
}

// K between rows and unknowns
template <int D>
void Cone<D>::lay_leaning(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes,
                          bool turning) {
  using Kind = typename Unknown::Kind;
  const int m = int(unknowns_.size());
  A_.resize(std::size_t(m) * m), x_.resize(m);
  std::vector<double>& push = w_;  // what an unknown does to every row; answer() writes w_ again
  for (int j = 0; j < m; ++j) {
    const Unknown& u = unknowns_[j];
    const double* const K = K_.data() + std::size_t(u.row) * n_;
    const Tangent<D>& along = modes[u.block].along;
    const Tangent<D> aside = across(along);
    const double mu = blocks[u.block].mu;
    const double* from = K;
    if (u.kind != Kind::row && !(u.kind == Kind::cone && mu == 0)) {
      for (int i = 0; i < n_; ++i) {
        double sum = u.kind == Kind::cone ? K[i] : 0;
        for (int k = 1; k < D; ++k) {
          const double share = u.kind == Kind::cone ? -mu * along[k - 1] : -aside[k - 1];
          sum += share * K[std::size_t(k) * n_ + i];
        }
        push[i] = sum;
      }
      from = push.data();
    }
    for (int i = 0; i < m; ++i) {
      const Unknown& row = unknowns_[i];
      double& a = A_[std::size_t(j) * m + i];
      if (row.kind != Kind::turn) {
        a = from[row.row];
      } else {
        const Tangent<D> over = across(modes[row.block].along);
        a = 0;
        for (int k = 1; k < D; ++k) a += over[k - 1] * from[row.row + k];
      }
    }
  }
  if (turning) {
    // the effect of a turn of d by itself: w_t, which was along d, gets a component across it
    answer();
    for (int j = 0; j < m; ++j) {
      const Unknown& u = unknowns_[j];
      if (u.kind != Kind::turn) continue;
      double along = 0;
      for (int k = 1; k < D; ++k) along += modes[u.block].along[k - 1] * w_[u.row + k];
      A_[std::size_t(j) * m + j] -= along / (blocks[u.block].mu * g_[u.row]);
    }
  }
}

// K between the rows of the unknowns
template <int D>
void Cone<D>::factor_symmetric() {
  const int m = int(unknowns_.size());
  A_.resize(std::size_t(m) * m), x_.resize(m);
  for (int j = 0; j < m; ++j) {
    const double* const K = K_.data() + std::size_t(unknowns_[j].row) * n_;
    for (int i = 0; i < m; ++i) A_[std::size_t(j) * m + i] = K[unknowns_[i].row];
  }
  if (!factors_.definite(A_, m, kSafe)) factors_.symmetric(A_, m, kDependent);
}

// The same, with the tangents of contacts on their cones below.
template <int D>
bool Cone<D>::factor_leaning(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes) {
  const int m = int(unknowns_.size());
  rows_.clear(), to_.clear(), share_.clear();
  x_.resize(m);
  for (const Unknown& u : unknowns_) rows_.push_back(u.row);
  for (int i = 0; i < m; ++i) {
    const Unknown& u = unknowns_[i];
    const double mu = blocks[u.block].mu;
    if (u.kind != Unknown::Kind::cone || mu == 0) continue;
    for (int k = 1; k < D; ++k) {
      rows_.push_back(u.row + k), to_.push_back(i), share_.push_back(-mu * modes[u.block].along[k - 1]);
    }
  }
  const int all = int(rows_.size());
  A_.resize(std::size_t(all) * all);
  for (int j = 0; j < m; ++j) {
    const double* const K = K_.data() + std::size_t(rows_[j]) * n_;
    for (int i = 0; i < all; ++i) A_[std::size_t(j) * all + i] = K[rows_[i]];
  }
  return factors_.leaning(A_, all, m, to_, share_, kDependent);
}

// one correction of g by what the equalities still miss
template <int D>
void Cone<D>::refine(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes) {
  using Kind = typename Unknown::Kind;
  answer();
  const int m = int(unknowns_.size());
  for (int i = 0; i < m; ++i) {
    const Unknown& u = unknowns_[i];
    if (u.kind == Kind::turn) {
      const Tangent<D> over = across(modes[u.block].along);
      x_[i] = 0;
      for (int k = 1; k < D; ++k) x_[i] -= over[k - 1] * w_[u.row + k];
    } else {
      x_[i] = -w_[u.row];
    }
  }
  factors_.solve(x_, x_);
  for (int i = 0; i < m; ++i) {
    const Unknown& u = unknowns_[i];
    const double mu = blocks[u.block].mu;
    if (u.kind == Kind::row) {
      g_[u.row] += x_[i];
      continue;
    }
    Tangent<D>& along = modes[u.block].along;
    if (u.kind == Kind::turn) {
      const double angle =
          std::clamp(x_[i] / (mu * std::max(g_[u.row], 1e-300)), -kLargestTurn, kLargestTurn);
      along = (along + angle * across(along)).normalized();
    } else {
      g_[u.row] += x_[i];
    }
    for (int k = 1; k < D; ++k) g_[u.row + k] = -mu * g_[u.row] * along[k - 1];
  }
}

// the worst miss of the equalities, of the largest term in its row
template <int D>
double Cone<D>::misfit() const {
  double worst = 0;
  for (const Unknown& u : unknowns_) {
    if (u.kind == Unknown::Kind::turn) continue;
    const double miss = std::fabs(w_[u.row]) - sigma_[u.row] * negligible;
    if (miss > 0) worst = std::max(worst, miss / size_[u.row]);
  }
  return worst;
}

template <int D>
void Cone<D>::balance(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes) {
  start(blocks, modes);
  gather(blocks, modes, false);
  for (int i = 0; i < kRefinements; ++i) refine(blocks, modes);
  answer();
}

// One Newton step for the directions of contacts that slip from rest, from where balance() left off.
template <int D>
bool Cone<D>::turn(std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes) {
  gather(blocks, modes, true);
  const bool any = std::any_of(unknowns_.begin(), unknowns_.end(),
                               [](const Unknown& u) { return u.kind == Unknown::Kind::turn; });
  if (!any) return false;
  refine(blocks, modes);
  // forces once more, for the directions it has come to
  gather(blocks, modes, false);
  for (int i = 0; i < kRefinements; ++i) refine(blocks, modes);
  answer();
  return true;
}

// The least residual that any forces leave in the joints' rows, with or without contacts: contacts push
// joints only as joints could themselves. Overwrites the present forces.
template <int D>
double Cone<D>::contradiction(std::span<const ConeBlock<D>> blocks) {
  std::fill(g_.begin(), g_.end(), 0.0);
  unknowns_.clear();
  for (int i = 0; i < int(blocks.size()); ++i) {
    for (int k = 0; k < blocks[i].rows() && blocks[i].law == Law::equal; ++k)
      unknowns_.push_back({Unknown::Kind::row, first_[i] + k, i});
  }
  if (unknowns_.empty()) return 0;
  factor_symmetric();
  for (int i = 0; i < kRefinements; ++i) refine(blocks, trial_);
  answer();
  return misfit();
}

template <int D>
ConeReport Cone<D>::solve_modes(const Eigen::Ref<const Eigen::MatrixXd>& K,
                                const Eigen::Ref<const Eigen::VectorXd>& b,
                                std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes,
                                Eigen::Ref<Eigen::VectorXd> f) {
  scale(K, b, blocks);
  trial_.assign(modes.begin(), modes.end());
  tries_ = 0;
  balance(blocks, trial_);
  for (int i = 0; i < n_; ++i) f[i] = sigma_[i] * g_[i];
  const double residual = misfit();
  return {residual <= kTolerance, residual, tries_};
}

template <int D>
ConeReport Cone<D>::least(const Eigen::Ref<const Eigen::MatrixXd>& K,
                          const Eigen::Ref<const Eigen::VectorXd>& r, std::span<const int> rows,
                          Eigen::Ref<Eigen::VectorXd> x) {
  // a joint a row; the others are left out
  n_ = int(rows.size()), tries_ = 0;
  sigma_.resize(n_), K_.resize(std::size_t(n_) * n_), b_.resize(n_);
  g_.assign(n_, 0.0), w_.resize(n_), size_.resize(n_), x_.resize(n_);
  unknowns_.clear();
  for (int i = 0; i < n_; ++i) {
    const double diagonal = K(rows[i], rows[i]);
    sigma_[i] = diagonal > 0 ? 1 / std::sqrt(diagonal) : 1;
    b_[i] = -sigma_[i] * r[rows[i]];
    unknowns_.push_back({Unknown::Kind::row, i, i});
  }
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) K_[std::size_t(j) * n_ + i] = sigma_[i] * sigma_[j] * K(rows[i], rows[j]);
  }
  ++tries_;
  if (!factors_.definite(K_, n_, kSafe)) factors_.symmetric(K_, n_, kDependent);
  for (int pass = 0; pass < kRefinements; ++pass) {
    answer();
    for (int i = 0; i < n_; ++i) x_[i] = -w_[i];
    factors_.solve(x_, x_);
    for (int i = 0; i < n_; ++i) g_[i] += x_[i];
  }
  answer();
  x.setZero();
  for (int i = 0; i < n_; ++i) x[rows[i]] = sigma_[i] * g_[i];
  const double residual = misfit();
  return {residual <= kTolerance, residual, tries_};
}

template class Cone<2>;
template class Cone<3>;

}  // namespace obscura::sim
