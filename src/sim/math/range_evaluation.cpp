#include "sim/math/range_evaluation.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>

namespace obscura::sim {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Range kEverywhere{-kInfinity, kInfinity};
// of a value: twice the error of our functions (sim/math/elementary.h), which are not monotone in their last
// bits
constexpr double kLastBits = 2e-15;

// kEverywhere also stands for what may be no number
bool maybe_none(Range x) { return x.least == -kInfinity && x.most == kInfinity; }

bool holds(Range x, double number) { return x.least <= number && number <= x.most; }

Range all_of(std::initializer_list<double> numbers) {
  Range all{kInfinity, -kInfinity};
  for (const double x : numbers) {
    if (std::isnan(x)) return kEverywhere;
    all = {std::min(all.least, x), std::max(all.most, x)};
  }
  return all;
}
Range together(Range a, Range b) { return {std::min(a.least, b.least), std::max(a.most, b.most)}; }

Range wider(Range x) {
  const auto by = [](double end) { return std::isfinite(end) ? kLastBits * std::fabs(end) : 0; };
  return {x.least - by(x.least), x.most + by(x.most)};
}

// 1 where it is sure, 0 where it cannot be, else either
Range truth(bool sure, bool possible) { return {sure ? 1.0 : 0.0, possible ? 1.0 : 0.0}; }

// of x, where the greatest are at 2 pi k + `crest` and the least at half a turn from there
Range wave(Range x, double crest, Operation operation) {
  constexpr double turn = 2 * std::numbers::pi;
  if (!std::isfinite(x.least) || !std::isfinite(x.most)) return kEverywhere;
  if (!(x.most - x.least < turn) || std::max(std::fabs(x.least), std::fabs(x.most)) > 1e9) return {-1, 1};
  // far fewer bits are lost than this
  constexpr double near = 1e-6;
  const auto has = [&](double phase) {
    return std::floor((x.most - phase + near) / turn) >= std::ceil((x.least - phase - near) / turn);
  };
  Range all = wider(all_of({evaluated(operation, x.least, 0, 0), evaluated(operation, x.most, 0, 0)}));
  if (has(crest)) all.most = 1;
  if (has(crest + std::numbers::pi)) all.least = -1;
  return all;
}

Range to_the_power(Range a, Range b) {
  const auto at = [](double x, double y) { return evaluated(Operation::power, x, y, 0); };
  if (a.least > 0) {
    // monotone in each
    return wider(
        all_of({at(a.least, b.least), at(a.least, b.most), at(a.most, b.least), at(a.most, b.most)}));
  }
  const double n = b.least;
  if (!b.point() || !std::isfinite(n) || n != std::floor(n) || n < 0) return kEverywhere;
  Range all = wider(all_of({at(a.least, n), at(a.most, n)}));
  if (std::fmod(n, 2) == 0 && holds(a, 0)) all.least = n == 0 ? all.least : 0;
  return all;
}

Range evaluated(Operation operation, Range a, Range b, Range c) {
  using enum Operation;
  const auto at = [&](double x, double y) { return sim::evaluated(operation, x, y, 0); };
  const auto corners = [&] {
    return all_of({at(a.least, b.least), at(a.least, b.most), at(a.most, b.least), at(a.most, b.most)});
  };
  const auto ends = [&] { return all_of({at(a.least, 0), at(a.most, 0)}); };
  // what may be no number stays so, but where it is compared: then it is not less, nor equal
  const bool none = maybe_none(a) || maybe_none(b), decides = operation == less || operation == less_equal ||
                                                              operation == equal || operation == not_equal ||
                                                              operation == choose;
  if (none && !decides) return kEverywhere;
  switch (operation) {
    case constant:
    case variable:
      return {};
    case add:
    case minimum:
    case maximum:
      return all_of({at(a.least, b.least), at(a.most, b.most)});
    case subtract:
      return all_of({at(a.least, b.most), at(a.most, b.least)});
    case multiply:
      return corners();
    case divide:
      return holds(b, 0) ? kEverywhere : corners();
    case negate:
    case sign:
    case floor:
      return ends();
    case power:
      return to_the_power(a, b);
    case square_root:
      return a.least < 0 ? kEverywhere : ends();
    case logarithm:
      return a.least < 0 ? kEverywhere : wider(ends());
    case exponential:
    case hyperbolic_sine:
    case hyperbolic_tangent:
      return wider(ends());
    case arc_sine:
    case arc_cosine:
      return a.least < -1 || a.most > 1 ? kEverywhere : wider(ends());
    case sine:
      return wave(a, std::numbers::pi / 2, operation);
    case cosine:
      return wave(a, 0, operation);
    case tangent:
      return holds(wave(a, 0, cosine), 0) || !(a.most - a.least < std::numbers::pi) ? kEverywhere
                                                                                    : wider(ends());
    case arc_tangent:
      return b.least > 0 || !holds(a, 0) ? wider(corners()) : Range{-4, 4};
    case hyperbolic_cosine:
    case absolute: {
      Range all = operation == absolute ? ends() : wider(ends());
      if (holds(a, 0)) all.least = at(0, 0);
      return all;
    }
    case less:
      return truth(!none && a.most < b.least, a.least < b.most);
    case less_equal:
      return truth(!none && a.most <= b.least, a.least <= b.most);
    case equal:
      return truth(a.point() && b.point() && a.least == b.least, a.least <= b.most && b.least <= a.most);
    case not_equal:
      return truth(a.most < b.least || b.most < a.least, !(a.point() && b.point() && a.least == b.least));
    case choose:
      if (!holds(a, 0)) return b;
      return a.point() ? c : together(b, c);
  }
  return kEverywhere;
}

}  // namespace

RangeEvaluation::RangeEvaluation(const Program& program)
    : program_(&program), registers_(std::size_t(program.slots_ + program.registers_)) {
  for (const Program::Number& it : program.numbers_) registers_[std::size_t(it.to)] = {it.value, it.value};
}

void RangeEvaluation::begin(std::span<const Range> uniform) {
  for (const Program::Uniform& it : program_->uniforms_)
    registers_[std::size_t(it.to)] = uniform[std::size_t(it.slot)];
  for (const Program::Instruction& it : program_->prelude_) {
    const auto operand = [&](int at) { return at < 0 ? Range{} : registers_[std::size_t(at)]; };
    const Range a = operand(it.a), b = operand(it.b), c = operand(it.c);
    const bool square = it.operation == Operation::multiply && it.a == it.b && !maybe_none(a);
    if (square && !a.point()) {
      const double least = holds(a, 0) ? 0 : std::min(a.least * a.least, a.most * a.most);
      registers_[std::size_t(it.to)] = {least, std::max(a.least * a.least, a.most * a.most)};
    } else if (a.point() && b.point() && c.point()) {
      const double x = sim::evaluated(it.operation, a.least, b.least, c.least);
      registers_[std::size_t(it.to)] = std::isnan(x) ? kEverywhere : Range{x, x};
    } else {
      registers_[std::size_t(it.to)] = evaluated(it.operation, a, b, c);
    }
  }
}

}  // namespace obscura::sim
