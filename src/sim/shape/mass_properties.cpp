// What moments of inertia are made of, for uniform density. In the plane,
//   I = m K / A        A  area,   K = int |r - c|^2 dA  second moment about the centroid c
//   box                A = x y            K = A (x^2 + y^2) / 12       x, y  sides
//   disc               A = pi r^2         K = A r^2 / 2
//   polygon            A = sum d_i / 2    c = sum d_i (p_i + p_i+1) / (6 A)        d_i = p_i x p_i+1
//                      int |r|^2 dA = sum d_i (p_i.p_i + p_i.p_i+1 + p_i+1.p_i+1) / 12
//   parts              A = sum A_i        c = sum A_i c_i / A          K = sum K_i + A_i |c_i - c|^2
// In space, with the spread C = int (r - c)(r - c)' dV,
//   I = m (tr C - C) / V                  its eigenvectors are the principal axes
//   box                C = V diag(h^2) / 3                             h  half its sides
//   ball               C = V r^2 / 5
//   capsule            of a cylinder, 2 a long, and two half balls: see below
//   hull               tetrahedra to its first vertex: V_i = a . (b x c) / 6,  c_i = (a + b + c) / 4,
//                      int r r' dV = V_i (a a' + b b' + c c' + s s') / 20,  s = a + b + c
//   parts              C = sum R_i C_i R_i' + V_i (c_i - c)(c_i - c)'

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

// fan of triangles from the first vertex, so that a polygon far from its origin loses no digits
MassProperties<2> polygon_bulk(const std::vector<Vec<2>>& vertices) {
  MassProperties<2> sum;
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

MassProperties<2> parts_bulk(const std::vector<Shape<2>>& parts) {
  MassProperties<2> sum;
  for (const Shape<2>& part : parts) {
    const MassProperties<2> own = mass_properties(part);
    sum.content += own.content;
    sum.center += own.content * own.center;
  }
  if (sum.content == 0) return sum;
  sum.center /= sum.content;
  for (const Shape<2>& part : parts) {
    const MassProperties<2> own = mass_properties(part);
    sum.second[0] += own.second[0] + own.content * (own.center - sum.center).squaredNorm();
  }
  return sum;
}

// a solid before its axes are found
struct Spread {
  double content = 0;
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d c = Eigen::Matrix3d::Zero();  // int (r - center)(r - center)' dV
};

Spread hull_spread(const Shape<3>& hull) {
  Spread sum;
  const Vec3 first = hull.vertices[0];
  for (const std::vector<int>& face : hull.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vec3 p = hull.vertices[face[0]] - first, q = hull.vertices[face[i]] - first,
                 r = hull.vertices[face[i + 1]] - first, s = p + q + r;
      const double v = p.dot(q.cross(r)) / 6;
      sum.content += v;
      sum.center += v / 4 * s;
      sum.c += v / 20 * (p * p.transpose() + q * q.transpose() + r * r.transpose() + s * s.transpose());
    }
  }
  if (sum.content == 0) return {};
  sum.center /= sum.content;
  sum.c -= sum.content * sum.center * sum.center.transpose();
  sum.center += first;
  return sum;
}

// a cylinder from -a to a along y, and at each end half a ball, whose centroid lies 3 r / 8 beyond
Spread capsule_spread(double a, double r) {
  const double cylinder = 2 * a * std::numbers::pi * r * r, ball = 4 * std::numbers::pi * r * r * r / 3;
  Spread sum;
  sum.content = cylinder + ball;
  const double across = cylinder * r * r / 4 + ball * r * r / 5;
  sum.c.diagonal() << across, cylinder * a * a / 3 + ball * (r * r / 5 + 3 * a * r / 4 + a * a), across;
  return sum;
}

Spread spread(const Shape<3>& shape) {
  Spread whole;
  switch (shape.kind) {
    case ShapeKind::point:
    case ShapeKind::polygon:
      return whole;
    case ShapeKind::ball:
      whole.content = 4 * std::numbers::pi * shape.radius * shape.radius * shape.radius / 3;
      whole.c.diagonal().setConstant(whole.content * shape.radius * shape.radius / 5);
      break;
    case ShapeKind::box:
      whole.content = 8 * shape.half.prod();
      whole.c.diagonal() = whole.content / 3 * shape.half.cwiseAbs2();
      break;
    case ShapeKind::capsule:
      whole = capsule_spread(shape.half[1], shape.radius);
      break;
    case ShapeKind::hull:
      return hull_spread(shape);
    case ShapeKind::compound: {
      std::vector<Spread> parts;
      for (const Shape<3>& part : shape.parts) {
        parts.push_back(spread(part));
        whole.content += parts.back().content;
        whole.center += parts.back().content * parts.back().center;
      }
      if (whole.content == 0) return {};
      whole.center /= whole.content;
      for (const Spread& part : parts) {
        const Vec3 off = part.center - whole.center;
        whole.c += part.c + part.content * off * off.transpose();
      }
      return whole;
    }
  }
  whole.center = shape.center;
  if (shape.turn != no_rotation<3>()) {
    const Eigen::Matrix3d turn = rotation<3>(shape.turn);
    whole.c = turn * whole.c * turn.transpose();
  }
  return whole;
}

}  // namespace

// Jacobi's rotations: turns a symmetric matrix into a diagonal one, smallest turns first to last, so that
// axes stay as near to those of the frame as they can. The axes it finds, as a turn.
Orientation<3> principal_axes(Eigen::Matrix3d& a) {
  Orientation<3> turn = no_rotation<3>();
  for (int sweep = 0; sweep < 50; ++sweep) {
    // what is rounding counts as none: a shape whose axes are its frame's keeps them
    const double small = 1e-14 * a.trace();
    bool done = true;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (std::fabs(a(p, q)) <= small) continue;
        done = false;
        const double tau = (a(q, q) - a(p, p)) / (2 * a(p, q));
        const double t = (tau < 0 ? -1 : 1) / (std::fabs(tau) + std::sqrt(1 + tau * tau));
        const double c = 1 / std::sqrt(1 + t * t), s = t * c;
        Eigen::Matrix3d j = Eigen::Matrix3d::Identity();
        j(p, p) = c, j(q, q) = c, j(p, q) = s, j(q, p) = -s;
        a = (j.transpose() * a * j).eval();
        // the same as a quaternion about the third axis: half the angle from its cosine
        const int axis = 3 - p - q;
        const double half_cos = std::sqrt(0.5 * (1 + c)), half_sin = s / (2 * half_cos);
        Orientation<3> by = Orientation<3>::Zero();
        by[axis] = axis == 1 ? half_sin : -half_sin, by[3] = half_cos;
        turn = product(turn, by);
      }
    }
    if (done) break;
  }
  return turn / std::sqrt(turn.squaredNorm());
}

template <>
MassProperties<2> mass_properties<2>(const Shape<2>& shape) {
  MassProperties<2> whole;
  switch (shape.kind) {
    case ShapeKind::point:
    case ShapeKind::hull:
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
    case ShapeKind::capsule: {
      // a box, and at each end half a disc, whose centroid lies 4 r / (3 pi) beyond
      const double a = shape.half[1], r = shape.radius;
      const double bar = 4 * a * r, disc = std::numbers::pi * r * r;
      whole.content = bar + disc;
      whole.center = shape.center;
      whole.second[0] =
          bar * (a * a + r * r) / 3 + disc * (r * r / 2 + a * a + 8 * a * r / (3 * std::numbers::pi));
      break;
    }
    case ShapeKind::polygon:
      return polygon_bulk(shape.vertices);
    case ShapeKind::compound:
      return parts_bulk(shape.parts);
  }
  return whole;
}

template <>
MassProperties<3> mass_properties<3>(const Shape<3>& shape) {
  Spread whole = spread(shape);
  MassProperties<3> out;
  out.content = whole.content, out.center = whole.center;
  out.axes = principal_axes(whole.c);
  const Vec3 c = whole.c.diagonal();
  out.second = Vec3(c[1] + c[2], c[2] + c[0], c[0] + c[1]);
  return out;
}

}  // namespace obscura::sim
