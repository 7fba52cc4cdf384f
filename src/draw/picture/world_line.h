#pragma once

#include <optional>
#include <vector>

#include "draw/picture/color.h"
#include "sim/math/vec.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

/// A line through the world, drawn under or over the bodies.
struct WorldLine {
  struct Node {
    sim::Vec3 at;
    double strength = 1;  // 0 to 1: how wide and how strong
    double time = 0;      // s
  };
  std::vector<Node> nodes;
  int body = -1;  // whose colour it has, unless it has its own
  std::optional<Color> color{};
  bool front = false;
  int path = 0;        // which
  double lasting = 0;  // s; 0: for ever
};

/// Bodies as they were at another instant, in space: outlines where nothing hides them.
struct SpaceGhost {
  const sim::Snapshot* then = nullptr;
  const std::vector<int>* bodies = nullptr;  // those drawn; none: all that move
  double strength = 1;                       // from the room's colour to their own
};

}  // namespace obscura::draw
