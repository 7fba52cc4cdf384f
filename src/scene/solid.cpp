#include "scene/solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
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

sim::Shape<2> polygon(std::vector<Vec> corners) {
  sim::Shape<2> it;
  it.kind = sim::ShapeKind::polygon;
  it.vertices = std::move(corners);
  return it;
}

sim::Shape<2> ball(double radius) {
  sim::Shape<2> it;
  it.kind = sim::ShapeKind::ball;
  it.radius = radius;
  return it;
}

sim::Shape<2> box(const Vec& size) {
  sim::Shape<2> it;
  it.kind = sim::ShapeKind::box;
  it.half = size / 2;
  return it;
}

// a part where it lies on the body; a box that is turned there is a polygon
sim::Shape<2> part(const Fields& fields, Complaints& complaints) {
  const bool balls = fields.given("radius"), boxes = fields.given("size"), points = fields.given("points");
  if (balls + boxes + points != 1)
    complaints.add(fields.place(), "a shape is one of three: expected 'radius', 'size' or 'points'");
  const Vec position = fields.vector("position");
  const double angle = radians(fields.number("angle"));
  sim::Shape<2> it = points  ? polygon(corners(*fields.given("points"), complaints))
                     : boxes ? box(fields.vector("size"))
                             : ball(balls ? fields.number("radius") : 1);
  if (boxes && angle != 0) {
    const Vec h = it.half;
    it = polygon({-h, {h.x(), -h.y()}, h, {-h.x(), h.y()}});
  }
  for (Vec& vertex : it.vertices) vertex = position + turned(vertex, angle);
  if (it.vertices.empty()) it.center = position;
  return it;
}

sim::Shape<2> compound(const Node& shapes, Complaints& complaints) {
  sim::Shape<2> it;
  it.kind = sim::ShapeKind::compound;
  for (const Node& each : shapes.list()) it.parts.push_back(part(Fields(each, "body.shapes"), complaints));
  if (it.parts.empty()) {
    complaints.add(shapes.place, "'shapes' is empty: expected a part at least");
    it.parts.push_back(ball(1));
  }
  return it;
}

sim::Shape<2> form(const Fields& fields, const std::string& kind, int i, int n, Complaints& complaints) {
  if (kind == "ball") return ball(number(fields.node("radius"), i, n));
  if (kind == "box") return box(fields.vector("size"));
  if (kind == "polygon" && fields.given("points"))
    return polygon(corners(*fields.given("points"), complaints));
  if (kind == "body" && fields.given("shapes")) return compound(*fields.given("shapes"), complaints);
  return ball(1);
}

}  // namespace

Solid solid(const Fields& fields, const std::string& kind, int i, int n, Complaints& complaints) {
  Solid it;
  it.shape = form(fields, kind, i, n, complaints);
  it.bulk = sim::bulk(it.shape);
  // about its centre of mass; a ball and a box are so already
  const Vec center = it.bulk.center;
  for (Vec& vertex : it.shape.vertices) vertex -= center;
  for (sim::Shape<2>& part : it.shape.parts) {
    if (part.vertices.empty()) part.center -= center;
    for (Vec& vertex : part.vertices) vertex -= center;
  }
  return it;
}

}  // namespace obscura::scene
