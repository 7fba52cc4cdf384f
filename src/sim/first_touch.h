#pragma once

#include <optional>

#include "sim/shape.h"

namespace obscura::sim {

/// How a body goes through a step of h seconds: place and turn along the cubics that have these values and
/// rates at its ends.
template <int D>
struct Motion {
  Vec<D> x0 = Vec<D>::Zero(), x1 = Vec<D>::Zero();
  Vec<D> v0 = Vec<D>::Zero(), v1 = Vec<D>::Zero();
  Turn<D> turn0 = Turn<D>::Zero(), turn1 = Turn<D>::Zero();
  Spin<D> w0 = Spin<D>::Zero(), w1 = Spin<D>::Zero();
  double h = 0;  // s

  /// Where the body is after `fraction` of the step, and how it moves.
  Stance<D> at(double fraction) const;
};

/// The motion of a body between two states h seconds apart.
template <int D>
Motion<D> motion(const State<D>& from, const State<D>& to, int body, double h);

/// The earliest fraction in (0, 1] of the step at which two shapes that come nearer are `target` (m) apart,
/// within `tolerance` (m, > 0): never later, so nothing passes through. None if they stay farther apart.
/// Shapes that begin nearer than that may stay so or leave; they touch when they are 1 to 2 tolerances nearer
/// than they began. Two points never touch. Where they graze too long to tell, the fraction up to which they
/// surely do not touch.
template <int D>
std::optional<double> first_touch(const Shape<D>& a, const Motion<D>& of_a, const Shape<D>& b,
                                  const Motion<D>& of_b, double target, double tolerance);

/// The same against a wall.
template <int D>
std::optional<double> first_touch(const Shape<D>& shape, const Motion<D>& of, const Wall<D>& wall,
                                  double target, double tolerance);

}  // namespace obscura::sim
