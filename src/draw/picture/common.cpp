// The lines are sorted by direction, so that a new one cuts off corners at the two ends of the chain alone.

#include "draw/picture/common.h"

#include <cmath>
#include <optional>

namespace obscura::draw {

std::vector<Point> within_all(const std::vector<HalfPlane>& halves) {
  struct Side {
    HalfPlane half;
    Point begin;  // where it meets the side before
  };
  const auto cross = [](const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); };
  const auto outside = [](const HalfPlane& half, const Point& p) {
    return (p - half.point).dot(half.normal) < 0;
  };
  // the intersection of two lines; none if they are parallel to rounding
  const auto meeting = [&](const HalfPlane& a, const HalfPlane& b) -> std::optional<Point> {
    const double det = cross(a.normal, b.normal);
    if (std::abs(det) < 1e-14) return {};
    const double ca = a.normal.dot(a.point), cb = b.normal.dot(b.point);
    return Point((ca * b.normal.y() - cb * a.normal.y()) / det,
                 (cb * a.normal.x() - ca * b.normal.x()) / det);
  };

  std::vector<Side> sides;
  std::size_t first = 0;  // sides before it are cut off
  for (const HalfPlane& half : halves) {
    while (sides.size() > first + 1 && outside(half, sides.back().begin)) sides.pop_back();
    while (sides.size() > first + 1 && outside(half, sides[first + 1].begin)) ++first;
    if (sides.size() == first) {
      sides.push_back({half, half.point});
    } else if (const auto at = meeting(sides.back().half, half)) {
      sides.push_back({half, *at});
    } else if (outside(sides.back().half, half.point)) {
      if (sides.back().half.normal.dot(half.normal) < 0) return {};
    } else if (sides.size() > first + 1) {
      // the same direction, and farther in
      sides.pop_back();
      const auto instead = meeting(sides.back().half, half);
      sides.push_back({half, instead ? *instead : half.point});
    } else {
      sides.back() = {half, half.point};
    }
  }
  while (sides.size() > first + 2 && outside(sides[first].half, sides.back().begin)) sides.pop_back();
  while (sides.size() > first + 2 && outside(sides.back().half, sides[first + 1].begin)) ++first;
  if (sides.size() < first + 3) return {};
  const auto closing = meeting(sides.back().half, sides[first].half);
  if (!closing) return {};
  std::vector<Point> corners = {*closing};
  for (std::size_t i = first + 1; i < sides.size(); ++i) corners.push_back(sides[i].begin);
  return corners;
}

}  // namespace obscura::draw
