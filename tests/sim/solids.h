#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/math/exponential.h"
#include "sim/shapes.h"

namespace obscura::sim {

// Shapes of space.

/// A box by its sides, m.
inline Shape<3> brick(const Vec<3>& size) { return Box<3>{size / 2}; }

/// `half` of its straight part along y, m.
inline Shape<3> capsule(double half, double radius) { return Capsule{half, radius}; }

/// The hull of some places, by trying every plane through three of them.
inline Shape<3> hull_solid(const std::vector<Vec<3>>& places) {
  const int n = int(places.size());
  std::vector<std::vector<int>> faces;
  for (int i = 0; i < n; ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        Vec<3> normal = (places[j] - places[i]).cross(places[k] - places[i]);
        if (normal.norm() < 1e-9) continue;
        normal.normalize();
        double low = 0, high = 0;
        std::vector<int> on;
        for (int p = 0; p < n; ++p) {
          const double d = normal.dot(places[p] - places[i]);
          low = std::min(low, d), high = std::max(high, d);
          if (std::abs(d) < 1e-9) on.push_back(p);
        }
        if ((low < -1e-9 && high > 1e-9) || on[0] != i || on[1] != j || on[2] != k) continue;
        if (high > 1e-9) normal = -normal;
        // around the middle
        Vec<3> middle = Vec<3>::Zero();
        for (const int p : on) middle += places[p] / double(on.size());
        const Vec<3> x = (places[on[0]] - middle).normalized(), y = normal.cross(x);
        std::sort(on.begin(), on.end(), [&](int p, int q) {
          const Vec<3> a = places[p] - middle, b = places[q] - middle;
          return std::atan2(y.dot(a), x.dot(a)) < std::atan2(y.dot(b), x.dot(b));
        });
        faces.push_back(on);
      }
    }
  }
  // only those that are corners
  std::vector<int> to(places.size(), -1);
  Hull shape;
  for (std::vector<int>& face : faces) {
    for (int& corner : face) {
      if (to[corner] < 0) {
        to[corner] = int(shape.vertices.size());
        shape.vertices.push_back(places[corner]);
      }
      corner = to[corner];
    }
  }
  shape.faces = faces;
  return shape;
}

/// A box as a hull: corners as in corner(), faces counter-clockwise from outside.
inline Shape<3> as_hull(const Shape<3>& box) {
  const Box<3>& it = *form<Box<3>>(box);
  Hull shape;
  for (int i = 0; i < 8; ++i) shape.vertices.push_back(it.center + rotation<3>(it.turn) * it.corner(i));
  shape.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return shape;
}

/// A shape of the plane given a thickness, m, along z.
inline Shape<3> extruded(const Shape<2>& flat, double depth) {
  if (const auto radius = round_radius(flat)) return ball_shape<3>(*radius);
  if (const Box<2>* box = form<Box<2>>(flat)) return brick({2 * box->half[0], 2 * box->half[1], depth});
  std::vector<Vec<3>> all;
  for (const Vec<2>& v : form<Polygon>(flat)->vertices) {
    all.push_back({v[0], v[1], -depth / 2}), all.push_back({v[0], v[1], depth / 2});
  }
  return hull_solid(all);
}

inline BodyMotion<3> placed(const Vec<3>& x, const Vec<3>& turn = Vec<3>::Zero()) {
  BodyMotion<3> at;
  at.x = x;
  at.room_from_body = matrix(exponential(turn));
  return at;
}

inline BodyMotion<3> extruded(const BodyMotion<2>& flat) {
  BodyMotion<3> at;
  at.x = {flat.x[0], flat.x[1], 0};
  at.room_from_body.topLeftCorner<2, 2>() = flat.room_from_body;
  at.v = {flat.v[0], flat.v[1], 0};
  at.w = {0, 0, flat.w[0]};
  return at;
}

/// Where it comes to in a time h.
inline BodyMotion<3> moved(const BodyMotion<3>& from, double h) {
  BodyMotion<3> at = from;
  at.x += h * from.v;
  at.room_from_body = matrix(exponential(Vec<3>(h * from.w))) * from.room_from_body;
  return at;
}

class SpaceDice : public ShapeDice {
 public:
  using ShapeDice::ShapeDice;

  Vec<3> vec(double size) { return {between(-size, size), between(-size, size), between(-size, size)}; }

  Shape<3> hull(double size) {
    const int n = 4 + below(6);
    std::vector<Vec<3>> places;
    while (int(places.size()) < n) {
      const Vec<3> p = vec(1);
      if (p.norm() > 0.2) places.push_back(size * p.normalized());
    }
    return hull_solid(places);
  }

  /// Any kind that has a core.
  Shape<3> solid(double size) {
    switch (below(6)) {
      case 0:
        return ball_shape<3>(size * between(0.2, 1));
      case 1:
        return ball_shape<3>(0);
      case 2:
        return capsule(size * between(0.15, 1), size * between(0.1, 0.5));
      case 3:
        return hull(size);
      default:
        return brick({size * between(0.3, 2), size * between(0.3, 2), size * between(0.3, 2)});
    }
  }

  BodyMotion<3> place(double room) {
    BodyMotion<3> at = placed(vec(room), vec(3));
    at.v = vec(1), at.w = vec(1);
    return at;
  }
};

}  // namespace obscura::sim
