#include "draw/picture/convex.h"

#include <algorithm>

namespace obscura::draw {

bool Convex::closed() const {
  return !empty() && std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.side >= 0; });
}

std::vector<Point> Convex::outline() const {
  std::vector<Point> points;
  points.reserve(corners.size());
  for (const Corner& corner : corners) points.push_back(corner.at);
  return points;
}

Convex border(const Rect& r) {
  return {{{{r.x, r.y}}, {{r.x + r.width, r.y}}, {{r.x + r.width, r.y + r.height}}, {{r.x, r.y + r.height}}}};
}

Convex cut(const Convex& shape, const HalfPlane& half, int side) {
  Convex result;
  const std::size_t n = shape.corners.size();
  result.corners.reserve(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    const Convex::Corner& here = shape.corners[i];
    const Point& next = shape.corners[(i + 1) % n].at;
    const double d = (here.at - half.point).dot(half.normal), e = (next - half.point).dot(half.normal);
    if (d >= 0) result.corners.push_back(here);
    if ((d >= 0) != (e >= 0)) {
      // leaving, the new edge begins here; entering, the rest of the old one
      result.corners.push_back({here.at + (next - here.at) * (d / (d - e)), d >= 0 ? side : here.side});
    }
  }
  // edges without length say nothing, and would spoil a mitre
  double size = 0;
  for (const Convex::Corner& c : result.corners) size = std::max(size, c.at.cwiseAbs().maxCoeff());
  std::vector<Convex::Corner> kept;
  for (std::size_t i = 0; i < result.corners.size(); ++i) {
    const Point& next = result.corners[(i + 1) % result.corners.size()].at;
    if ((next - result.corners[i].at).norm() > 1e-12 * size) kept.push_back(result.corners[i]);
  }
  result.corners = std::move(kept);
  if (result.empty()) result.corners.clear();
  return result;
}

HalfPlane moved(const HalfPlane& half, double distance) {
  return {half.point + distance * half.normal, half.normal};
}

// Andrew's monotone chain: below from left to right, then above and back
std::vector<Point> convex_hull(std::vector<Point> points) {
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Point> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = hull.size();
    for (const Point& p : points) {
      const auto turns = [&](const Point& a, const Point& b) {
        return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x()) > 0;
      };
      while (hull.size() >= first + 2 && !turns(hull[hull.size() - 2], hull.back())) hull.pop_back();
      hull.push_back(p);
    }
    if (!hull.empty()) hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

}  // namespace obscura::draw
