#include "sim/step/jumps.h"

#include <algorithm>

#include "sim/force/formula.h"

namespace obscura::sim {

namespace {

constexpr int kMostLooks = 4000;  // at parts of a step

}  // namespace

template <int D>
Jumps<D>::Jumps(const Model<D>& model) : rate_(model.rate) {
  const auto add = [&](const Program& program, int slot) {
    Program jumps = program.jumps(slot);
    if (jumps.outputs() > 0) formulas_.push_back({std::move(jumps), slot});
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
void Jumps<D>::levels_at(double t, std::vector<double>& levels) {
  levels.clear();
  for (std::size_t i = 0; i < formulas_.size(); ++i) {
    uniform_[std::size_t(formulas_[i].slot)] = t;
    evaluations_[i].begin(uniform_);
    for (int k = 0; k < formulas_[i].program.outputs(); ++k) levels.push_back(*evaluations_[i].output(k));
    uniform_[std::size_t(formulas_[i].slot)] = 0;
  }
}

template <int D>
bool Jumps<D>::differ(std::int64_t step, double low, double high) {
  levels_at(time_at(step, low), begun_), levels_at(time_at(step, high), now_);
  return now_ != begun_;
}

// whether it is sure that nothing jumps from one fraction of a step to another
template <int D>
bool Jumps<D>::stay(std::int64_t step, double low, double high) {
  const Range t{time_at(step, low), time_at(step, high)};
  for (std::size_t i = 0; i < formulas_.size(); ++i) {
    uniform_range_[std::size_t(formulas_[i].slot)] = t;
    ranges_[i].begin(uniform_range_);
    uniform_range_[std::size_t(formulas_[i].slot)] = {};
    for (int k = 0; k < formulas_[i].program.outputs(); ++k)
      if (!ranges_[i].output(k).point()) return false;
  }
  return true;
}

// The first part, half a piece long or less, over which something jumps, by halves: each that may hold a jump
// is looked into. Once that has been done often enough in a step, some part, by what is at the ends.
template <int D>
bool Jumps<D>::find_first(std::int64_t step, double& low, double& high) {
  if (looks_ <= 0) {
    if (!differ(step, low, high)) return false;
    while (high - low > 0.5 * kJumpPiece) {
      const double middle = 0.5 * (low + high);
      (differ(step, low, middle) ? high : low) = middle;
    }
    return true;
  }
  --looks_;
  if (stay(step, low, high)) return false;
  if (!(high - low > 0.5 * kJumpPiece)) return differ(step, low, high);
  const double middle = 0.5 * (low + high);
  double first = low, second = middle;
  if (find_first(step, first, second)) {
    low = first, high = second;
    return true;
  }
  low = middle;
  return find_first(step, low, high);
}

template <int D>
double Jumps<D>::cut(std::int64_t step, double from, double to) {
  if (formulas_.empty()) return to;
  // one just behind the end counts: a stage's time there is right up to rounding
  double low = from, high = to + kJumpPiece;
  if (step != looked_into_ || from == 0) looked_into_ = step, looks_ = kMostLooks;
  if (!find_first(step, low, high)) return to;
  return std::min(to, low - from > kJumpPiece ? low - 0.25 * kJumpPiece : high + 0.25 * kJumpPiece);
}

template class Jumps<2>;
template class Jumps<3>;

}  // namespace obscura::sim
