// A convex polygon, as a fan of triangles from its first vertex, so that one far from its origin loses no
// digits.
//   A = sum d_i / 2    c = sum d_i (p_i + p_i+1) / (6 A)        d_i = p_i x p_i+1
//   int |r|^2 dA = sum d_i (p_i.p_i + p_i.p_i+1 + p_i+1.p_i+1) / 12

#include <algorithm>
#include <cmath>

#include "sim/shape/form.h"

namespace obscura::sim {

Spread<2> Polygon::spread() const {
  Spread<2> sum;
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
  sum.second(0) = about_first - sum.content * sum.center.squaredNorm();
  sum.center += vertices[0];
  return sum;
}

void Polygon::add_support_vertices(std::vector<SupportVertex<2>>& all) const {
  for (const Vec<2>& vertex : vertices) all.push_back({vertex, 0});
}

// the least half width across an edge: the vertex farthest from an edge comes after that of the edge before
double Polygon::half_thickness() const {
  double least = 1e300;
  const std::size_t n = vertices.size();
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec<2> edge = vertices[(i + 1) % n] - vertices[i];
    const double length = edge.norm();
    const auto across = [&](std::size_t k) {
      const Vec<2> d = vertices[k % n] - vertices[i];
      return std::abs(edge[0] * d[1] - edge[1] * d[0]) / length;
    };
    farthest = std::max(farthest, i + 1);
    double most = across(farthest);
    for (double next; farthest < i + n && (next = across(farthest + 1)) >= most; ++farthest) most = next;
    least = std::min(least, 0.5 * most);
  }
  return least;
}

double Polygon::bounding_radius() const {
  double most = 0;
  for (const Vec<2>& vertex : vertices) most = std::max(most, vertex.norm());
  return most;
}

Bounds<2> Polygon::bounds(const Vec<2>& x, const Rotation<2>& room_from_body) const {
  return bounds_of<2>(vertices, x, room_from_body);
}

double Polygon::outside(const Vec<2>& point) const {
  double most = -1e300;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec<2>&a = vertices[i], &b = vertices[(i + 1) % vertices.size()];
    const Vec<2> edge = b - a, to = point - a;
    most = std::max(most, (edge[1] * to[0] - edge[0] * to[1]) / edge.norm());
  }
  return most;
}

Shape<2> Polygon::moved(const Placing<2>& placing, const Orientation<2>&) const {
  Polygon it = *this;
  for (Vec<2>& vertex : it.vertices) vertex = placing(vertex);
  return it;
}

std::optional<Vec<2>> Polygon::side(const Vec<2>& way) const {
  return way.isZero(0) ? std::optional<Vec<2>>(way) : std::nullopt;
}

Vec<2> Polygon::hold() const { return Vec<2>::Zero(); }

std::vector<DrawnForm> Polygon::drawn() const {
  DrawnForm it{.kind = ShapeKind::polygon};
  for (const Vec<2>& vertex : vertices) it.vertices.push_back(to_3d<2>(vertex));
  return {it};
}

}  // namespace obscura::sim
