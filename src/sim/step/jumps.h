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
  /// them or, from there on, shortly after it; `to` where there is none. Of thousands of jumps in a step, and
  /// of two within half a piece (kJumpPiece), those whose effects cancel are not seen.
  double cut(std::int64_t step, double from, double to);

 private:
  struct Formula {
    Program program;  // its outputs are steps of the time
    int slot;         // of the time
  };

  double time_at(std::int64_t step, double fraction) const;
  void levels_at(double t, std::vector<double>& levels);
  bool differ(std::int64_t step, double low, double high);
  bool stay(std::int64_t step, double low, double high);
  bool find_first(std::int64_t step, double& low, double& high);

  Rational rate_;
  std::int64_t looked_into_ = -1;  // the step
  int looks_ = 0;                  // at parts of it that are left
  std::vector<Formula> formulas_;
  std::vector<Evaluation> evaluations_;
  std::vector<RangeEvaluation> ranges_;
  std::vector<double> begun_, now_, uniform_;
  std::vector<Range> uniform_range_;
};

}  // namespace obscura::sim
