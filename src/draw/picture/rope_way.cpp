#include "draw/picture/rope_way.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/constraint/joints/pulley.h"

namespace obscura::draw {

using sim::Vec3;

namespace {

constexpr double kArc = 0.05;  // rad: of a rope on a wheel that is drawn as straight

}  // namespace

Vec3 place_of(const sim::Snapshot& now, const sim::SceneInfo::Joint::Place& at) {
  if (at.body < 0) return at.local;
  const sim::Snapshot::Body& body = now.bodies[std::size_t(at.body)];
  return body.position + body.orientation * at.local;
}

std::vector<RopeLine> rope_lines(const sim::SceneInfo::Joint& joint, const sim::Snapshot& now) {
  std::vector<RopeLine> all;
  const std::size_t n = joint.places.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Vec3 p = place_of(now, joint.places[i]), q = place_of(now, joint.places[i + 1]);
    const double a = i == 0 ? joint.offset_a : 0, b = i + 2 == n ? joint.offset_b : 0;
    if (a == 0 && b == 0) {
      const double far = (q - p).norm();
      all.push_back({p, q, far > 0 ? Vec3((q - p) / far) : Vec3(Vec3::UnitX())});
      continue;
    }
    const auto piece = sim::rope_piece<2>(sim::Vec<2>(p.head<2>()), sim::Vec<2>(q.head<2>()), a - b);
    const Vec3 d(piece.direction[0], piece.direction[1], 0), out(d.y(), -d.x(), 0);
    all.push_back({p + a * out, q + b * out, d});
  }
  return all;
}

std::vector<Vec3> rope_way(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now) {
  const sim::SceneInfo::Joint& joint = cast.joints[i];
  const std::vector<RopeLine> lines = rope_lines(joint, now);
  std::vector<Vec3> way;
  if (joint.offset_a != 0 && i > 0 && !now.joints[i - 1].broken) {
    const Vec3 before = rope_lines(cast.joints[i - 1], now).back().along, after = lines.front().along;
    const Vec3 center = place_of(now, joint.places.front());
    double turn = std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
    if (turn != 0 && (turn > 0) != (joint.offset_a > 0))
      turn += (joint.offset_a > 0 ? 2 : -2) * std::numbers::pi;
    const int steps = std::max(1, int(std::ceil(std::fabs(turn) / kArc)));
    for (int k = 0; k < steps; ++k) {
      const double s = std::sin(turn * k / steps), c = std::cos(turn * k / steps);
      const Vec3 d(c * before.x() - s * before.y(), s * before.x() + c * before.y(), 0);
      way.push_back(center + joint.offset_a * Vec3(d.y(), -d.x(), 0));
    }
  }
  for (const RopeLine& line : lines) way.push_back(line.from), way.push_back(line.to);
  return way;
}

}  // namespace obscura::draw
