#pragma once

#include "draw/picture/list.h"
#include "sim/math/vec.h"

namespace obscura::draw {

/// How the world lies on the page at one instant: page = origin + scale * (x, -y).
struct View {
  Point origin;      // page units: where the world's origin lies
  double scale = 1;  // page units a metre
  Rect window;       // the part of the page that shows the world

  Point page(const sim::Vec3& world) const {
    return {origin.x() + scale * world.x(), origin.y() - scale * world.y()};
  }
};

/// The corners of what the camera fits when no key says otherwise: the room, or where there is none the
/// bodies at the start.
struct Extent {
  sim::Vec3 low = sim::Vec3::Zero(), high = sim::Vec3::Zero();
};

}  // namespace obscura::draw
