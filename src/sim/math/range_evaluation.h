#pragma once

#include <span>
#include <vector>

#include "sim/math/expression.h"

namespace obscura::sim {

/// All numbers from `least` to `most`, both included.
struct Range {
  double least = 0, most = 0;

  bool point() const { return least == most; }
};

/// Interval arithmetic of what a program computes for all bodies alike: where its uniforms may be anywhere in
/// their ranges, a range that holds all that Evaluation::begin() may come to. It may be wider than need be,
/// most so where a number is read twice (x - x); of points it is the point.
/// Source: Moore, Kearfott and Cloud, Introduction to Interval Analysis (2009), chapters 2 and 5.
class RangeEvaluation {
 public:
  /// `program` must live longer.
  explicit RangeEvaluation(const Program& program);

  /// The range of each uniform slot.
  void begin(std::span<const Range> uniform);
  /// What an output may come to.
  Range output(int i) const { return registers_[std::size_t(program_->outputs_[std::size_t(i)])]; }

 private:
  const Program* program_;
  std::vector<Range> registers_;  // slots first, which stay zero
};

}  // namespace obscura::sim
