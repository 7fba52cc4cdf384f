// The directions in which contacts slide through an interval, in space, where a slip can turn.
//   f_t = -mu f_n s,   s = v_t / |v_t|
// at every stage: friction is against the slip of that instant. A slow slip turns fast, at up to
//   mu f_n k / |v_t|                                   k  response of a tangent to a force, 1/kg
// radians a second; if that is more than a few radians in a step, explicit stages would make s jump about.
// Then s is the direction at the end of the step, found implicitly, and stays for the interval: such a
// contact moves less than mu f_n k h^2 in it.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kSlowSlip =
    8;  // of what friction takes away from the slip in a step; four corners share a body
// The tolerance for slip directions: their directions are wanted, not their forces; at a crawl about one of
// four vertices, the directions take a thousand iterations.
constexpr double kEnough = 1e-7;
constexpr int kSlipPatience = 300;
constexpr double kShortest = 1.0 / 256;  // of a step: how long a slip may be slow under `event`
constexpr double kStops = 1e-5;          // of what friction takes away from the slip in a step: no slip

}  // namespace

// The ways of all contacts that slide at this instant, of `h` (s) that are left. Answers how much of it may
// be gone at once: under `event` no slip is slow but for a short time.
template <int D>
double ExactSolver<D>::begin_slip_directions(State<D>& state, double t, double h) {
  bool any = false;
  double length = h;
  if (model_.collision == Collision::event) {
    const double shortest = kShortest / value(model_.rate);
    for (const Constraint& constraint : constraints_) {
      if (constraint.kind != Constraint::Kind::contact ||
          interval_.modes[constraint.block].kind != ModeKind::slide)
        continue;
      double slip2 = 0, most = 0;
      for (int row = constraint.first + 1; row < constraint.first + D; ++row)
        slip2 += row_velocity(row) * row_velocity(row), most = std::max(most, self_coupling(row));
      const double slows = blocks_[constraint.block].mu * f_[constraint.first] * most;
      if (std::sqrt(slip2) < kSlowSlip * slows * length)
        length = std::min(length, std::max(std::sqrt(slip2) / (kSlowSlip * slows), shortest));
    }
    h = length;
  }
  for (Constraint& constraint : constraints_) {
    constraint.slip.setZero(), constraint.slow = false;
    if (constraint.kind != Constraint::Kind::contact ||
        interval_.modes[constraint.block].kind != ModeKind::slide)
      continue;
    Tangent<D> slip;
    double most = 0;
    for (int i = 0; i < D - 1; ++i) {
      const Row<D>& row = rows_[constraint.first + 1 + i];
      slip[i] = row_velocity(constraint.first + 1 + i);
      constraint.slip += interval_.modes[constraint.block].along[i] * row.along;
      most = std::max(most, self_coupling(constraint.first + 1 + i));
    }
    constraint.taken = blocks_[constraint.block].mu * f_[constraint.first] * most * h;
    constraint.slow = std::sqrt(slip.squaredNorm()) < kSlowSlip * constraint.taken;
    any = any || constraint.slow;
  }
  if (any) aim_slow_slips(state, t, h);
  return length;
}

// the ways of those that are slow, by the friction of an implicit step
template <int D>
void ExactSolver<D>::aim_slow_slips(State<D>& state, double t, double h) {
  scratch_.blocks = blocks_, scratch_.modes = modes_, scratch_.f = f_;
  build_blocks(true, h);
  const auto rate = dynamics_.accelerations(state, t);
  predict_velocities(rate, h);
  warm_start_rows(h);
  const double enough = std::exchange(cone_.enough, kEnough);
  const int patience = std::exchange(cone_.patience, kSlipPatience);
  if (!solve()) solve_roughly();
  cone_.enough = enough, cone_.patience = patience;
  std::vector<double> ends(rate.begin(), rate.end());
  for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i] / h, ends);
  for (Constraint& constraint : constraints_) {
    if (!constraint.slow) continue;
    // One that has no slip at the end of the step stops within it: until then it slips on as it does. Slips
    // tell, and which way: the friction of several corners of a body is not determined.
    Tangent<D> slip;
    for (int i = 0; i < D - 1; ++i) {
      const int row = constraint.first + 1 + i;
      slip[i] = row_velocity(row) + h * (row_acceleration(row, ends) + rows_[row].velocity_product);
    }
    const double fast = std::sqrt(slip.squaredNorm());
    if (fast <= kStops * constraint.taken) continue;
    constraint.slip.setZero();
    for (int i = 0; i < D - 1; ++i) constraint.slip += slip[i] / fast * rows_[constraint.first + 1 + i].along;
  }
  blocks_.swap(scratch_.blocks), modes_.swap(scratch_.modes), f_.swap(scratch_.f);
  turn_slip_directions();
}

// the ways at the stage at hand. Past a stop a slide goes on as it was
template <int D>
void ExactSolver<D>::turn_slip_directions() {
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact ||
        interval_.modes[constraint.block].kind != ModeKind::slide)
      continue;
    Tangent<D> way, slip;
    for (int i = 0; i < D - 1; ++i) {
      way[i] = constraint.slip.dot(rows_[constraint.first + 1 + i].along);
      slip[i] = row_velocity(constraint.first + 1 + i);
    }
    const double fast = std::sqrt(slip.squaredNorm()), onward = slip.dot(way);
    if (!constraint.slow && fast > still_speed_ && onward != 0)
      way = (onward > 0 ? slip : Tangent<D>(-slip)) / fast;
    const double size = std::sqrt(way.squaredNorm());
    if (size > 0) interval_.modes[constraint.block].along = way / size;
  }
}

template double ExactSolver<2>::begin_slip_directions(State<2>&, double, double);
template void ExactSolver<2>::turn_slip_directions();
template double ExactSolver<3>::begin_slip_directions(State<3>&, double, double);
template void ExactSolver<3>::turn_slip_directions();

}  // namespace obscura::sim
