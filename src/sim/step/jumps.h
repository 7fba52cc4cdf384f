#pragma once

#include <cstdint>
#include <vector>

#include "sim/math/expression.h"
#include "sim/math/range_evaluation.h"
#include "sim/model/model.h"
#include "sim/model/script.h"

namespace obscura::sim {

/// Where formulas of the time jump, in forces, motions and motors: if(t < 0.5, 3, 0), sign(sin(t)), floor(t).
/// Steps are cut there, so that the scheme keeps its order. A jump that hangs on places or velocities is none
/// of these.
template <int D>
class Jumps {
 public:
  explicit Jumps(const Model<D>& model);

  /// Where to cut a step that goes from a fraction of it to another: shortly before the first jump between
  /// them or, from there on, shortly after it; `to` where there is none. Finds every jump, but not two less
  /// than half a piece (kJumpPiece) apart that cancel; of a formula that jumps hundreds of times in a step,
  /// later only those that change it from one end of the rest to the other.
  double cut(std::int64_t step, double from, double to);

 private:
  // a part of a step over which something jumps
  struct Jump {
    double low, high;
    bool found = false;
  };
  struct Formula {
    Program program;  // its outputs are steps of the time
    int slot;         // of the time
    int searches;     // parts of the step that may still be halved
    double from;      // where the last search began, and what it found
    Jump last;
  };

  double time_at(std::int64_t step, double fraction) const;
  void levels_at(int formula, double t, std::vector<double>& levels);
  bool differ(int formula, std::int64_t step, double low, double high);
  bool surely_constant(int formula, std::int64_t step, double low, double high);
  Jump first(int formula, std::int64_t step, double low, double high);
  Jump search(int formula, std::int64_t step, double low, double high);

  Rational rate_;
  std::vector<Formula> formulas_;
  std::vector<Evaluation> evaluations_;  // one for each
  std::vector<RangeEvaluation> ranges_;
  std::int64_t searched_ = -1;  // the step that was searched last
  std::vector<double> begun_, now_, uniform_;
  std::vector<Range> uniform_range_;
};

}  // namespace obscura::sim
