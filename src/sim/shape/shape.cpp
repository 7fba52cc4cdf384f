// Moments of inertia about the centre, handout §3.1; where a shape reaches.
//   I = m K / A        A  content,   K  second moment: sim/shape/mass_properties.cpp

#include "sim/shape/shape.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

template <int D>
AngularVec<D> solid_inertia(const Shape<D>& shape, double mass) {
  // the handout's own words for a box, to the bit
  if (shape.kind == ShapeKind::box) {
    const Vec<D> side = 2 * shape.half;
    AngularVec<D> moments;
    for (int axis = 0; axis < kAngular<D>; ++axis) {
      const double x = side[(axis + 1) % D], y = side[(axis + 2) % D];
      moments[axis] =
          D == 2 ? mass * (side[0] * side[0] + side[1] * side[1]) / 12 : mass * (x * x + y * y) / 12;
    }
    return moments;
  }
  if (shape.kind == ShapeKind::ball) {
    return AngularVec<D>::Constant(D == 2 ? mass * shape.radius * shape.radius / 2
                                          : 2 * mass * shape.radius * shape.radius / 5);
  }
  const MassProperties<D> whole = mass_properties(shape);
  return whole.content > 0 ? AngularVec<D>(mass * whole.second / whole.content) : AngularVec<D>::Zero();
}

template <int D>
AngularVec<D> inertia(const Shape<D>& shape, double mass) {
  const bool particle = shape.kind == ShapeKind::point || shape.kind == ShapeKind::ball;
  return particle ? AngularVec<D>::Zero() : solid_inertia(shape, mass);
}

template <int D>
Shape<D> seated(const Shape<D>& shape, const MassProperties<D>& bulk) {
  Shape<D> out = shape;
  const bool turns = bulk.axes != no_rotation<D>();
  const Rotation<D> back = turns ? Rotation<D>(rotation<D>(bulk.axes).transpose()) : Rotation<D>::Identity();
  const auto seen = [&](Vec<D>& place) {
    place -= bulk.center;
    if (turns) place = (back * place).eval();
  };
  for (Vec<D>& vertex : out.vertices) seen(vertex);
  for (Shape<D>& part : out.parts) part = seated(part, bulk);
  if (out.kind == ShapeKind::ball || out.kind == ShapeKind::box || out.kind == ShapeKind::capsule) {
    seen(out.center);
    if (turns) out.turn = composed<D>(inverse<D>(bulk.axes), out.turn);
  }
  return out;
}

namespace {

template <int D>
void add_tips(const Shape<D>& shape, std::vector<SupportVertex<D>>& all) {
  const auto placed = [&](const Vec<D>& own) {
    if (shape.turn == no_rotation<D>()) return Vec<D>(shape.center + own);
    return Vec<D>(shape.center + rotation<D>(shape.turn) * own);
  };
  switch (shape.kind) {
    case ShapeKind::point:
    case ShapeKind::ball:
      all.push_back({shape.center, shape.radius});
      break;
    case ShapeKind::box:
      for (int i = 0; i < kCorners<D>; ++i) all.push_back({placed(corner(shape, i)), 0});
      break;
    case ShapeKind::capsule:
      for (const double end : {-shape.half[1], shape.half[1]})
        all.push_back({placed(Vec<D>::Unit(1) * end), shape.radius});
      break;
    case ShapeKind::polygon:
    case ShapeKind::hull:
      for (const Vec<D>& vertex : shape.vertices) all.push_back({vertex, 0});
      break;
    case ShapeKind::compound:
      for (const Shape<D>& part : shape.parts) add_tips(part, all);
      break;
  }
}

}  // namespace

template <int D>
std::vector<SupportVertex<D>> support_vertices(const Shape<D>& shape) {
  std::vector<SupportVertex<D>> all;
  add_tips(shape, all);
  return all;
}

template <int D>
SupportVertices<D>::SupportVertices(const std::vector<Body<D>>& bodies) {
  for (const Body<D>& body : bodies) {
    first_.push_back(int(all_.size()));
    add_tips(body.shape, all_);
  }
  first_.push_back(int(all_.size()));
}

template <int D>
int SupportVertices<D>::most() const {
  int most = 0;
  for (std::size_t i = 1; i < first_.size(); ++i) most = std::max(most, first_[i] - first_[i - 1]);
  return most;
}

namespace {

// the least half depth below a face of a hull
double half_hull_thickness(const Shape<3>& hull) {
  double least = 1e300;
  for (const std::vector<int>& face : hull.faces) {
    const Vec<3>& p = hull.vertices[face[0]];
    const Vec<3> n = (hull.vertices[face[1]] - p).cross(hull.vertices[face[2]] - p);
    double most = 0;
    for (const Vec<3>& v : hull.vertices) most = std::max(most, -n.dot(v - p));
    least = std::min(least, 0.5 * most / std::sqrt(n.squaredNorm()));
  }
  return least;
}
double half_hull_thickness(const Shape<2>&) { return 0; }

}  // namespace

template <int D>
double half_thickness(const Shape<D>& shape) {
  switch (shape.kind) {
    case ShapeKind::point:
      return 0;
    case ShapeKind::hull:
      return half_hull_thickness(shape);
    case ShapeKind::ball:
    case ShapeKind::capsule:
      return shape.radius;
    case ShapeKind::box:
      return shape.half.minCoeff();
    case ShapeKind::polygon: {
      // the least half width across an edge: the vertex farthest from an edge comes after that of the edge
      // before
      double least = 1e300;
      const std::size_t n = shape.vertices.size();
      std::size_t farthest = 0;
      for (std::size_t i = 0; i < n; ++i) {
        const Vec<D> edge = shape.vertices[(i + 1) % n] - shape.vertices[i];
        const double length = edge.norm();
        const auto across = [&](std::size_t k) {
          const Vec<D> d = shape.vertices[k % n] - shape.vertices[i];
          return std::abs(edge[0] * d[1] - edge[1] * d[0]) / length;
        };
        farthest = std::max(farthest, i + 1);
        double most = across(farthest);
        for (double next; farthest < i + n && (next = across(farthest + 1)) >= most; ++farthest) most = next;
        least = std::min(least, 0.5 * most);
      }
      return least;
    }
    case ShapeKind::compound: {
      double least = 1e300;
      for (const Shape<D>& part : shape.parts) least = std::min(least, half_thickness(part));
      return least;
    }
  }
  return 0;
}

template <int D>
double bounding_radius(const Shape<D>& shape) {
  double most = 0;
  switch (shape.kind) {
    case ShapeKind::point:
      break;
    case ShapeKind::ball:
      return shape.center.norm() + shape.radius;
    case ShapeKind::box:
      if (shape.turn == no_rotation<D>()) return (shape.center.cwiseAbs() + shape.half).norm();
      [[fallthrough]];
    case ShapeKind::capsule:
    case ShapeKind::polygon:
    case ShapeKind::hull:
      for (const SupportVertex<D>& tip : support_vertices(shape))
        most = std::max(most, tip.at.norm() + tip.radius);
      break;
    case ShapeKind::compound:
      for (const Shape<D>& part : shape.parts) most = std::max(most, bounding_radius(part));
      break;
  }
  return most;
}

template <int D>
Bounds<D> bounds(const Shape<D>& shape, const BodyMotion<D>& at) {
  const Vec<D> center = at.x + at.arm(shape.center);
  const auto around = [&](const Vec<D>& far) { return Bounds<D>{center - far, center + far}; };
  const auto axes = [&]() -> Rotation<D> {
    if (shape.turn == no_rotation<D>()) return at.room_from_body;
    return at.room_from_body * rotation<D>(shape.turn);
  };
  switch (shape.kind) {
    case ShapeKind::point:
      break;
    case ShapeKind::ball:
      return around(Vec<D>::Constant(shape.radius));
    case ShapeKind::box:
      return around(axes().cwiseAbs() * shape.half);
    case ShapeKind::capsule:
      return around(axes().col(1).cwiseAbs() * shape.half[1] + Vec<D>::Constant(shape.radius));
    case ShapeKind::polygon:
    case ShapeKind::hull: {
      Bounds<D> all{at.x + at.arm(shape.vertices[0]), at.x + at.arm(shape.vertices[0])};
      for (const Vec<D>& vertex : shape.vertices) {
        const Vec<D> place = at.x + at.arm(vertex);
        all.lower = all.lower.cwiseMin(place);
        all.upper = all.upper.cwiseMax(place);
      }
      return all;
    }
    case ShapeKind::compound: {
      Bounds<D> all = bounds(shape.parts[0], at);
      for (const Shape<D>& part : shape.parts) {
        const Bounds<D> own = bounds(part, at);
        all.lower = all.lower.cwiseMin(own.lower);
        all.upper = all.upper.cwiseMax(own.upper);
      }
      return all;
    }
  }
  return {at.x, at.x};
}

template AngularVec<2> solid_inertia<2>(const Shape<2>&, double);
template AngularVec<2> inertia<2>(const Shape<2>&, double);
template Shape<2> seated<2>(const Shape<2>&, const MassProperties<2>&);
template std::vector<SupportVertex<2>> support_vertices<2>(const Shape<2>&);
template class SupportVertices<2>;
template double half_thickness<2>(const Shape<2>&);
template double bounding_radius<2>(const Shape<2>&);
template Bounds<2> bounds<2>(const Shape<2>&, const BodyMotion<2>&);
template AngularVec<3> solid_inertia<3>(const Shape<3>&, double);
template AngularVec<3> inertia<3>(const Shape<3>&, double);
template Shape<3> seated<3>(const Shape<3>&, const MassProperties<3>&);
template std::vector<SupportVertex<3>> support_vertices<3>(const Shape<3>&);
template class SupportVertices<3>;
template double half_thickness<3>(const Shape<3>&);
template double bounding_radius<3>(const Shape<3>&);
template Bounds<3> bounds<3>(const Shape<3>&, const BodyMotion<3>&);

}  // namespace obscura::sim
