// Modes of slightly soft contacts by a semismooth Newton method.
//   u = L f(y),  y = -(L^T u + b) / eps,  K = L^T L
// f(y): each law's projection. The associated law projects on the friction cone: that is a convex problem
// with
//   phi(u) = |u|^2 / 2 + eps sum (y . f - |f|^2 / 2)
// so that Newton's method with a line search always ends, and where forces in the cones can hold everything
// at rest, it finds them. Shifted by mu |w_t| on the normals it is Coulomb's law (de Saxce and Feng, 1998).
// Coulomb's law f_n = max(0, y_n), |f_t| <= mu f_n is then solved from there by the same method without phi.

#include "sim/solve/cone/cone_newton.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kSettled = 1e-10;  // of u
constexpr double kStride = 0.1;     // of softness
constexpr int kStrides = 40;

double dot(std::span<const double> x, std::span<const double> y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

}  // namespace

template <int D>
void ConeGuess<D>::reserve(int contacts) {
  const std::size_t rows = std::size_t(D) * std::size_t(contacts);
  factors_.reserve(int(rows));
  for (auto* square : {&L_, &H_, &work_}) square->reserve(rows * rows);
  for (auto* numbers : {&u_, &w_, &f_, &F_, &du_, &tried_, &kept_, &shift_}) numbers->reserve(rows);
  swaps_.reserve(rows), slopes_.reserve(std::size_t(contacts)), built_.reserve(std::size_t(contacts));
}

template <int D>
void ConeGuess<D>::begin(std::span<const double> K, std::span<const double> b,
                         std::span<const ConeBlock<D>> blocks, std::span<const int> first,
                         std::span<const double> sigma) {
  systems_ = 0;
  n_ = int(b.size()), b_ = b, blocks_ = blocks, first_ = first, sigma_ = sigma;
  factors_.symmetric(K, n_, kDependent);
  r_ = factors_.rank();
  L_.resize(std::size_t(n_) * r_);
  for (int k = 0; k < r_; ++k) {
    const double root = std::sqrt(factors_.pivot(k));
    const std::span<const double> column = factors_.column(k);
    for (int i = 0; i < n_; ++i) L_[std::size_t(i) * r_ + k] = root * column[i];
  }
  u_.assign(r_, 0.0), F_.resize(r_), du_.resize(r_), tried_.resize(r_);
  w_.resize(n_), f_.resize(n_), shift_.assign(n_, 0.0);
  slopes_.assign(blocks.size(), SquareD::Zero());
  fresh_ = true;
}

// f and df/dy of one block; its part of phi / eps
template <int D>
double ConeGuess<D>::law(int block, double softness, Friction friction, const double* w, VecD& f,
                         SquareD& slope) const {
  const ConeBlock<D>& law = blocks_[block];
  const int row = first_[block];
  f.setZero(), slope.setZero();
  if (law.law != Law::contact) {
    const double y = -w[0] / softness;
    const double lower = law.law == Law::equal ? y : law.lower / sigma_[row];
    const double upper = law.law == Law::equal ? y : law.upper / sigma_[row];
    f[0] = std::clamp(y, std::min(lower, upper), upper);
    slope(0, 0) = f[0] == y ? 1 : 0;
    return y * f[0] - f[0] * f[0] / 2;
  }

  const double mu = law.mu;
  const double yn = -(w[0] + (friction == Friction::associated && !law.sliding ? shift_[row] : 0)) / softness;
  if (law.sliding) {
    // the direction of friction is known; to the convex problem its size is a load
    f[0] = std::max(0.0, yn);
    slope(0, 0) = yn > 0 ? 1 : 0;
    double load = 0;
    for (int k = 1; k < D; ++k) {
      if (friction == Friction::coulomb) {
        f[k] = -mu * f[0] * law.direction[k - 1], slope(k, 0) = -mu * law.direction[k - 1] * slope(0, 0);
      } else {
        f[k] = shift_[row + k], load += w[k] * f[k] / softness;
      }
    }
    return f[0] * f[0] / 2 - load;
  }

  const Tangent<D> yt = -Eigen::Map<const Tangent<D>>(w + 1) / softness;
  const double a = yt.norm();
  const Tangent<D> along = a > 0 ? Tangent<D>(yt / a) : Tangent<D>(Tangent<D>::Zero());
  if (friction == Friction::coulomb) {
    const double fn = std::max(0.0, yn);
    if (fn == 0) return 0;
    f[0] = fn, slope(0, 0) = 1;
    if (a <= mu * fn) {
      f.template tail<D - 1>() = yt;
      slope.template bottomRightCorner<D - 1, D - 1>().setIdentity();
    } else {
      f.template tail<D - 1>() = mu * fn * along;
      slope.template bottomLeftCorner<D - 1, 1>() = mu * along;
      slope.template bottomRightCorner<D - 1, D - 1>() =
          mu * fn / a * (Eigen::Matrix<double, D - 1, D - 1>::Identity() - along * along.transpose());
    }
    return 0;
  }
  if (yn > 0 && a <= mu * yn) {
    f[0] = yn, f.template tail<D - 1>() = yt;
    slope.setIdentity();
  } else if (yn + mu * a > 0) {
    VecD face;
    face[0] = 1, face.template tail<D - 1>() = mu * along;
    const double fn = (yn + mu * a) / (1 + mu * mu);
    f = fn * face;
    slope = face * face.transpose() / (1 + mu * mu);
    if (a > 0 && D > 2) {
      slope.template bottomRightCorner<D - 1, D - 1>() +=
          mu * fn / a * (Eigen::Matrix<double, D - 1, D - 1>::Identity() - along * along.transpose());
    }
  }
  return f.squaredNorm() / 2;
}

// w_, f_, slopes_ and F_ at u; the merit: phi, or |F|^2
template <int D>
double ConeGuess<D>::evaluate(double softness, Friction friction, std::span<const double> u) {
  std::copy(u.begin(), u.end(), F_.begin());
  double phi = 0;
  VecD f;
  for (int block = 0; block < int(blocks_.size()); ++block) {
    const int row = first_[block], rows = blocks_[block].rows();
    for (int i = row; i < row + rows; ++i)
      w_[i] = dot({L_.data() + std::size_t(i) * r_, u.size()}, u) + b_[i];
    phi += softness * law(block, softness, friction, w_.data() + row, f, slopes_[block]);
    for (int k = 0; k < rows; ++k) {
      f_[row + k] = f[k];
      if (f[k] == 0) continue;
      const double* const l = L_.data() + std::size_t(row + k) * r_;
      for (int j = 0; j < r_; ++j) F_[j] -= f[k] * l[j];
    }
  }
  return friction == Friction::associated ? phi + dot(u, u) / 2 : dot(F_, F_);
}

// du = -(1 + sum L slope L^T / eps)^-1 F. The sum is kept up from call to call.
template <int D>
bool ConeGuess<D>::step(double softness) {
  if (fresh_) {
    H_.assign(std::size_t(r_) * r_, 0.0);
    built_.assign(blocks_.size(), SquareD::Zero());
    fresh_ = false;
  }
  work_.resize(r_);
  for (int block = 0; block < int(blocks_.size()); ++block) {
    const SquareD change = slopes_[block] - built_[block];
    built_[block] = slopes_[block];
    const int rows = blocks_[block].rows();
    for (int j = 0; j < rows; ++j) {
      // H += (L change e_j) l_j^T
      if (change.col(j).isZero(0)) continue;
      std::fill(work_.begin(), work_.end(), 0.0);
      for (int i = 0; i < rows; ++i) {
        const double* const l = L_.data() + std::size_t(first_[block] + i) * r_;
        if (change(i, j) == 0) continue;
        for (int k = 0; k < r_; ++k) work_[k] += change(i, j) * l[k];
      }
      const double* const l = L_.data() + std::size_t(first_[block] + j) * r_;
      for (int c = 0; c < r_; ++c) {
        if (l[c] == 0) continue;
        double* __restrict const h = H_.data() + std::size_t(c) * r_;
        const double* __restrict const p = work_.data();
        for (int k = 0; k < r_; ++k) h[k] += l[c] * p[k];
      }
    }
  }
  work_ = H_;
  for (int k = 0; k < r_; ++k) work_[std::size_t(k) * r_ + k] += softness;
  for (int k = 0; k < r_; ++k) du_[k] = -softness * F_[k];
  swaps_.resize(r_), ++systems_;
  if (!eliminate(work_, r_, 0, swaps_)) return false;
  substitute(work_, r_, swaps_, du_);
  return true;
}

template <int D>
bool ConeGuess<D>::newton(double softness, Friction friction, int iterations) {
  double merit = evaluate(softness, friction, u_);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    if (!step(softness)) return false;
    double length = 0, size = 0;
    for (int k = 0; k < r_; ++k)
      length = std::max(length, std::fabs(du_[k])), size = std::max(size, std::fabs(u_[k]));
    const double descent = friction == Friction::associated ? dot(F_, du_) : -2 * merit;

    // halve the step until the merit falls
    bool falls = false;
    double part = 1, reached = merit;
    for (int halving = 0; halving < 12 && !falls; ++halving, part /= 2) {
      for (int k = 0; k < r_; ++k) tried_[k] = u_[k] + part * du_[k];
      reached = evaluate(softness, friction, tried_);
      falls = reached <= merit + 1e-4 * part * descent;
      if (falls) break;
    }
    const bool settled = length <= kSettled * (size + length);
    if (!falls && !settled) {
      merit = evaluate(softness, friction, u_);
      // phi is flat to rounding: as good as settled
      return friction == Friction::associated &&
             std::fabs(descent) <= 1e-13 * (std::fabs(merit) + dot(u_, u_));
    }
    std::swap(u_, tried_);
    merit = reached;
    if (settled) return true;
  }
  return false;
}

template <int D>
void ConeGuess<D>::modes(double softness, std::span<ConeMode<D>> modes) const {
  for (int block = 0; block < int(blocks_.size()); ++block) {
    const ConeBlock<D>& law = blocks_[block];
    const int row = first_[block];
    const double f = f_[row];
    ConeMode<D>& mode = modes[block];
    mode.along.setZero();
    if (law.law == Law::equal) {
      mode.kind = ModeKind::free;
    } else if (law.law == Law::bounded) {
      const double y = -w_[row] / softness;
      mode.kind = f == y ? ModeKind::free : y < f ? ModeKind::at_lower : ModeKind::at_upper;
    } else if (!(f > 0)) {
      mode.kind = ModeKind::open;
    } else if (law.sliding) {
      mode = {ModeKind::slide, law.direction};
    } else {
      const Tangent<D> wt = Eigen::Map<const Tangent<D>>(w_.data() + row + 1);
      const double speed = wt.norm(), most = law.mu * f * softness;
      const bool slips = speed > most * (1 + 1e-9);
      mode.kind = slips ? ModeKind::slide : ModeKind::stick;
      if (slips) mode.along = wt / speed;
    }
  }
}

// Coulomb's law from very soft to `softness`, each solution the start of the next; shorter strides where
// Newton's method does not follow. How soft it still is where it ends.
template <int D>
double ConeGuess<D>::stiffen(double softness) {
  std::fill(u_.begin(), u_.end(), 0.0);
  std::fill(shift_.begin(), shift_.end(), 0.0);
  double from = 1, stride = kStride;
  newton(from, Friction::associated, 20);
  if (!newton(from, Friction::coulomb, 25)) return from;
  for (int i = 0; i < kStrides && from > softness; ++i) {
    kept_ = u_;
    const double to = std::max(softness, from * stride);
    if (newton(to, Friction::coulomb, 25)) {
      from = to, stride = std::max(kStride, stride * stride);
    } else {
      u_ = kept_, stride = std::sqrt(stride);
    }
  }
  evaluate(from, Friction::coulomb, u_);
  return from;
}

template <int D>
bool ConeGuess<D>::guess(double softness, std::span<ConeMode<D>> out, bool follow) {
  // softness in stages, the convex problem first
  double reached = softness;
  if (r_ > 0) {
    std::fill(shift_.begin(), shift_.end(), 0.0);
    for (double eps = 1e-2; eps > softness; eps *= 1e-2) newton(eps, Friction::associated, 20);
    newton(softness, Friction::associated, 40);
    if (!newton(softness, Friction::coulomb, 25)) reached = follow ? stiffen(softness) : 1;
  } else {
    evaluate(softness, Friction::coulomb, u_);
  }
  modes(reached, out);
  return reached <= softness;
}

template class ConeGuess<2>;
template class ConeGuess<3>;

}  // namespace obscura::sim
