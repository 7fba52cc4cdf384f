// Light and shadow.
//   lit     s = s0 + s1 (1 + n_y)/2 + s2 max(0, n . l)         n  normal, l  to the light
//   shaded  s = s0 + s1 (1 + n_y)/2 + s3 max(0, n . l)         s3 < s2: round things stay round in the shadow
//   colour  from dark to bright along s, through the body's own
// A shadow on the ground is drawn ray by ray: each casts the body's corners on the plane, their hull is dark
// for that ray, and a place is as dark as the share of rays that do not reach it. So a shadow is sharp where
// a body stands on the ground and soft where it flies.

#include "draw/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kSpread = 0.10;  // radius of the light's disc at distance 1
constexpr double kNear = 1e-3;    // least depth over the target's
constexpr double kSharp = 0.6;    // page units: shadows softer than this take more rays

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The hull of `points`, in order. Andrew's chain.
void hull(std::vector<Point>& points, std::vector<Point>& out) {
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  out.clear();
  const auto chain = [&](auto begin, auto end) {
    const std::size_t first = out.size();
    for (auto p = begin; p != end; ++p) {
      while (out.size() >= first + 2 &&
             cross(out.back() - out[out.size() - 2], *p - out[out.size() - 2]) <= 1e-9)
        out.pop_back();
      out.push_back(*p);
    }
    out.pop_back();
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
}

}  // namespace

Light light(const Vec3& toward) {
  Light l;
  l.toward = toward.normalized();
  const Vec3 side =
      (std::abs(l.toward.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitX()).cross(l.toward).normalized();
  const Vec3 up = l.toward.cross(side);
  for (int i = 0; i < kRays; ++i) {
    // a sunflower: even over the disc, without rows
    const double r = kSpread * std::sqrt((i + 0.5) / kRays), a = i * std::numbers::pi * (3 - std::sqrt(5.0));
    l.rays[i] = l.toward + r * (std::cos(a) * side + std::sin(a) * up);
  }
  return l;
}

Shaded shade(Color own, Theme theme, const Light& light, const Vec3& normal) {
  const double sky = (1 + normal.y()) / 2, sun = std::max(0.0, normal.dot(light.toward));
  const auto tone = [&](double s) {
    s = std::clamp(s, 0.0, 1.0);
    if (theme == Theme::paper) {
      const Color dark = mix(own, {0x18, 0x1C, 0x22}, 0.52), bright = mix(own, {255, 255, 255}, 0.5);
      return mix(dark, bright, s);
    }
    const Color dark = mix(own, {0x08, 0x0C, 0x12}, 0.72), bright = mix(own, {255, 255, 255}, 0.14);
    return mix(dark, bright, s);
  };
  const double base = 0.27 + 0.13 * sky;
  return {tone(base + 0.60 * sun), tone(base + 0.12 * sun)};
}

Color edge(Color own, Theme theme) {
  return theme == Theme::paper ? mix(own, {0x10, 0x13, 0x18}, 0.58) : mix(own, {0x06, 0x09, 0x0D}, 0.80);
}

void cast_on(const Ground& ground, const Light& light, const Lens& lens, const std::vector<Vec3>& corners,
             double radius, bool many, Solids& solids) {
  // what is under the ground casts nothing on it
  double low = 1e300, high = -1e300;
  for (const Vec3& c : corners) {
    const double h = (c - ground.point).dot(ground.normal);
    low = std::min(low, h - radius), high = std::max(high, h + radius);
  }
  const double fall = light.toward.dot(ground.normal);
  if (high <= 0 || fall <= 0.05) return;

  // a sharp shadow takes one ray for all, a soft one each
  const Vec3 foot = corners[0] - light.toward * ((corners[0] - ground.point).dot(ground.normal) / fall);
  const double depth = std::max(lens.depth(foot), kNear);
  const double soft = 2 * kSpread * high / (fall * fall) * lens.scale / depth;
  const int share = soft < kSharp ? kRays : soft < 4 * kSharp ? 4 : soft < 16 * kSharp || many ? 2 : 1;

  std::vector<Point> cast, outline;
  std::vector<Eigen::Vector4d> cut;
  for (int i = 0; i < kRays; i += share) {
    const Vec3& ray = light.rays[share == kRays ? 0 : i];
    const Vec3 along = share == kRays ? light.toward : ray;
    const double down = along.dot(ground.normal);
    cast.clear();
    bool behind = false;
    std::vector<Vec3> places;
    for (const Vec3& c : corners) {
      const Vec3 place = c - along * (std::max((c - ground.point).dot(ground.normal), 0.0) / down);
      if (radius <= 0) {
        places.push_back(place);
        continue;
      }
      // a ball's shadow is an ellipse: its axis along the light is longer
      const Vec3 flat = along - ground.normal * down;
      const Vec3 u = flat.norm() > 1e-9 ? Vec3(flat.normalized()) : ground.normal.unitOrthogonal();
      const Vec3 v = ground.normal.cross(u);
      const double longer = radius * along.norm() / down;
      constexpr int kRim = 14;
      for (int k = 0; k < kRim; ++k) {
        const double a = 2 * std::numbers::pi * k / kRim;
        places.push_back(place + longer * std::cos(a) * u + radius * std::sin(a) * v);
      }
    }
    for (const Vec3& place : places) {
      if (lens.depth(place) < kNear) {
        behind = true;
        break;
      }
      cast.push_back(lens.page(place));
    }
    // shadows that reach behind the eye are far outside the page or all over it
    if (behind || cast.size() < 3) continue;
    hull(cast, outline);
    if (outline.size() < 3) continue;
    const int begin = int(solids.points.size());
    solids.points.insert(solids.points.end(), outline.begin(), outline.end());
    std::uint32_t bits = share == kRays ? ~0u : 0;
    for (int k = i; share < kRays && k < i + share; ++k) bits |= 1u << k;
    solids.shades.push_back({begin, int(solids.points.size()), bits});
  }
}

}  // namespace obscura::draw
