// Moments of inertia about the centre, handout §3.1, and what they are made of. In the plane, of uniform
// density,
//   I = m K / A        A  area,   K = int |r - c|^2 dA  second moment about the centroid c
//   box                A = x y            K = A (x^2 + y^2) / 12       x, y  sides
//   disc               A = pi r^2         K = A r^2 / 2
//   polygon            A = sum d_i / 2    c = sum d_i (p_i + p_i+1) / (6 A)        d_i = p_i x p_i+1
//                      int |r|^2 dA = sum d_i (p_i.p_i + p_i.p_i+1 + p_i+1.p_i+1) / 12
//   parts              A = sum A_i        c = sum A_i c_i / A          K = sum K_i + A_i |c_i - c|^2

#include "sim/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace obscura::sim {

namespace {

// fan of triangles from the first vertex, so that a polygon far from its origin loses no digits
Bulk<2> polygon_bulk(const std::vector<Vec<2>>& vertices) {
  Bulk<2> sum;
  double about_first = 0;
  for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
    const Vec<2> p = vertices[i] - vertices[0], q = vertices[i + 1] - vertices[0];
    const double d = p[0] * q[1] - p[1] * q[0];
    sum.content += d / 2;
    sum.center += d * (p + q) / 6;
    about_first += d * (p.dot(p) + p.dot(q) + q.dot(q)) / 12;
  }
  if (sum.content == 0) return sum;
  sum.center /= sum.content;
  sum.second[0] = about_first - sum.content * sum.center.squaredNorm();
  sum.center += vertices[0];
  return sum;
}

Bulk<2> parts_bulk(const std::vector<Shape<2>>& parts) {
  Bulk<2> sum;
  for (const Shape<2>& part : parts) {
    const Bulk<2> own = bulk(part);
    sum.content += own.content;
    sum.center += own.content * own.center;
  }
  if (sum.content == 0) return sum;
  sum.center /= sum.content;
  for (const Shape<2>& part : parts) {
    const Bulk<2> own = bulk(part);
    sum.second[0] += own.second[0] + own.content * (own.center - sum.center).squaredNorm();
  }
  return sum;
}

}  // namespace

template <int D>
Bulk<D> bulk(const Shape<D>& shape) {
  static_assert(D == 2, "space comes with its own shapes");
  Bulk<D> whole;
  switch (shape.kind) {
    case ShapeKind::point:
      break;
    case ShapeKind::ball:
      whole.content = std::numbers::pi * shape.radius * shape.radius;
      whole.center = shape.center;
      whole.second[0] = whole.content * shape.radius * shape.radius / 2;
      break;
    case ShapeKind::box:
      whole.content = 4 * shape.half[0] * shape.half[1];
      whole.center = shape.center;
      whole.second[0] = whole.content * shape.half.squaredNorm() / 3;
      break;
    case ShapeKind::polygon:
      return polygon_bulk(shape.vertices);
    case ShapeKind::compound:
      return parts_bulk(shape.parts);
  }
  return whole;
}

template <int D>
Spin<D> solid_inertia(const Shape<D>& shape, double mass) {
  static_assert(D == 2, "space comes with its own shapes");
  // the handout's own words for a box, to the bit
  if (shape.kind == ShapeKind::box) {
    const Vec<D> side = 2 * shape.half;
    return Spin<D>(mass * (side[0] * side[0] + side[1] * side[1]) / 12);
  }
  if (shape.kind == ShapeKind::ball) return Spin<D>(mass * shape.radius * shape.radius / 2);
  const Bulk<D> whole = bulk(shape);
  return whole.content > 0 ? Spin<D>(mass * whole.second / whole.content) : Spin<D>::Zero();
}

template <int D>
Spin<D> inertia(const Shape<D>& shape, double mass) {
  const bool particle = shape.kind == ShapeKind::point || shape.kind == ShapeKind::ball;
  return particle ? Spin<D>::Zero() : solid_inertia(shape, mass);
}

template <int D>
double reach(const Shape<D>& shape) {
  double most = 0;
  switch (shape.kind) {
    case ShapeKind::point:
      break;
    case ShapeKind::ball:
      return shape.center.norm() + shape.radius;
    case ShapeKind::box:
      return (shape.center.cwiseAbs() + shape.half).norm();
    case ShapeKind::polygon:
      for (const Vec<D>& vertex : shape.vertices) most = std::max(most, vertex.norm());
      break;
    case ShapeKind::compound:
      for (const Shape<D>& part : shape.parts) most = std::max(most, reach(part));
      break;
  }
  return most;
}

template <int D>
Bounds<D> bounds(const Shape<D>& shape, const Stance<D>& at) {
  const Vec<D> center = at.x + at.arm(shape.center);
  switch (shape.kind) {
    case ShapeKind::point:
      break;
    case ShapeKind::ball: {
      const Vec<D> far = Vec<D>::Constant(shape.radius);
      return {center - far, center + far};
    }
    case ShapeKind::box: {
      const Vec<D> far = at.room_from_body.cwiseAbs() * shape.half;
      return {center - far, center + far};
    }
    case ShapeKind::polygon: {
      Bounds<D> around{at.x + at.arm(shape.vertices[0]), at.x + at.arm(shape.vertices[0])};
      for (const Vec<D>& vertex : shape.vertices) {
        const Vec<D> place = at.x + at.arm(vertex);
        around.lower = around.lower.cwiseMin(place);
        around.upper = around.upper.cwiseMax(place);
      }
      return around;
    }
    case ShapeKind::compound: {
      Bounds<D> around = bounds(shape.parts[0], at);
      for (const Shape<D>& part : shape.parts) {
        const Bounds<D> own = bounds(part, at);
        around.lower = around.lower.cwiseMin(own.lower);
        around.upper = around.upper.cwiseMax(own.upper);
      }
      return around;
    }
  }
  return {at.x, at.x};
}

template Bulk<2> bulk<2>(const Shape<2>&);
template Spin<2> solid_inertia<2>(const Shape<2>&, double);
template Spin<2> inertia<2>(const Shape<2>&, double);
template double reach<2>(const Shape<2>&);
template Bounds<2> bounds<2>(const Shape<2>&, const Stance<2>&);

}  // namespace obscura::sim
