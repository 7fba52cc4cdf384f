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

}  // namespace

template <>
sim::Shape<2> convex(const Node& points, Diagnostics& complaints) {
  return sim::Polygon{corners(points, complaints)};
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
  sim::Hull it = hull(all);
  if (!it.faces.empty()) return it;
  complaints.add(points.place, "the points lie in one plane: a hull must be a solid");
  return hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

sim::Capsule capsule(const Fields& fields, double length, double radius, Diagnostics& complaints) {
  if (length <= 2 * radius) {
    complaints.add(
        fields.place("length"),
        fmt::format("'length' is from end to end and must be more than twice the radius, {} m; got {}",
                    radius, length));
    length = 3 * radius;
  }
  return {.half = length / 2 - radius, .radius = radius};
}

namespace {

// a shape turned about its origin and then moved
template <int D>
sim::Shape<D> moved(const sim::Shape<D>& shape, const sim::Orientation<D>& turn, const sim::Vec<D>& to) {
  const sim::Rotation<D> axes =
      turn == sim::no_rotation<D>() ? sim::Rotation<D>(sim::Rotation<D>::Identity()) : sim::rotation<D>(turn);
  const auto placing = [&](const sim::Vec<D>& place) { return sim::Vec<D>(to + axes * place); };
  return sim::moved<D>(shape, placing, turn);
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
  sim::Shape<D> it = sim::Ball<D>{radius};
  if (points) {
    it = convex<D>(*fields.given("points"), complaints);
  } else if (boxes) {
    it = sim::Box<D>{fields.vector<D>("size") / 2};
  } else if constexpr (D == 3) {
    if (fields.given("length")) it = capsule(fields, fields.number("length"), radius, complaints);
  }
  return moved<D>(it, turn<D>(fields), fields.vector<D>("position"));
}

}  // namespace

template <int D>
sim::Shape<D> compound(const Node& shapes, Diagnostics& complaints) {
  sim::Compound<D> it;
  for (const Node& each : shapes.list()) it.parts.push_back(part<D>(Fields(each, "body.shapes"), complaints));
  if (it.parts.empty()) {
    complaints.add(shapes.place, "'shapes' is empty: expected a part at least");
    it.parts.push_back(sim::Ball<D>{1});
  }
  return it;
}

template sim::Shape<2> compound<2>(const Node&, Diagnostics&);
template sim::Shape<3> compound<3>(const Node&, Diagnostics&);

template <int D>
Solid<D> solid(const sim::Shape<D>& typed) {
  Solid<D> it;
  it.bulk = sim::mass_properties(typed);
  it.shape = sim::seated(typed, it.bulk);
  return it;
}

template Solid<2> solid<2>(const sim::Shape<2>&);
template Solid<3> solid<3>(const sim::Shape<3>&);

template <int D>
sim::Shape<D> held(const sim::Shape<D>& shape, const sim::Orientation<D>& turn) {
  sim::Shape<D> it = moved<D>(shape, turn, sim::Vec<D>::Zero());
  const bool askew = sim::of_form(it, [](const auto& form) {
    if constexpr (requires { form.turn; }) return form.turn != sim::no_rotation<D>();
    return false;
  });
  // only parts have a turn of their own
  if (askew) return sim::Compound<D>{{it}};
  return it;
}

template <int D>
Solid<D> with_center(const Solid<D>& solid, const sim::Vec<D>& center) {
  const sim::Vec<D> way = sim::rotation<D>(solid.bulk.axes).transpose() * (solid.bulk.center - center);
  sim::Compound<D> parts;
  if (const auto* several = sim::form<sim::Compound<D>>(solid.shape)) {
    for (const sim::Shape<D>& part : several->parts)
      parts.parts.push_back(moved<D>(part, sim::no_rotation<D>(), way));
  } else {
    parts.parts.push_back(moved<D>(solid.shape, sim::no_rotation<D>(), way));
  }
  Solid<D> it = solid;
  it.shape = std::move(parts), it.bulk.center = center;
  return it;
}

template Solid<2> with_center<2>(const Solid<2>&, const sim::Vec<2>&);
template Solid<3> with_center<3>(const Solid<3>&, const sim::Vec<3>&);
template sim::Shape<2> held<2>(const sim::Shape<2>&, const sim::Orientation<2>&);
template sim::Shape<3> held<3>(const sim::Shape<3>&, const sim::Orientation<3>&);
}  // namespace obscura::scene
