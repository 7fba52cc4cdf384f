// Few contacts that meet in one instant, exactly (sim/solve/cone/cone.h), in the plane and in space.

#include "sim/solve/iterate/instant_impact.h"

#include <cmath>
#include <limits>

#include "sim/solve/cone/one_contact.h"
#include "sim/solve/restitution.h"

namespace obscura::sim {

namespace {

constexpr int kSweeps = 30;            // over the rows, for the modes that are tried first
constexpr int kPatience = 40;          // systems: what takes more is left to the iterations
constexpr double kImpactGain = 1e-13;  // of the energy that moves along the rows: rounding

}  // namespace

template <int D>
void InstantImpact<D>::resize(int contacts) {
  const int rows = D * contacts;
  K.resize(rows, rows), speeds.resize(rows), p.resize(rows);
  blocks.assign(std::size_t(contacts), {}), elasticity.assign(std::size_t(contacts), 0);
}

// how much more energy there is after it, of the largest part that an impulse moves
template <int D>
double InstantImpact<D>::rise() const {
  double sum = 0, size = 0;
  for (int i = 0; i < int(p.size()); ++i)
    sum += p[i] * (speeds[i] + 0.5 * K.row(i).dot(p)), size = std::max(size, std::abs(p[i] * speeds[i]));
  return size > 0 ? sum / size - kImpactGain : 0;
}

// with e times `share`
template <int D>
double InstantImpact<D>::attempt(double share) {
  const int count = int(blocks.size());
  b_ = speeds;
  for (int k = 0; k < count; ++k)
    if (elasticity[std::size_t(k)] != 0) b_[D * k] += share * elasticity[std::size_t(k)] * speeds[D * k];
  if constexpr (D == 3) {
    Vec3 alone;
    if (count == 1 && solve_one_contact(K, b_, blocks[0].mu, alone)) {
      p = alone;
      return rise();
    }
  }
  modes_.assign(std::size_t(count), {}), p.setZero();
  cone_.sweep(K, b_, blocks, modes_, p, kSweeps);
  if (!cone_.solve(K, b_, blocks, modes_, p).found) return std::numeric_limits<double>::infinity();
  return rise();
}

template <int D>
bool InstantImpact<D>::solve() {
  cone_.patience = kPatience;
  double gained = attempt(1);
  if (!std::isfinite(gained)) return false;
  restitution_share(1, [&](double share) { return share == 1 ? gained : gained = attempt(share); });
  return std::isfinite(gained);
}

template class InstantImpact<2>;
template class InstantImpact<3>;

}  // namespace obscura::sim
