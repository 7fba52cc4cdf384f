#pragma once

#include <algorithm>
#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// Gaps of two shapes, bodies 0 and 1.
template <int D>
std::vector<ContactCandidate<D>> found(const Shape<D>& a, const BodyMotion<D>& at_a, const Shape<D>& b,
                                       const BodyMotion<D>& at_b, double margin = 1e3) {
  std::vector<ContactCandidate<D>> out;
  collide(0, a, at_a, 1, b, at_b, margin, out);
  return out;
}

/// The least value of all.
template <int D>
double least(const std::vector<ContactCandidate<D>>& all) {
  double value = 1e300;
  for (const ContactCandidate<D>& gap : all) value = std::min(value, gap.value);
  return value;
}

}  // namespace obscura::sim
