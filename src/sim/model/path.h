#pragma once

#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// The way of the hand, smooth through its knots: between two knots a cubic, at a knot the velocity of the
/// parabola through it and its neighbours. Two knots make a straight line. Before the first and after the
/// last it rests. `from_rest`: at both ends its velocity is zero.
template <int D>
class Path {
 public:
  /// Requires at least two knots, times strictly increasing.
  explicit Path(const std::vector<Knot<D>>& knots, bool from_rest = false);

  struct Motion {
    Vec<D> place, velocity;
    Vec<D> acceleration = Vec<D>::Zero();
  };
  Motion at(double t) const;
  Vec<D> place(double t) const { return at(t).place; }

  double start() const { return times_.front(); }
  double end() const { return times_.back(); }

 private:
  std::vector<double> times_;
  std::vector<Vec<D>> places_, slopes_;
};

}  // namespace obscura::sim
