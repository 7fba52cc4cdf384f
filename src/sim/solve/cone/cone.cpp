// Joints, limits and dry contacts by an active set.
//   w = K f + b        every block obeys its law; a set of modes makes the laws equalities
// The modes of the last step are tried first, and switched if few are wrong; then those after some
// Gauss-Seidel iterations, then those of a softened problem; each time the equalities are solved exactly, and
// the laws checked.
// Source: Baraff, Fast contact force computation for nonpenetrating rigid bodies (1994).

#include "sim/solve/cone/cone.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kSoftness[] = {1e-7, 1e-4, 1e-3};
constexpr double kExact = 1e-14;  // no better is to be had
constexpr int kTurns = 30;        // Newton steps for directions of slip
constexpr int kPatience = 8;      // of them, in which the residual shall halve
constexpr double kNear = 1e-6;    // no other set of modes is nearer
constexpr int kSmall = 64;        // rows: so few that a factorisation costs nothing
constexpr int kSweeps[] = {200, 1000};
constexpr int kMostSwitches = 20;  // of modes, from one set on
constexpr long kMostSets = 5000;   // of modes, tried one by one

std::uint64_t hash_with(std::uint64_t hash, std::uint64_t value) {
  hash = (hash ^ value) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

template <int D>
std::uint64_t name(std::span<const ConeMode<D>> modes) {
  std::uint64_t hash = 0;
  for (const ConeMode<D>& mode : modes) {
    hash = hash_with(hash, std::uint64_t(mode.kind) + 1);
    for (int k = 0; k < D - 1; ++k) hash = hash_with(hash, mode.along[k] > 0 ? 2 : mode.along[k] < 0 ? 1 : 0);
  }
  return hash;
}

// the mode if the law knows it, else the one to begin with
template <int D>
ConeMode<D> fit(const ConeBlock<D>& block, ConeMode<D> mode) {
  if (block.law == Law::equal) return {ModeKind::free, Tangent<D>::Zero()};
  if (block.law == Law::bounded) {
    const bool bound = (mode.kind == ModeKind::at_lower && std::isfinite(block.lower)) ||
                       (mode.kind == ModeKind::at_upper && std::isfinite(block.upper));
    return {bound ? mode.kind : ModeKind::free, Tangent<D>::Zero()};
  }
  if (mode.kind == ModeKind::open) return {ModeKind::open, Tangent<D>::Zero()};
  if (block.sliding) return {ModeKind::slide, block.direction};
  if (block.mu == 0) return {ModeKind::slide, Tangent<D>::Zero()};
  const bool slips = mode.kind == ModeKind::slide || mode.kind == ModeKind::at_friction_limit;
  if (slips && mode.along.norm() > 0.5) return {ModeKind::slide, mode.along.normalized()};
  return {ModeKind::stick, Tangent<D>::Zero()};
}

}  // namespace

template <int D>
void Cone<D>::reserve(int contacts) {
  const auto blocks = std::size_t(contacts), rows = D * blocks;
  factors_.reserve(int(rows)), guess_.reserve(contacts);
  for (auto* square : {&K_, &A_, &entries_}) square->reserve(rows * rows);
  for (auto* numbers : {&sigma_, &b_, &g_, &w_, &size_, &x_, &share_, &best_g_, &begun_})
    numbers->reserve(rows);
  for (auto* numbers : {&first_, &rows_, &to_}) numbers->reserve(rows);
  for (auto* modes : {&trial_, &better_, &best_}) modes->reserve(blocks);
  places_.reserve(rows * rows), starts_.reserve(rows + 1), unknowns_.reserve(rows), wrong_.reserve(blocks);
  seen_.reserve(kMostSwitches + 1);
}

template <int D>
void Cone<D>::scale(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                    std::span<const ConeBlock<D>> blocks) {
  n_ = int(b.size());
  first_.resize(blocks.size()), sigma_.resize(n_);
  int row = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    first_[i] = row;
    double most = 0;
    for (int k = 0; k < blocks[i].rows(); ++k) most = std::max(most, K(row + k, row + k));
    for (int k = 0; k < blocks[i].rows(); ++k) sigma_[row++] = most > 0 ? 1 / std::sqrt(most) : 1;
  }
  K_.resize(std::size_t(n_) * n_), b_.resize(n_);
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) K_[std::size_t(j) * n_ + i] = sigma_[i] * sigma_[j] * K(i, j);
    b_[j] = sigma_[j] * b[j];
  }
  g_.assign(n_, 0.0), w_.resize(n_), size_.resize(n_);
}

// Solves with trial_ and switches what is wrong: all of it at once, then, where that leads back, the worst
// alone. True once all laws hold. Keeps the best it meets.
template <int D>
bool Cone<D>::attempt(std::span<const ConeBlock<D>> blocks, int switches) {
  seen_.clear();
  bool alone = false;
  for (int i = 0; i <= switches; ++i) {
    balance(blocks, trial_);
    double residual = check(blocks, trial_);
    if constexpr (D > 2) {
      double aim = residual / 2;
      for (int k = 0, left = kPatience; k < kTurns && residual > kExact && left > 0 && tries_ < most_systems;
           ++k, --left) {
        const double before = residual;
        if (!turn(blocks, trial_)) break;
        residual = check(blocks, trial_);
        if (residual <= kTolerance && residual >= before / 2) break;
        if (residual <= aim) aim = residual / 2, left = kPatience + 1;
      }
    }
    if (residual < best_residual_) best_residual_ = residual, best_ = trial_, best_g_ = g_;
    if (residual <= kTolerance) return true;
    if (!std::isfinite(residual) || tries_ >= most_systems) return false;

    const std::uint64_t now = name<D>(trial_);
    if (std::find(seen_.begin(), seen_.end(), now) != seen_.end()) {
      if (alone) return false;
      alone = true, seen_.clear();
    }
    seen_.push_back(now);
    if (alone) {
      const std::size_t worst = std::max_element(wrong_.begin(), wrong_.end()) - wrong_.begin();
      trial_[worst] = better_[worst];
    } else {
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        if (wrong_[k] > kTolerance) trial_[k] = better_[k];
      }
    }
  }
  return false;
}

// every set of modes of a small problem, one after another
template <int D>
bool Cone<D>::enumerate(std::span<const ConeBlock<D>> blocks) {
  const auto choices = [](const ConeBlock<D>& block) {
    if (block.law == Law::equal) return 1;
    if (block.law == Law::bounded) return 3;
    return block.sliding || block.mu == 0 ? 2 : 4;
  };
  long sets = 1;
  for (const ConeBlock<D>& block : blocks) {
    sets *= choices(block);
    if (sets > kMostSets) return false;
  }
  for (long set = 0; set < sets; ++set) {
    long rest = set;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const int choice = int(rest % choices(blocks[i]));
      rest /= choices(blocks[i]);
      ConeMode<D> mode;
      if (blocks[i].law == Law::bounded) {
        mode.kind = choice == 0 ? ModeKind::free : choice == 1 ? ModeKind::at_lower : ModeKind::at_upper;
      } else if (choice == 1) {
        mode.kind = ModeKind::open;
      } else if (choice > 1) {
        mode = {ModeKind::slide, (choice == 2 ? 1 : -1) * Tangent<D>::Unit(0)};
      }
      trial_[i] = fit(blocks[i], mode);
    }
    if (attempt(blocks, 0)) return true;
    if (tries_ > patience) return false;
  }
  return false;
}

// other modes than those at hand
template <int D>
bool Cone<D>::search(const Eigen::Ref<const Eigen::MatrixXd>& K, const Eigen::Ref<const Eigen::VectorXd>& b,
                     std::span<const ConeBlock<D>> blocks, Eigen::Ref<Eigen::VectorXd> f) {
  // as sweeps leave it
  for (const int sweeps : kSweeps) {
    if (best_residual_ <= enough || tries_ > patience || tries_ >= most_systems) break;
    sweep(K, b, blocks, trial_, f, sweeps);
    for (std::size_t i = 0; i < blocks.size(); ++i) trial_[i] = fit(blocks[i], trial_[i]);
    if (attempt(blocks, 6)) return true;
  }

  // as softer rows have it
  const bool all = (thorough || n_ <= kSmall) && tries_ <= patience;
  if (best_residual_ <= enough) return true;
  for (std::size_t i = 0; i < (all ? std::size(kSoftness) : 1) && tries_ <= patience; ++i) {
    if (i == 0) guess_.begin(K_, b_, blocks, first_, sigma_);
    const int systems = guess_.systems();
    const bool there = guess_.guess(kSoftness[i], trial_, all);
    tries_ += guess_.systems() - systems;
    if (!there && !all) break;
    if (attempt(blocks, all ? kMostSwitches : 6)) return true;
  }
  return all && best_residual_ > kNear && tries_ <= patience && enumerate(blocks);
}

template <int D>
ConeReport Cone<D>::solve(const Eigen::Ref<const Eigen::MatrixXd>& K,
                          const Eigen::Ref<const Eigen::VectorXd>& b, std::span<const ConeBlock<D>> blocks,
                          std::span<ConeMode<D>> modes, Eigen::Ref<Eigen::VectorXd> f) {
  scale(K, b, blocks);
  tries_ = 0, best_residual_ = std::numeric_limits<double>::infinity();
  best_g_ = g_, best_.assign(modes.begin(), modes.end());

  // as it was
  trial_.resize(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) trial_[i] = fit(blocks[i], modes[i]);
  bool found = attempt(blocks, n_ <= kSmall ? 6 : 1);

  // joints that contradict one another, as loops do at their dead centre, are not helped by contacts
  if (!found && !(best_residual_ > kNear && contradiction(blocks) > kNear)) found = search(K, b, blocks, f);
  found = found || best_residual_ <= enough;

  for (int i = 0; i < n_; ++i) f[i] = sigma_[i] * best_g_[i];
  g_ = best_g_;
  answer();
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    modes[i] = best_[i];
    if (best_[i].kind != ModeKind::slide || blocks[i].sliding) continue;
    // on the cone's surface, does it slip?
    const Tangent<D> wt = Eigen::Map<const Tangent<D>>(w_.data() + first_[i] + 1);
    double size = 0;
    for (int k = 0; k < D; ++k) size = std::max(size, size_[first_[i] + k]);
    const bool slips = wt.norm() > kTolerance * size + sigma_[first_[i]] * negligible;
    if (!slips) modes[i].kind = ModeKind::at_friction_limit;
    if (slips && blocks[i].mu == 0) modes[i].along = wt.normalized();
  }
  return {found, best_residual_, tries_};
}

template class Cone<2>;
template class Cone<3>;

}  // namespace obscura::sim
