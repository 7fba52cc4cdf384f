#include "scene/solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "scene/bodies.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;

double cross(const Vec& a, const Vec& b) { return a.x() * b.y() - a.y() * b.x(); }

// the corners of `points`, counter-clockwise; a triangle in their stead, and a complaint, where they make no
// convex polygon
std::vector<Vec> corners(const Node& points, Complaints& complaints) {
  std::vector<Vec> all;
  for (const Node& each : points.list()) all.push_back(vector(each));
  const std::size_t n = all.size();
  const auto at = [&](std::size_t i) -> const Vec& { return all[i % n]; };
  Vec low = all[0], high = all[0];
  double twice = 0;
  for (std::size_t i = 0; i < n; ++i) {
    low = low.cwiseMin(all[i]), high = high.cwiseMax(all[i]);
    twice += cross(at(i) - all[0], at(i + 1) - all[0]);
  }
  const double size = (high - low).norm(), rounding = 1e-9 * size;

  // every corner turns the same way, and all of them once around
  const auto refuse = [&](std::size_t i, const std::string& why) {
    complaints.add(points.list()[i % n].place, why);
    return std::vector<Vec>{{0, 0}, {1, 0}, {0, 1}};
  };
  const double way = twice < 0 ? -1 : 1;
  double around = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec in = at(i + 1) - at(i), out = at(i + 2) - at(i + 1);
    if (in.norm() <= rounding)
      return refuse(i + 1, fmt::format("points[{}] and points[{}] are one place", i, (i + 1) % n));
    if (out.norm() <= rounding) continue;  // said of the next one
    const double turn = way * cross(in, out);
    if (turn < -rounding * std::max(in.norm(), out.norm()))
      return refuse(i + 1,
                    fmt::format("points[{}] turns the other way: a polygon must be convex; make a [[body]] "
                                "of several",
                                (i + 1) % n));
    if (turn <= rounding * std::max(in.norm(), out.norm()))
      return refuse(i + 1, fmt::format("points[{}] lies on the line between its neighbours; leave it out",
                                       (i + 1) % n));
    around += std::atan2(turn, in.dot(out));
  }
  if (around > 3 * std::numbers::pi)
    return refuse(0, "the points go around more than once: a polygon must be convex");
  if (twice < 0) std::reverse(all.begin(), all.end());
  return all;
}

// a polygon about its centroid: triangles from its first corner
Solid polygon(const std::vector<Vec>& corners) {
  Solid it;
  const Vec& first = corners.front();
  Vec sum = Vec::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec a = corners[i] - first, b = corners[i + 1] - first;
    it.area += cross(a, b) / 2;
    sum += cross(a, b) / 6 * (a + b);
  }
  it.center = first + sum / it.area;
  it.shape.kind = sim::ShapeKind::polygon;
  for (const Vec& corner : corners) it.shape.vertices.push_back(corner - it.center);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec& a = it.shape.vertices[i];
    const Vec& b = it.shape.vertices[(i + 1) % corners.size()];
    it.moment += cross(a, b) / 12 * (a.squaredNorm() + a.dot(b) + b.squaredNorm());
  }
  return it;
}

Solid ball(double radius) {
  Solid it;
  it.shape.kind = sim::ShapeKind::ball;
  it.shape.radius = radius;
  it.area = std::numbers::pi * radius * radius;
  it.moment = it.area * radius * radius / 2;
  return it;
}

Solid box(const Vec& size) {
  Solid it;
  it.shape.kind = sim::ShapeKind::box;
  it.shape.half = size / 2;
  it.area = size.x() * size.y();
  it.moment = it.area * size.squaredNorm() / 12;  // handout §3.1
  return it;
}

// a part where it lies on the body: its shape's places are seen from the body's own origin
Solid part(const Fields& fields, Complaints& complaints) {
  const bool balls = fields.given("radius"), boxes = fields.given("size"), points = fields.given("points");
  if (balls + boxes + points != 1)
    complaints.add(fields.place(), "a shape is one of three: expected 'radius', 'size' or 'points'");
  const Vec position = fields.vector("position");
  const double angle = radians(fields.number("angle"));
  Solid it;
  if (points) {
    it = polygon(corners(*fields.given("points"), complaints));
  } else if (boxes) {
    it = box(fields.vector("size"));
    if (angle != 0) {
      const Vec& half = it.shape.half;
      const double moment = it.moment, area = it.area;
      it = polygon(
          {{-half.x(), -half.y()}, {half.x(), -half.y()}, {half.x(), half.y()}, {-half.x(), half.y()}});
      it.moment = moment, it.area = area;
    }
  } else {
    it = ball(balls ? fields.number("radius") : 1);
  }
  for (Vec& vertex : it.shape.vertices) vertex = turned(vertex, angle);
  it.center = position + turned(it.center, angle);
  return it;
}

Solid compound(const Node& shapes, Complaints& complaints) {
  std::vector<Solid> parts;
  for (const Node& each : shapes.list()) parts.push_back(part(Fields(each, "body.shapes"), complaints));
  if (parts.empty()) {
    complaints.add(shapes.place, "'shapes' is empty: expected a part at least");
    parts.push_back(ball(1));
  }
  Solid it;
  for (const Solid& each : parts) it.area += each.area, it.center += each.area * each.center;
  it.center /= it.area;
  it.shape.kind = sim::ShapeKind::compound;
  for (Solid& each : parts) {
    const Vec away = each.center - it.center;
    it.moment += each.moment + each.area * away.squaredNorm();  // Steiner
    each.shape.center = away;
    for (Vec& vertex : each.shape.vertices) vertex += away;
    if (each.shape.kind == sim::ShapeKind::polygon) each.shape.center = Vec::Zero();
    it.shape.parts.push_back(std::move(each.shape));
  }
  return it;
}

}  // namespace

Solid solid(const Fields& fields, const std::string& kind, int i, int n, Complaints& complaints) {
  if (kind == "ball") return ball(number(fields.node("radius"), i, n));
  if (kind == "box") return box(fields.vector("size"));
  if (kind == "polygon" && fields.given("points"))
    return polygon(corners(*fields.given("points"), complaints));
  if (kind == "body" && fields.given("shapes")) return compound(*fields.given("shapes"), complaints);
  return ball(1);
}

}  // namespace obscura::scene
