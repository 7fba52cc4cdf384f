// The residual, block by block: by how much forces and velocities violate their law, and the mode to try
// next. Scaled rows have K_ii <= 1, so that a force is comparable with the response that it can make.

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/solve/cone/cone.h"

namespace obscura::sim {

namespace {

// smaller ones have no full precision: rounding would look like a violation
constexpr double kLeast = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
// of the largest row: an equality solved with it is off by its rounding, however small its own numbers are
constexpr double kRounded = 1e-4;

}  // namespace

template <int D>
double Cone<D>::check(std::span<const ConeBlock<D>> blocks, std::span<const ConeMode<D>> modes) {
  better_.assign(modes.begin(), modes.end());
  wrong_.resize(blocks.size());
  double worst = 0;
  const double rounded = n_ > 0 ? kRounded * *std::max_element(size_.begin(), size_.end()) : 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const int row = first_[i];
    double size = blocks[i].law == Law::equal ? rounded : 0;
    for (int k = 0; k < blocks[i].rows(); ++k) size = std::max(size, size_[row + k]);
    const double wrong = check(blocks[i], modes[i], row, better_[i]) - sigma_[row] * negligible;
    wrong_[i] = wrong > kLeast ? wrong / size : wrong <= kLeast ? 0 : wrong;  // not a number stays so
    if (!(wrong_[i] <= worst)) worst = wrong_[i];
  }
  return worst;
}

// the largest violation in one block, and in `better` the mode that would mend it
template <int D>
double Cone<D>::check(const ConeBlock<D>& block, const ConeMode<D>& mode, int row,
                      ConeMode<D>& better) const {
  double worst = 0;
  const auto see = [&](double violation, ModeKind kind) {
    if (!(violation <= worst)) worst = violation, better.kind = kind;
  };
  const double f = g_[row], w = w_[row];
  switch (mode.kind) {
    case ModeKind::free:
      see(std::fabs(w), ModeKind::free);
      if (block.law == Law::equal) break;
      see(block.lower / sigma_[row] - f, ModeKind::at_lower);
      see(f - block.upper / sigma_[row], ModeKind::at_upper);
      break;
    case ModeKind::at_lower:
      if (block.lower < block.upper) see(-w, ModeKind::free);
      break;
    case ModeKind::at_upper:
      if (block.lower < block.upper) see(w, ModeKind::free);
      break;
    case ModeKind::open:
      see(-w, block.sliding || block.mu == 0 ? ModeKind::slide : ModeKind::stick);
      if (better.kind == ModeKind::slide) better.along = block.direction;
      break;
    case ModeKind::stick: {
      const Tangent<D> ft = Eigen::Map<const Tangent<D>>(g_.data() + row + 1);
      const double pull = ft.norm();
      see(std::fabs(w), ModeKind::stick);
      see(Eigen::Map<const Tangent<D>>(w_.data() + row + 1).norm(), ModeKind::stick);
      see(-f, ModeKind::open);
      // what does not press has no friction
      if (f > 0)
        see(pull - block.mu * f, ModeKind::slide);
      else
        see(pull, ModeKind::open);
      if (better.kind == ModeKind::slide) better.along = -ft / pull;
      break;
    }
    case ModeKind::at_friction_limit:
    case ModeKind::slide: {
      see(std::fabs(w), mode.kind);
      see(-f, ModeKind::open);
      if (block.sliding || block.mu == 0) break;
      // friction may be large enough to matter, and must not push the way it slips
      const Tangent<D> wt = Eigen::Map<const Tangent<D>>(w_.data() + row + 1);
      const double along = wt.dot(mode.along), most = block.mu * std::max(0.0, f);
      see(std::min(-along, most), ModeKind::stick);
      if constexpr (D > 2) {
        const Tangent<D> aside = wt - along * mode.along;
        see(std::min(aside.norm(), most), mode.kind);
        if (better.kind == mode.kind && along > 0) better.along = wt.normalized();
      }
      break;
    }
  }
  if (better.kind != ModeKind::slide && better.kind != ModeKind::at_friction_limit) better.along.setZero();
  return worst;
}

template double Cone<2>::check(std::span<const ConeBlock<2>>, std::span<const ConeMode<2>>);
template double Cone<3>::check(std::span<const ConeBlock<3>>, std::span<const ConeMode<3>>);

}  // namespace obscura::sim
