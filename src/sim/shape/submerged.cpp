// What lies below a level. With c = level - y of the centre,
//   disc     A = r^2 acos(-c/r) + c sqrt(r^2 - c^2)          int (y - y0) dA = -2/3 (r^2 - c^2)^(3/2)
//   ball     V = pi (r + c)^2 (2 r - c) / 3                  int (y - y0) dV = -pi/4 (r^2 - c^2)^2
//   polygon  its part below, by triangles from a point of the level, where the cut itself has no area
//   hull     the same, by tetrahedra
//   capsule  discs across its axis, each cut by a chord, integrated along the axis:
//            by Gauss's rule between the places where the integrand has a kink, to 1e-13

#include "sim/shape/submerged.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/math/elementary.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kPi = std::numbers::pi;

// content, and its first moment about an origin
template <int D>
struct Wet {
  double content = 0;
  Vec<D> moment = Vec<D>::Zero();

  void add(double more, const Vec<D>& center) { content += more, moment += more * center; }
};

// of a disc of radius r whose chord is c from its centre: area, and the first moment across the chord
std::array<double, 2> disc_segment(double r, double c) {
  if (c >= r) return {kPi * r * r, 0};
  if (!(c > -r)) return {0, 0};
  const double half2 = (r - c) * (r + c), half = std::sqrt(half2);
  return {r * r * elementary::acos(-c / r) + c * half, -2.0 / 3 * half2 * half};
}

template <int D>
Wet<D> ball(double r, const Vec<D>& at, double level) {
  const double c = level - at[1];
  Wet<D> wet;
  if constexpr (D == 2) {
    const auto [area, moment] = disc_segment(r, c);
    wet.add(area, at);
    wet.moment[1] += moment;
  } else {
    if (c >= r) {
      wet.add(4 * kPi * r * r * r / 3, at);
    } else if (c > -r) {
      wet.add(kPi * (r + c) * (r + c) * (2 * r - c) / 3, at);
      const double half2 = (r - c) * (r + c);
      wet.moment[1] -= kPi / 4 * half2 * half2;
    }
  }
  return wet;
}

// gives the corners of the part of a loop of n corners that lies below the level, in order
template <int D, class Corner, class Give>
void clip(int n, const Corner& corner, double level, Give&& give) {
  Vec<D> a = corner(n - 1);
  for (int i = 0; i < n; ++i) {
    const Vec<D> b = corner(i);
    const double ya = a[1] - level, yb = b[1] - level;
    if ((ya < 0 && yb > 0) || (ya > 0 && yb < 0)) give(Vec<D>(a + (ya / (ya - yb)) * (b - a)));
    if (yb <= 0) give(b);
    a = b;
  }
}

// a polygon, by triangles from a place on the level
template <class Corner>
Wet<2> polygon(int n, const Corner& corner, const Vec<2>& origin) {
  Wet<2> wet;
  Vec<2> first, last;
  int count = 0;
  const auto triangle = [&](const Vec<2>& p, const Vec<2>& q) {
    const Vec<2> a = p - origin, b = q - origin;
    wet.add(0.5 * (a[0] * b[1] - a[1] * b[0]), origin + (a + b) / 3);
  };
  clip<2>(n, corner, origin[1], [&](const Vec<2>& x) {
    if (count++ == 0)
      first = x;
    else
      triangle(last, x);
    last = x;
  });
  if (count > 2) triangle(last, first);
  return wet;
}

// a face of a polyhedron, by tetrahedra from there
template <class Corner>
void add_face(int n, const Corner& corner, const Vec<3>& origin, Wet<3>& wet) {
  Vec<3> first = Vec<3>::Zero(), last = first;
  int count = 0;
  clip<3>(n, corner, origin[1], [&](const Vec<3>& x) {
    if (count == 0) first = x;
    if (count++ > 1) {
      const Vec<3> a = first - origin, b = last - origin, c = x - origin;
      wet.add(a.dot(b.cross(c)) / 6, origin + (a + b + c) / 4);
    }
    last = x;
  });
}

// Gauss's rule of 20 points on (-1, 1)
struct GaussRule {
  static constexpr int kPoints = 20;
  double x[kPoints], w[kPoints];

  GaussRule() {
    for (int i = 0; i < kPoints; ++i) {
      double z = sin_cos(kPi * (i + 0.75) / (kPoints + 0.5)).cos, slope = 1;
      for (int pass = 0; pass < 8; ++pass) {
        double p = 1, before = 0;
        for (int k = 1; k <= kPoints; ++k) {
          const double next = ((2 * k - 1) * z * p - (k - 1) * before) / k;
          before = p, p = next;
        }
        slope = kPoints * (z * p - before) / (z * z - 1);
        z -= p / slope;
      }
      x[i] = z, w[i] = 2 / ((1 - z * z) * slope * slope);
    }
  }
};

// `at`: its centre; u: the way of its axis, unit
Wet<3> capsule(double half, double r, const Vec<3>& at, const Vec<3>& u, double level) {
  static const GaussRule rule;
  const double depth = level - at[1];
  const double reach = half * std::fabs(u[1]) + r;
  Wet<3> wet;
  if (depth <= -reach) return wet;
  if (depth >= reach) {
    wet.add(kPi * r * r * (2 * half + 4 * r / 3), at);
    return wet;
  }
  // up, as far as it goes across the axis: e, and by q per length
  Vec<3> e = Vec<3>::Unit(1) - u[1] * u;
  const double q = std::sqrt(e.squaredNorm());
  if (q > 0) e /= q;

  // where the discs change from dry to cut to wet, and where the round ends begin
  std::array<double, 12> cuts{-half - r, -half, half, half + r};
  int count = 4;
  const auto cut = [&](double s) {
    if (s > -half - r && s < half + r) cuts[std::size_t(count++)] = s;
  };
  if (u[1] != 0) {
    for (const double side : {-1.0, 1.0}) {
      if (const double s = (depth + side * r * q) / u[1]; std::fabs(s) < half) cut(s);
    }
  }
  for (const double side : {-1.0, 1.0}) {
    // (depth - s u_y)^2 = q^2 (r^2 - (s - side half)^2), beyond the middle part; u_y^2 + q^2 = 1
    const double b = depth * u[1] + side * q * q * half;
    const double under = b * b - (depth * depth + q * q * (half * half - r * r));
    if (under < 0) continue;
    for (const double sign : {-1.0, 1.0}) {
      if (const double s = b + sign * std::sqrt(under); side * s > half) cut(s);
    }
  }
  std::sort(cuts.begin(), cuts.begin() + count);
  for (int i = 0; i + 1 < count; ++i) {
    const double middle = 0.5 * (cuts[std::size_t(i)] + cuts[std::size_t(i) + 1]),
                 wide = 0.5 * (cuts[std::size_t(i) + 1] - cuts[std::size_t(i)]);
    if (!(wide > 0)) continue;
    for (int k = 0; k < GaussRule::kPoints; ++k) {
      // s goes through (3 x - x^3)/2, so that roots at the ends of a piece become smooth
      const double x = rule.x[k];
      const double s = middle + wide * (0.5 * x * (3 - x * x)), weight = wide * rule.w[k] * 1.5 * (1 - x * x);
      const double beyond = std::max(0.0, std::fabs(s) - half);
      const double radius = std::sqrt(std::max(0.0, (r - beyond) * (r + beyond)));
      const double left = depth - s * u[1];
      const double chord = q > 0 ? left / q : left > 0 ? 1e300 : -1e300;
      const auto [area, moment] = disc_segment(radius, chord);
      wet.add(weight * area, at + s * u);
      wet.moment += weight * moment * e;
    }
  }
  return wet;
}

template <int D>
struct Below {
  const BodyMotion<D>& at;
  double level;

  Vec<D> place(const Vec<D>& local) const { return at.x + at.arm(local); }
  Vec<D> origin() const {
    Vec<D> o = at.x;
    o[1] = level;
    return o;
  }

  Wet<D> operator()(const Point<D>&) const { return {}; }
  Wet<D> operator()(const Ball<D>& it) const { return ball<D>(it.radius, place(it.center), level); }
  Wet<D> operator()(const Box<D>& it) const {
    if constexpr (D == 2) {
      constexpr int kAround[] = {0, 1, 3, 2};
      return polygon(
          4, [&](int i) { return place(it.center + it.corner(kAround[i])); }, origin());
    } else {
      const Rotation<3> turn = rotation<3>(it.turn);
      Wet<3> wet;
      for (int axis = 0; axis < 3; ++axis) {
        const int b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
        for (const bool far : {false, true}) {
          const int first = far ? 1 << axis : 0;
          const int corners[4] = {first, first + (far ? b : c), first + b + c, first + (far ? c : b)};
          add_face(
              4, [&](int i) { return place(it.center + turn * it.corner(corners[i])); }, origin(), wet);
        }
      }
      return wet;
    }
  }
  Wet<2> operator()(const Polygon& it) const {
    return polygon(
        int(it.vertices.size()), [&](int i) { return place(it.vertices[std::size_t(i)]); }, origin());
  }
  Wet<3> operator()(const Hull& it) const {
    Wet<3> wet;
    for (const std::vector<int>& face : it.faces)
      add_face(
          int(face.size()), [&](int i) { return place(it.vertices[std::size_t(face[std::size_t(i)])]); },
          origin(), wet);
    return wet;
  }
  Wet<3> operator()(const Capsule& it) const {
    const Vec<3> axis = at.room_from_body * (rotation<3>(it.turn) * Vec<3>::Unit(1));
    return capsule(it.half, it.radius, at.x + at.arm(it.center), axis, level);
  }
  Wet<D> operator()(const Compound<D>& it) const {
    Wet<D> all;
    for (const Shape<D>& part : it.parts) {
      const Wet<D> one = of_form(part, *this);
      all.content += one.content, all.moment += one.moment;
    }
    return all;
  }
};

}  // namespace

template <int D>
Displaced<D> displaced(const Shape<D>& shape, const BodyMotion<D>& at, double level) {
  const Wet<D> wet = of_form(shape, Below<D>{at, level});
  if (!(wet.content > 0)) return {0, at.x};
  return {wet.content, wet.moment / wet.content};
}

template Displaced<2> displaced<2>(const Shape<2>&, const BodyMotion<2>&, double);
template Displaced<3> displaced<3>(const Shape<3>&, const BodyMotion<3>&, double);

}  // namespace obscura::sim
