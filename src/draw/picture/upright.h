#pragma once

#include <cmath>

#include "sim/math/vec.h"

namespace obscura::draw {

/// The shortest turn that takes +y to the direction of `way`, which is not 0; straight down it is about z.
inline Eigen::Quaterniond turn_from_y(const sim::Vec3& way) {
  const sim::Vec3 to = way.normalized();
  const double twice = std::sqrt(2 * (1 + to.y()));  // the cosine of half the angle
  if (!(twice > 1e-8)) return {0, 0, 0, 1};
  return {twice / 2, to.z() / twice, 0, -to.x() / twice};
}

}  // namespace obscura::draw
