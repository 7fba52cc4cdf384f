#pragma once

#include <vector>

#include "sim/math/expression.h"
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
  /// them or, from there on, shortly after it; `to` where there is none. Two jumps within one step whose
  /// effects cancel are not seen.
  double cut(std::int64_t step, double from, double to);

 private:
  struct Formula {
    Program program;  // its outputs are steps of the time
    int slot;         // of the time
  };

  void levels_at(TimeStamp at, std::vector<double>& levels);

  Rational rate_;
  std::vector<Formula> formulas_;
  std::vector<Evaluation> evaluations_;
  std::vector<double> begun_, now_, uniform_;
};

}  // namespace obscura::sim
