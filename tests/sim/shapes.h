#pragma once

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/dice.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

template <int D = 2>
Shape<D> ball_shape(double radius) {
  if (radius > 0) return Ball<D>{radius};
  return Point<D>{};
}

/// A box by its sides, m.
inline Shape<2> box_shape(double x, double y) { return Box<2>{Vec<2>(x, y) / 2}; }

inline Shape<2> polygon_shape(std::vector<Vec<2>> vertices) { return Polygon{std::move(vertices)}; }

template <int D = 2>
Shape<D> compound_shape(std::vector<Shape<D>> parts) {
  return Compound<D>{std::move(parts)};
}

/// The corners of a box as a polygon.
inline Shape<2> as_polygon(const Shape<2>& box) { return form<Box<2>>(box)->outline(); }

inline BodyMotion<2> standing(const Vec<2>& x, double angle = 0) {
  BodyMotion<2> at;
  at.x = x;
  at.room_from_body = rotation<2>(Orientation<2>(angle));
  return at;
}

/// Shapes of the plane and places for them.
class ShapeDice : public Dice {
 public:
  using Dice::Dice;

  /// Corners on an ellipse, so convex; its centre near the origin.
  Shape<2> polygon(double size) {
    const int n = 3 + below(6);
    const double a = size * between(0.3, 1), b = size * between(0.3, 1), tilt = between(0, 6.3);
    const Vec<2> off = size * Vec<2>(between(-0.2, 0.2), between(-0.2, 0.2));
    std::vector<Vec<2>> around;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + between(0, 0.8)) / n;
      const double x = a * std::cos(angle), y = b * std::sin(angle);
      around.push_back(
          off + Vec<2>(std::cos(tilt) * x - std::sin(tilt) * y, std::sin(tilt) * x + std::cos(tilt) * y));
    }
    return polygon_shape(around);
  }

  /// Any kind that has an outline.
  Shape<2> simple(double size) {
    switch (below(4)) {
      case 0:
        return ball_shape(size * between(0.2, 1));
      case 1:
        return ball_shape(0);
      case 2:
        return box_shape(size * between(0.3, 2), size * between(0.3, 2));
      default:
        return polygon(size);
    }
  }

  BodyMotion<2> body_motion(double room) {
    return standing({between(-room, room), between(-room, room)}, between(-4, 4));
  }
};

}  // namespace obscura::sim
