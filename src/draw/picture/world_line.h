#pragma once

#include <optional>
#include <vector>

#include "draw/picture/color.h"
#include "sim/math/vec.h"

namespace obscura::draw {

/// A line through the world, drawn under or over the bodies.
struct WorldLine {
  struct Node {
    sim::Vec3 at;
    double strength = 1;  // 0 to 1: how wide and how strong
  };
  std::vector<Node> nodes;
  int body = -1;  // whose colour it has, unless it has its own
  std::optional<Color> color{};
  bool front = false;
};

}  // namespace obscura::draw
