#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/picture/list.h"
#include "gl/damage.h"

namespace obscura::gl {

/// A vertex of a stroke's strip, as shaders/stroke.vert reads it; px.
struct StripVertex {
  float x = 0, y = 0;
  float lateral = 0, past = 0, half = 0;  // distance to the middle line, past the end, half width
  draw::Color color;
  float tangent_x = 1, tangent_y = 0, butt = 0, side = 0;
  float cut_x = 0, cut_y = 0, cut_normal_x = 0,
        cut_normal_y = 0;  // `cut_x`: of a whole stroke, half its length
};

struct Strip {
  std::vector<StripVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles

  void clear();
};

/// Adds the strip of one stroke, `scale` px a page unit, and returns its bounds. Pieces share their edges and
/// do not overlap: mitres where they fit; round ends where a turn is too sharp for that, each cut off at its
/// own side.
Bounds add_stroke(std::span<const draw::Node> nodes, const draw::Stroke& stroke, double scale, Strip& strip);

}  // namespace obscura::gl
