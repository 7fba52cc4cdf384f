#pragma once

#include "sim/math/vec.h"

namespace obscura::draw {

/// The shortest turn that takes +y to the direction of `way`, which has a length; straight down it is about
/// z. For a unit u it is (1 + u_y, u_z, 0, -u_x), normalized.
inline Eigen::Quaterniond turn_from_y(const sim::Vec3& way) {
  const sim::Vec3 to = way.normalized();
  const double across = to.x() * to.x() + to.z() * to.z();
  if (!(across > 0)) return to.y() > 0 ? Eigen::Quaterniond(1, 0, 0, 0) : Eigen::Quaterniond(0, 0, 0, 1);
  // 1 + u_y, which near the way down would be a difference of equal numbers
  const double up = to.y() > 0 ? 1 + to.y() : across / (1 - to.y());
  return Eigen::Quaterniond(up, to.z(), 0, -to.x()).normalized();
}

}  // namespace obscura::draw
