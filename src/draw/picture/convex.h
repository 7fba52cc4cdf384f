#pragma once

#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// The half-plane (p - point) . normal >= 0.
struct HalfPlane {
  Point point;
  Point normal;  // unit
};

/// A convex polygon; each edge carries the number of what it belongs to.
struct Convex {
  struct Corner {
    Point at;
    int side = -1;  // owner of the edge from here to the next corner; -1: the border it was cut from
  };
  std::vector<Corner> corners;

  bool empty() const { return corners.size() < 3; }
  /// No edge is of the border.
  bool closed() const;
  std::vector<Point> outline() const;
};

/// A rectangle, of border edges.
Convex border(const Rect& rect);

/// The part of `shape` in `half`; the new edge belongs to `side`.
Convex cut(const Convex& shape, const HalfPlane& half, int side = -1);

/// The smallest convex polygon around points, its corners in order.
std::vector<Point> convex_hull(std::vector<Point> points);

/// Moved inwards by `distance` (negative: outwards).
HalfPlane moved(const HalfPlane& half, double distance);

}  // namespace obscura::draw
