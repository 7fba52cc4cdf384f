#pragma once

#include <cmath>
#include <vector>

#include "sim/reference.h"
#include "sim/touching.h"

namespace obscura::sim {

/// A metre from the origin, at an angle (rad) from straight down.
inline Vec2 hanging(double angle) { return {std::sin(angle), -std::cos(angle)}; }

inline Joint<2> pin(End<2> a, End<2> b) {
  Joint<2> joint;
  joint.a = a, joint.b = b;
  return joint;
}

inline Joint<2> rod(End<2> a, End<2> b, double length) {
  Joint<2> joint = pin(a, b);
  joint.kind = JointKind::rod, joint.length = length;
  return joint;
}

/// A bar of 1 kg from one place to another.
inline int add_bar(World<2>& world, Vec2 from, Vec2 to) {
  const Vec2 way = to - from;
  return add_box(world, {way.norm(), 0.02}, 1, (from + to) / 2, {0, 0}, std::atan2(way.y(), way.x()));
}

/// A table's row at time t, s; empty where it has none.
inline std::vector<double> row_at(const char* name, double t) {
  for (const auto& row : table(name)) {
    if (std::abs(row[0] - t) < 1e-9) return row;
  }
  return {};
}

}  // namespace obscura::sim
