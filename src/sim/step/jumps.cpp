#include "sim/step/jumps.h"

#include <algorithm>
#include <cmath>

#include "sim/force/formula.h"

namespace obscura::sim {

namespace {

constexpr int kMostSearches = 4000;  // parts of a step that are halved for a formula: a jump takes some 60

}  // namespace

template <int D>
Jumps<D>::Jumps(const Model<D>& model) : rate_(model.rate) {
  const auto add = [&](const Program& program, int slot) {
    Program jumps = program.jumps(slot);
    if (jumps.outputs() > 0) formulas_.push_back({std::move(jumps), slot, 0, 0, {}});
  };
  for (const Force<D>& force : model.forces) {
    if (!force.formula) continue;
    const int slot = force.on == Force<D>::On::each ? int(each_slot::time) : int(pair_slot::time);
    add(force.formula->force, slot);
  }
  for (const Drive<D>& drive : model.drives)
    if (drive.formula) add(*drive.formula, 0);
  for (const Joint<D>& joint : model.joints)
    if (joint.motor && joint.motor->aim) add(*joint.motor->aim, 0);
  for (const Formula& it : formulas_) evaluations_.emplace_back(it.program), ranges_.emplace_back(it.program);
  const auto slots = std::size_t(std::max(int(each_slot::end), int(pair_slot::end)));
  uniform_.assign(slots, 0.0), uniform_range_.assign(slots, {});
}

template <int D>
double Jumps<D>::time_at(std::int64_t step, double fraction) const {
  return time(fraction < 1 ? TimeStamp{step, fraction} : TimeStamp{step + 1, fraction - 1}, rate_);
}

template <int D>
void Jumps<D>::levels_at(int formula, double t, std::vector<double>& levels) {
  const Formula& it = formulas_[std::size_t(formula)];
  Evaluation& evaluation = evaluations_[std::size_t(formula)];
  uniform_[std::size_t(it.slot)] = t;
  evaluation.begin(uniform_);
  uniform_[std::size_t(it.slot)] = 0;
  levels.clear();
  for (int k = 0; k < it.program.outputs(); ++k) levels.push_back(*evaluation.output(k));
}

template <int D>
bool Jumps<D>::differ(int formula, std::int64_t step, double low, double high) {
  levels_at(formula, time_at(step, low), begun_), levels_at(formula, time_at(step, high), now_);
  // what is no number stays what it is
  return !std::equal(now_.begin(), now_.end(), begun_.begin(), begun_.end(),
                     [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); });
}

template <int D>
bool Jumps<D>::surely_constant(int formula, std::int64_t step, double low, double high) {
  const Formula& it = formulas_[std::size_t(formula)];
  RangeEvaluation& evaluation = ranges_[std::size_t(formula)];
  uniform_range_[std::size_t(it.slot)] = {time_at(step, low), time_at(step, high)};
  evaluation.begin(uniform_range_);
  uniform_range_[std::size_t(it.slot)] = {};
  for (int k = 0; k < it.program.outputs(); ++k)
    if (!evaluation.output(k).point()) return false;
  return true;
}

// Finds the first part, half a piece long at most, over which a formula jumps, by bisection; both halves are
// searched where both may hold a jump. After kMostSearches it bisects by the values at the ends alone.
template <int D>
typename Jumps<D>::Jump Jumps<D>::search(int formula, std::int64_t step, double low, double high) {
  if (surely_constant(formula, step, low, high)) return {low, high, false};
  if (!(high - low > 0.5 * kJumpPiece)) return {low, high, differ(formula, step, low, high)};
  int& searches = formulas_[std::size_t(formula)].searches;
  if (searches <= 0) {
    if (!differ(formula, step, low, high)) return {low, high, false};
    while (high - low > 0.5 * kJumpPiece) {
      const double middle = 0.5 * (low + high);
      (differ(formula, step, low, middle) ? high : low) = middle;
    }
    return {low, high, true};
  }
  --searches;
  const double middle = 0.5 * (low + high);
  const Jump before = search(formula, step, low, middle);
  return before.found ? before : search(formula, step, middle, high);
}

// The first jump of a formula; what the last search of the step has found is not sought again.
template <int D>
typename Jumps<D>::Jump Jumps<D>::first(int formula, std::int64_t step, double low, double high) {
  Formula& it = formulas_[std::size_t(formula)];
  if (it.last.found && it.from <= low && low <= it.last.low) {
    if (high <= it.last.low) return {low, high, false};
    if (high >= it.last.high) return it.last;
  }
  const Jump jump = search(formula, step, low, high);
  if (jump.found) it.from = low, it.last = jump;
  return jump;
}

template <int D>
double Jumps<D>::cut(std::int64_t step, double from, double to) {
  if (formulas_.empty()) return to;
  if (step != searched_ || from == 0) {
    searched_ = step;
    for (Formula& it : formulas_) it.searches = kMostSearches, it.last.found = false;
  }
  // one just behind the end counts: a stage's time there is right up to rounding
  Jump jump{from, to + kJumpPiece, false};
  for (int i = 0; i < int(formulas_.size()); ++i) {
    const Jump its = first(i, step, from, to + kJumpPiece);
    if (its.found && (!jump.found || its.low < jump.low)) jump = its;
  }
  if (!jump.found) return to;
  return std::min(
      to, jump.low - from > kJumpPiece ? jump.low - 0.25 * kJumpPiece : jump.high + 0.25 * kJumpPiece);
}

template class Jumps<2>;
template class Jumps<3>;

}  // namespace obscura::sim
