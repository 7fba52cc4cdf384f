// Few contacts that meet in one instant, and ends of joints, exactly (sim/solve/cone/cone.h), in the plane
// and in space.

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
void InstantImpact<D>::resize(int contacts, int ends) {
  const int rows = D * contacts + ends;
  K.resize(rows, rows), speeds.resize(rows), p.resize(rows);
  blocks.assign(std::size_t(contacts + ends), {});
  driven = false;
  elasticity.assign(std::size_t(contacts), 0), strikes.assign(std::size_t(contacts), 0);
  for (int i = contacts; i < contacts + ends; ++i) {
    blocks[std::size_t(i)].law = Law::bounded, blocks[std::size_t(i)].lower = 0;
  }
}

// impulses that obey the laws
template <int D>
bool InstantImpact<D>::find(const Matrix& response, const Rows& b, const std::vector<ConeBlock<D>>& of,
                            Rows& impulses) {
  impulses.setZero(b.size());
  modes_.assign(of.size(), {});
  cone_.sweep(response, b, of, modes_, impulses, kSweeps);
  return cone_.solve(response, b, of, modes_, impulses).found;
}

// What holds before the impact: its impulses, into rested_, and what they leave of the speeds.
template <int D>
void InstantImpact<D>::rest() {
  rested_.setZero(speeds.size());
  resting_.clear(), rest_blocks_.clear();
  const int contacts = int(strikes.size());
  bool closes = false;
  for (int k = 0, row = 0; k < int(blocks.size()); row += blocks[std::size_t(k)].rows(), ++k) {
    if (k < contacts && strikes[std::size_t(k)] != 0) continue;
    closes = closes || speeds[row] < 0;
    rest_blocks_.push_back(blocks[std::size_t(k)]);
    for (int i = 0; i < blocks[std::size_t(k)].rows(); ++i) resting_.push_back(row + i);
  }
  if (!closes) return;
  const int count = int(resting_.size());
  rest_rows_.resize(count, count), b_.resize(count);
  for (int i = 0; i < count; ++i) {
    b_[i] = speeds[resting_[std::size_t(i)]];
    for (int j = 0; j < count; ++j) rest_rows_(i, j) = K(resting_[std::size_t(i)], resting_[std::size_t(j)]);
  }
  if (!find(rest_rows_, b_, rest_blocks_, part_)) return;
  for (int i = 0; i < count; ++i) rested_[resting_[std::size_t(i)]] = part_[i];
  speeds.noalias() += K * rested_;
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
  b_ = speeds;
  for (int k = 0; k < int(strikes.size()); ++k)
    if (strikes[std::size_t(k)] != 0) b_[D * k] += share * elasticity[std::size_t(k)] * speeds[D * k];
  if constexpr (D == 3) {
    Vec3 alone;
    if (blocks.size() == 1 && solve_one_contact(K, b_, blocks[0].mu, alone)) {
      p = alone;
      return rise();
    }
  }
  if (!find(K, b_, blocks, p)) return std::numeric_limits<double>::infinity();
  return rise();
}

// What finds no impulses as it bounces between a belt, or what is moved, and what stands before it, does not
// bounce; where none are found so either, what many sweeps come to, if it gains nothing and leaves nothing
// that closes as fast as before.
template <int D>
bool InstantImpact<D>::solve_without_bounce() {
  constexpr int kMany = 500;
  constexpr double kLeft = 0.1;  // of the fastest that strikes
  double gained = attempt(0);
  if (!std::isfinite(gained)) {
    modes_.assign(blocks.size(), {}), p.setZero(speeds.size());
    cone_.sweep(K, speeds, blocks, modes_, p, kMany);
    gained = rise();
    double before = 0, after = 0;
    for (int k = 0; k < int(strikes.size()); ++k) {
      before = std::max(before, -speeds[D * k]);
      after = std::max(after, -(speeds[D * k] + K.row(D * k).dot(p)));
    }
    jams_ = !(after <= kLeft * before);
  }
  if (jams_ || !(gained <= 0)) return false;
  p += rested_;
  return true;
}

template <int D>
bool InstantImpact<D>::solve() {
  cone_.patience = kPatience, jams_ = false;
  rest();
  double gained = attempt(1);
  if (!std::isfinite(gained)) return driven && solve_without_bounce();
  restitution_share(1, [&](double share) { return share == 1 ? gained : gained = attempt(share); });
  p += rested_;
  return std::isfinite(gained);
}

template class InstantImpact<2>;
template class InstantImpact<3>;

}  // namespace obscura::sim
