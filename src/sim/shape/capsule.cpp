// A capsule: a cylinder from -a to a along y, and at each end half a ball, whose centroid lies 3 r / 8
// beyond.
//   V = V1 + V2         V1 = 2 a pi r^2,  V2 = 4 pi r^3 / 3
//   C = diag(c, d, c)   c = V1 r^2 / 4 + V2 r^2 / 5,  d = V1 a^2 / 3 + V2 (r^2 / 5 + 3 a r / 4 + a^2)

#include <algorithm>
#include <numbers>

#include "sim/shape/form.h"

namespace obscura::sim {

Spread<3> Capsule::spread() const {
  const double a = half, r = radius;
  const double cylinder = 2 * a * std::numbers::pi * r * r, ball = 4 * std::numbers::pi * r * r * r / 3;
  const double across = cylinder * r * r / 4 + ball * r * r / 5;
  Spread<3> it;
  it.content = cylinder + ball;
  it.center = center;
  it.second.diagonal() << across, cylinder * a * a / 3 + ball * (r * r / 5 + 3 * a * r / 4 + a * a), across;
  it.turn(turn);
  return it;
}

void Capsule::add_support_vertices(std::vector<SupportVertex<3>>& all) const {
  const bool turned = turn != no_rotation<3>();
  for (const double end : {-half, half}) {
    const Vec<3> own = Vec<3>::Unit(1) * end;
    all.push_back({turned ? Vec<3>(center + rotation<3>(turn) * own) : Vec<3>(center + own), radius});
  }
}

double Capsule::half_thickness() const { return radius; }

double Capsule::bounding_radius() const {
  std::vector<SupportVertex<3>> all;
  add_support_vertices(all);
  return farthest_reach(all);
}

Bounds<3> Capsule::bounds(const Vec<3>& x, const Rotation<3>& room_from_body) const {
  const Vec<3> middle = x + room_from_body * center;
  const Rotation<3> axes =
      turn == no_rotation<3>() ? room_from_body : Rotation<3>(room_from_body * rotation<3>(turn));
  const Vec<3> far = axes.col(1).cwiseAbs() * half + Vec<3>::Constant(radius);
  return {middle - far, middle + far};
}

double Capsule::outside(const Vec<3>& point) const {
  Vec<3> own = point - center;
  if (turn != no_rotation<3>()) own = (rotation<3>(turn).transpose() * own).eval();
  own[1] -= std::clamp(own[1], -half, half);
  return own.norm() - radius;
}

Shape<3> Capsule::moved(const Placing<3>& placing, const Orientation<3>& by) const {
  return Capsule{half, radius, placing(center), by == no_rotation<3>() ? turn : composed<3>(by, turn)};
}

std::optional<Vec<3>> Capsule::side(const Vec<3>& way) const {
  if (way.cwiseAbs().sum() > 1.5) return {};
  return Vec<3>(way * radius + way.cwiseProduct(Vec<3>(0, half, 0)));
}

Vec<3> Capsule::hold() const { return {0, half, 0}; }

std::vector<DrawnForm> Capsule::drawn() const {
  return {{.kind = ShapeKind::capsule,
           .radius = radius,
           .half = {0, half, 0},
           .center = center,
           .turn = quaternion<3>(turn)}};
}

}  // namespace obscura::sim
