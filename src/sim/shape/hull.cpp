// A convex polyhedron, as tetrahedra to its first vertex.
//   V_i = a . (b x c) / 6      c_i = (a + b + c) / 4
//   int r r' dV = V_i (a a' + b b' + c c' + s s') / 20          s = a + b + c

#include <algorithm>
#include <cmath>

#include "sim/shape/form.h"

namespace obscura::sim {

Spread<3> Hull::spread() const {
  Spread<3> sum;
  const Vec3 first = vertices[0];
  for (const std::vector<int>& face : faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vec3 p = vertices[face[0]] - first, q = vertices[face[i]] - first,
                 r = vertices[face[i + 1]] - first, s = p + q + r;
      const double v = p.dot(q.cross(r)) / 6;
      sum.content += v;
      sum.center += v / 4 * s;
      sum.second += v / 20 * (p * p.transpose() + q * q.transpose() + r * r.transpose() + s * s.transpose());
    }
  }
  if (sum.content == 0) return {};
  sum.center /= sum.content;
  sum.second -= sum.content * sum.center * sum.center.transpose();
  sum.center += first;
  return sum;
}

void Hull::add_support_vertices(std::vector<SupportVertex<3>>& all) const {
  for (const Vec3& vertex : vertices) all.push_back({vertex, 0});
}

// half the least depth below a face
double Hull::half_thickness() const {
  double least = 1e300;
  for (const std::vector<int>& face : faces) {
    const Vec3& p = vertices[face[0]];
    const Vec3 n = (vertices[face[1]] - p).cross(vertices[face[2]] - p);
    double most = 0;
    for (const Vec3& v : vertices) most = std::max(most, -n.dot(v - p));
    least = std::min(least, 0.5 * most / std::sqrt(n.squaredNorm()));
  }
  return least;
}

double Hull::bounding_radius() const {
  double most = 0;
  for (const Vec3& vertex : vertices) most = std::max(most, vertex.norm());
  return most;
}

Bounds<3> Hull::bounds(const Vec3& x, const Rotation<3>& room_from_body) const {
  return bounds_of<3>(vertices, x, room_from_body);
}

double Hull::outside(const Vec3& point) const {
  double most = -1e300;
  for (const std::vector<int>& face : faces) {
    const Vec3& a = vertices[face[0]];
    const Vec3 n = (vertices[face[1]] - a).cross(vertices[face[2]] - a);
    most = std::max(most, n.dot(point - a) / n.norm());
  }
  return most;
}

Shape<3> Hull::moved(const Placing<3>& placing, const Orientation<3>&) const {
  Hull it = *this;
  for (Vec3& vertex : it.vertices) vertex = placing(vertex);
  return it;
}

std::optional<Vec3> Hull::side(const Vec3& way) const {
  return way.isZero(0) ? std::optional<Vec3>(way) : std::nullopt;
}

Vec3 Hull::hold() const { return Vec3::Zero(); }

std::vector<DrawnForm> Hull::drawn() const {
  return {{.kind = ShapeKind::hull, .vertices = vertices, .faces = faces}};
}

}  // namespace obscura::sim
