#pragma once

#include <algorithm>
#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// Gaps of two shapes, bodies 0 and 1.
template <int D>
std::vector<Gap<D>> found(const Shape<D>& a, const Stance<D>& at_a, const Shape<D>& b, const Stance<D>& at_b,
                          double margin = 1e3) {
  std::vector<Gap<D>> out;
  gaps(0, a, at_a, 1, b, at_b, margin, out);
  return out;
}

/// The least value of all.
template <int D>
double least(const std::vector<Gap<D>>& all) {
  double value = 1e300;
  for (const Gap<D>& gap : all) value = std::min(value, gap.value);
  return value;
}

}  // namespace obscura::sim
