// Rough forces by projected Gauss-Seidel (Moreau 1999; Jean 1999: nonsmooth contact dynamics).
//   f_n <- max(0, f_n - w_n / K_nn),   f_t <- f_t - w_t / K_tt, back onto |f_t| <= mu f_n
// one block after another, there and back, each with what those before it have left. Steep cones of what
// hangs together can make that grow without end; then by the associated law, which is a convex problem,
//   (f_n, f_t) <- the nearest to f - w / k in the cone,   k  the trace of the block's K
// so that where forces in the cones can hold everything, they are found. Once nothing changes
// any more, the forces of blocks that are mirror images of each other are so too, whatever their order.

#include <algorithm>
#include <cmath>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {

namespace {

constexpr double kStill = 1e-15;  // of the largest b: a change that is none
constexpr double kGrows = 100;    // of the largest change of the first two sweeps

}  // namespace

template <int D>
void Cone<D>::sweep(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                    std::span<const ConeBlock<D>> blocks, std::span<ConeMode<D>> modes,
                    Eigen::Ref<Eigen::VectorXd> f, int sweeps) {
  n_ = int(b.size());
  w_.resize(n_), first_.resize(blocks.size());
  Eigen::Map<Eigen::VectorXd> w(w_.data(), n_);
  w.noalias() = K * f;
  w += b;
  int row = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) first_[i] = row, row += blocks[i].rows();

  // the nonzero entries of each column
  starts_.assign(1, 0), places_.clear(), entries_.clear();
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) {
      if (K(i, j) != 0) places_.push_back(i), entries_.push_back(K(i, j));
    }
    starts_.push_back(int(places_.size()));
  }
  double change = 0, first_change = 0;  // in a sweep, of a response
  bool associated = false;
  begun_.assign(f.data(), f.data() + n_);
  const auto set = [&](int at, double value) {
    const double by = value - f[at];
    if (by == 0) return;
    change = std::max(change, std::abs(by * K(at, at)));
    f[at] = value;
    for (int k = starts_[at]; k < starts_[at + 1]; ++k) w_[places_[k]] += by * entries_[k];
  };
  const auto visit = [&](std::size_t i) {
    const ConeBlock<D>& block = blocks[i];
    const int n = first_[i];
    if (!(K(n, n) > 0)) return;
    const double aim = f[n] - w[n] / K(n, n);
    if (block.law == Law::equal) return set(n, aim);
    if (block.law == Law::bounded) return set(n, std::min(std::max(aim, block.lower), block.upper));
    if (associated) {
      double stiff = 0;
      for (int k = 0; k < D; ++k) stiff += K(n + k, n + k);
      const double pressed = f[n] - w[n] / stiff;
      Tangent<D> drag;
      for (int k = 1; k < D; ++k) drag[k - 1] = f[n + k] - w[n + k] / stiff;
      const double size = std::sqrt(drag.squaredNorm());
      if (size <= block.mu * pressed) {
        set(n, pressed);
      } else {
        set(n, std::max(0.0, (pressed + block.mu * size) / (1 + block.mu * block.mu)));
        drag *= size > 0 ? block.mu * f[n] / size : 0;
      }
      for (int k = 1; k < D; ++k) set(n + k, drag[k - 1]);
      return;
    }
    set(n, std::max(0.0, aim));
    const double most = block.mu * f[n];
    Tangent<D> drag;
    if (block.sliding) {
      drag = -most * block.direction;
    } else {
      double stiff = 0;
      for (int k = 1; k < D; ++k) stiff = std::max(stiff, K(n + k, n + k));
      for (int k = 1; k < D; ++k) drag[k - 1] = stiff > 0 ? f[n + k] - w[n + k] / stiff : 0;
      const double size = std::sqrt(drag.squaredNorm());
      if (size > most) drag *= most / size;
    }
    for (int k = 1; k < D; ++k) set(n + k, drag[k - 1]);
  };
  const double fastest = b.size() > 0 ? b.cwiseAbs().maxCoeff() : 0;
  for (int s = 0; s < sweeps; ++s) {
    change = 0;
    for (std::size_t i = 0; i < blocks.size(); ++i) visit(s % 2 == 0 ? i : blocks.size() - 1 - i);
    if (change <= kStill * fastest) break;
    if (s < 2) first_change = std::max(first_change, change);
    if (associated || change <= kGrows * first_change) continue;
    associated = true;
    std::copy(begun_.begin(), begun_.end(), f.data());
    w.noalias() = K * f;
    w += b;
  }

  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const ConeBlock<D>& block = blocks[i];
    const int n = first_[i];
    modes[i] = {ModeKind::free, Tangent<D>::Zero()};
    if (block.law == Law::bounded && f[n] == block.lower) modes[i].kind = ModeKind::at_lower;
    if (block.law == Law::bounded && f[n] == block.upper) modes[i].kind = ModeKind::at_upper;
    if (block.law != Law::contact) continue;
    const Eigen::Map<const Tangent<D>> drag(f.data() + n + 1);
    const double size = std::sqrt(drag.squaredNorm());
    modes[i].kind = f[n] == 0                        ? ModeKind::open
                    : size < 0.999 * block.mu * f[n] ? ModeKind::stick
                                                     : ModeKind::slide;
    if (modes[i].kind == ModeKind::slide && size > 0) modes[i].along = -drag / size;
  }
}

template void Cone<2>::sweep(const Eigen::Ref<const Eigen::MatrixXd>&,
                             const Eigen::Ref<const Eigen::VectorXd>&, std::span<const ConeBlock<2>>,
                             std::span<ConeMode<2>>, Eigen::Ref<Eigen::VectorXd>, int);
template void Cone<3>::sweep(const Eigen::Ref<const Eigen::MatrixXd>&,
                             const Eigen::Ref<const Eigen::VectorXd>&, std::span<const ConeBlock<3>>,
                             std::span<ConeMode<3>>, Eigen::Ref<Eigen::VectorXd>, int);

}  // namespace obscura::sim
