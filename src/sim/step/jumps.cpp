#include "sim/step/jumps.h"

#include <algorithm>

#include "sim/force/formula.h"

namespace obscura::sim {

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
  for (const Formula& it : formulas_) evaluations_.emplace_back(it.program);
}

template <int D>
void Jumps<D>::levels_at(TimeStamp at, std::vector<double>& levels) {
  levels.clear();
  for (std::size_t i = 0; i < formulas_.size(); ++i) {
    uniform_.assign(std::size_t(std::max(int(each_slot::end), int(pair_slot::end))), 0.0);
    uniform_[std::size_t(formulas_[i].slot)] = time(at, rate_);
    evaluations_[i].begin(uniform_);
    for (int k = 0; k < formulas_[i].program.outputs(); ++k) levels.push_back(*evaluations_[i].output(k));
  }
}

template <int D>
double Jumps<D>::cut(std::int64_t step, double from, double to) {
  if (formulas_.empty()) return to;
  const auto differs = [&](double at) {
    levels_at(at < 1 ? TimeStamp{step, at} : TimeStamp{step + 1, at - 1}, now_);
    return now_ != begun_;
  };
  levels_at({step, from}, begun_);
  // one just behind the end counts: a stage's time there is right up to rounding
  if (!differs(to + kJumpPiece)) return to;
  double low = from, high = to + kJumpPiece;
  while (high - low > 0.5 * kJumpPiece) {
    const double middle = 0.5 * (low + high);
    (differs(middle) ? high : low) = middle;
  }
  return std::min(to, low - from > kJumpPiece ? low - 0.25 * kJumpPiece : high + 0.25 * kJumpPiece);
}

template class Jumps<2>;
template class Jumps<3>;

}  // namespace obscura::sim
