// The ways in which contacts slide through a stretch, in space, where a slip can turn.
//   f_t = -mu f_n s,   s = v_t / |v_t|
// at every stage: friction is against the slip of that instant. A slow slip turns fast, at up to
//   mu f_n k / |v_t|                                   k  what a tangent answers to a force, 1/kg
// a second; where that is more than a few radians in a step, explicit stages would throw s about. Then s is
// the one that friction has had by the end of the step, as an implicit step finds it, and stays for the
// stretch: such a contact goes less than mu f_n k h^2 in it.

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kSlowSlip =
    8;  // of what friction takes away from the slip in a step; four corners share a body
// of what aims: its ways are wanted, not its forces, and four corners that turn about one of them at a crawl
// have those only after a thousand attempts
constexpr double kEnough = 1e-7;
constexpr int kSlipPatience = 300;
constexpr int kSlipIterations = 200;  // where it finds none

}  // namespace

// the ways of all contacts that slide at this instant, of `h` (s) that are left
template <int D>
void ExactSolver<D>::begin_slides(State<D>& state, double t, double h) {
  bool any = false;
  for (Held& held : held_) {
    held.slip.setZero(), held.slow = false;
    if (held.kind != Held::Kind::contact || holding_[held.block].hold != Hold::slide) continue;
    Tangent<D> slip;
    double most = 0;
    for (int i = 0; i < D - 1; ++i) {
      const Row<D>& row = rows_[held.first + 1 + i];
      slip[i] = moves(held.first + 1 + i);
      held.slip += holding_[held.block].along[i] * row.along;
      most = std::max(most, answer(held.first + 1 + i));
    }
    const double taken = blocks_[held.block].mu * f_[held.first] * most * h;
    held.slow = std::sqrt(slip.squaredNorm()) < kSlowSlip * taken;
    any = any || held.slow;
  }
  if (any) aim_slow_slides(state, t, h);
}

// the ways of those that are slow, by the friction of an implicit step
template <int D>
void ExactSolver<D>::aim_slow_slides(State<D>& state, double t, double h) {
  chosen_blocks_ = blocks_, chosen_modes_ = modes_, chosen_f_ = f_;
  lay_blocks(true);
  const auto rate = free_.accelerations(state, t);
  for (int i = 0; i < int(rows_.size()); ++i)
    b_[i] = moves(i) + h * (along(i, rate) + rows_[i].velocity_product);
  guess(h);
  const double enough = std::exchange(cone_.enough, kEnough);
  const int patience = std::exchange(cone_.patience, kSlipPatience);
  if (!solve()) sweep(kSlipIterations);
  cone_.enough = enough, cone_.patience = patience;
  for (Held& held : held_) {
    if (!held.slow) continue;
    Vec<D> drag = Vec<D>::Zero();
    for (int i = 0; i < D - 1; ++i) drag += f_[held.first + 1 + i] * rows_[held.first + 1 + i].along;
    const double size = std::sqrt(drag.squaredNorm());
    if (size > 0) held.slip = -drag / size;
  }
  blocks_.swap(chosen_blocks_), modes_.swap(chosen_modes_), f_.swap(chosen_f_);
  turn_slides();
}

// the ways at the stage at hand. Past a stop a slide goes on as it was
template <int D>
void ExactSolver<D>::turn_slides() {
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact || holding_[held.block].hold != Hold::slide) continue;
    Tangent<D> way, slip;
    for (int i = 0; i < D - 1; ++i) {
      way[i] = held.slip.dot(rows_[held.first + 1 + i].along);
      slip[i] = moves(held.first + 1 + i);
    }
    const double fast = std::sqrt(slip.squaredNorm()), onward = slip.dot(way);
    if (!held.slow && fast > still_ && onward != 0) way = (onward > 0 ? slip : Tangent<D>(-slip)) / fast;
    const double size = std::sqrt(way.squaredNorm());
    if (size > 0) holding_[held.block].along = way / size;
  }
}

template void ExactSolver<2>::begin_slides(State<2>&, double, double);
template void ExactSolver<2>::turn_slides();
template void ExactSolver<3>::begin_slides(State<3>&, double, double);
template void ExactSolver<3>::turn_slides();

}  // namespace obscura::sim
