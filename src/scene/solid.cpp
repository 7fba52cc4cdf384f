#include "scene/solid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "scene/hull.h"
#include "sim/math/orientation.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;

constexpr std::size_t kMostPoints = 500;

double cross(const Vec& a, const Vec& b) { return a.x() * b.y() - a.y() * b.x(); }

// the corners of `points`, counter-clockwise; a triangle in their stead, and a complaint, where they make no
// convex polygon
std::vector<Vec> corners(const Node& points, Diagnostics& complaints) {
  std::vector<Vec> all;
  for (const Node& each : points.list()) all.push_back(vector<2>(each));
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

// the convex solid of points: a polygon in the plane, a hull in space
template <int D>
sim::Shape<D> convex(const Node& points, Diagnostics& complaints);

template <>
sim::Shape<2> convex(const Node& points, Diagnostics& complaints) {
  return polygon(corners(points, complaints));
}

template <>
sim::Shape<3> convex(const Node& points, Diagnostics& complaints) {
  std::vector<sim::Vec3> all;
  for (const Node& each : points.list()) all.push_back(vector<3>(each));
  if (all.size() > kMostPoints) {
    complaints.add(points.place, fmt::format("'points': {} are more than {}, the most that one hull may have",
                                             all.size(), kMostPoints));
    all.resize(4);
  }
  sim::Shape<3> it = hull(all);
  if (!it.faces.empty()) return it;
  complaints.add(points.place, "the points lie in one plane: a hull must be a solid");
  return hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

template <int D>
sim::Shape<D> ball(double radius) {
  sim::Shape<D> it;
  it.kind = sim::ShapeKind::ball;
  it.radius = radius;
  return it;
}

template <int D>
sim::Shape<D> box(const sim::Vec<D>& size) {
  sim::Shape<D> it;
  it.kind = sim::ShapeKind::box;
  it.half = size / 2;
  return it;
}

// from end to end
template <int D>
sim::Shape<D> capsule(const Fields& fields, double length, double radius, Diagnostics& complaints) {
  if (length <= 2 * radius) {
    complaints.add(
        fields.place("length"),
        fmt::format("'length' is from end to end and must be more than twice the radius, {} m; got {}",
                    radius, length));
    length = 3 * radius;
  }
  sim::Shape<D> it;
  it.kind = sim::ShapeKind::capsule;
  it.radius = radius;
  it.half[1] = length / 2 - radius;
  return it;
}

// a shape turned about its origin and then moved
sim::Shape<2> moved(sim::Shape<2> it, const sim::Orientation<2>& turn, const Vec& to) {
  if (it.kind == sim::ShapeKind::box && turn[0] != 0) {
    const Vec h = it.half, c = it.center;
    it = polygon({c - h, c + Vec(h.x(), -h.y()), c + h, c + Vec(-h.x(), h.y())});
  }
  const sim::Rotation<2> axes = sim::rotation<2>(turn);
  for (Vec& vertex : it.vertices) vertex = to + axes * vertex;
  for (sim::Shape<2>& each : it.parts) each = moved(std::move(each), turn, to);
  if (it.vertices.empty() && it.parts.empty()) it.center = to + axes * it.center;
  return it;
}

sim::Shape<3> moved(sim::Shape<3> it, const sim::Orientation<3>& turn, const sim::Vec3& to) {
  const bool turns = turn != sim::no_rotation<3>();
  const sim::Rotation<3> axes =
      turns ? sim::rotation<3>(turn) : sim::Rotation<3>(sim::Rotation<3>::Identity());
  for (sim::Vec3& vertex : it.vertices) vertex = to + axes * vertex;
  for (sim::Shape<3>& each : it.parts) each = moved(std::move(each), turn, to);
  if (it.vertices.empty() && it.parts.empty()) {
    it.center = to + axes * it.center;
    if (turns && it.kind != sim::ShapeKind::ball) it.turn = sim::composed<3>(turn, it.turn);
  }
  return it;
}

// a part where it lies on the body; a box that is turned there in the plane is a polygon
template <int D>
sim::Shape<D> part(const Fields& fields, Diagnostics& complaints) {
  const bool balls = fields.given("radius"), boxes = fields.given("size"), points = fields.given("points");
  if (balls + boxes + points != 1)
    complaints.add(fields.place(), "a shape is one of three: expected 'radius', 'size' or 'points'");
  if (fields.given("length") && !balls)
    complaints.add(fields.place("length"), "'length' is that of a capsule, and needs its 'radius'");
  const double radius = balls ? fields.number("radius") : 1;
  sim::Shape<D> it = points  ? convex<D>(*fields.given("points"), complaints)
                     : boxes ? box<D>(fields.vector<D>("size"))
                     : fields.given("length")
                         ? capsule<D>(fields, fields.number("length"), radius, complaints)
                         : ball<D>(radius);
  return moved(it, turn<D>(fields), fields.vector<D>("position"));
}

template <int D>
sim::Shape<D> compound(const Node& shapes, Diagnostics& complaints) {
  sim::Shape<D> it;
  it.kind = sim::ShapeKind::compound;
  for (const Node& each : shapes.list()) it.parts.push_back(part<D>(Fields(each, "body.shapes"), complaints));
  if (it.parts.empty()) {
    complaints.add(shapes.place, "'shapes' is empty: expected a part at least");
    it.parts.push_back(ball<D>(1));
  }
  return it;
}

template <int D>
sim::Shape<D> form(const Fields& fields, const std::string& kind, int i, int n, Diagnostics& complaints) {
  if (kind == "ball") return ball<D>(number(fields.node("radius"), i, n));
  if (kind == "box") return box<D>(fields.vector<D>("size"));
  if (kind == "capsule")
    return capsule<D>(fields, number(fields.node("length"), i, n), number(fields.node("radius"), i, n),
                      complaints);
  if ((kind == "polygon" || kind == "hull") && fields.given("points"))
    return convex<D>(*fields.given("points"), complaints);
  if (kind == "body" && fields.given("shapes")) return compound<D>(*fields.given("shapes"), complaints);
  return ball<D>(1);
}

}  // namespace

template <int D>
Solid<D> solid(const Fields& fields, const std::string& kind, int i, int n, Diagnostics& complaints) {
  Solid<D> it;
  const sim::Shape<D> typed = form<D>(fields, kind, i, n, complaints);
  it.bulk = sim::mass_properties(typed);
  it.shape = sim::seated(typed, it.bulk);
  return it;
}

template <>
sim::Shape<2> held(const sim::Shape<2>& shape, const sim::Orientation<2>& turn) {
  return moved(shape, turn, Vec(Vec::Zero()));
}

template <>
sim::Shape<3> held(const sim::Shape<3>& shape, const sim::Orientation<3>& turn) {
  sim::Shape<3> it = moved(shape, turn, sim::Vec3(sim::Vec3::Zero()));
  if (it.turn == sim::no_rotation<3>()) return it;
  // only parts have a turn of their own
  sim::Shape<3> whole;
  whole.kind = sim::ShapeKind::compound;
  whole.parts = {it};
  return whole;
}

template Solid<2> solid<2>(const Fields&, const std::string&, int, int, Diagnostics&);
template Solid<3> solid<3>(const Fields&, const std::string&, int, int, Diagnostics&);

}  // namespace obscura::scene
