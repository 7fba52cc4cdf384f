// Springs, rods and ropes as round rods in space. A coil of n turns and radius A about the way from a to b is
//   p(s) = a + along(s) d + A e(s) (cos(2 pi s) u + sin(2 pi s) v)        s  in [0, n], d, u, v  a frame
// with e rising from 0 over the first part of a turn, so that its leads run on the axis.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "draw/picture/arms.h"
#include "draw/picture/joint_look.h"
#include "draw/picture/rope_way.h"
#include "draw/picture/slider_rail.h"
#include "draw/space/space.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kRise = 0.5;  // turns over which a coil leaves its axis
constexpr int kNodes = 14;     // a turn
constexpr double kEndOn = 7;   // amplitudes: a coil that looks shorter is narrower
constexpr double kNarrow = 0.3;
constexpr double kRail = 2.2;    // widths of a rod
constexpr double kWithin = 0.7;  // of half a body's thickness: a joint in it

double smooth_end(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

/// A frame's second axis that does not jump while the first moves a little: the horizontal one.
Vec3 beside(const Vec3& d) {
  const Vec3 level = Vec3::UnitY().cross(d);
  return level.norm() > 0.05 ? Vec3(level.normalized()) : Vec3((Vec3::UnitX() - d * d.x()).normalized());
}

std::vector<Vec3> helix(const Coil& form, const Vec3& a, const Vec3& b, double wire, double radius) {
  const double length = (b - a).norm();
  if (form.turns == 0 || length < 1e-9) return {a, b};
  const Vec3 d = (b - a) / length, u = beside(d), v = d.cross(u);
  const double lead = std::min(std::clamp(0.085 * length, 2 * wire, 14 * wire), 0.2 * length), n = form.turns;
  std::vector<Vec3> way{a};
  for (int i = 0; i <= form.turns * kNodes; ++i) {
    const double s = double(i) / kNodes, turn = 2 * std::numbers::pi * s;
    const double rise = smooth_end(s / kRise) * smooth_end((n - s) / kRise);
    way.push_back(a + d * (lead + (length - 2 * lead) * s / n) +
                  radius * rise * (std::cos(turn) * u + std::sin(turn) * v));
  }
  way.push_back(b);
  return way;
}

void add_coil(SpaceFrame& s, const Coil& form, const Vec3& a, const Vec3& b, Color color, int number) {
  const double page = s.lens.scale;  // page units a metre, where the camera looks
  const double length = (b - a).norm();
  const double weight = s.stage.layout.weight;
  if (form.turns == 0) {
    const double radius = 0.5 * kNetLine * weight * s.zoom / page;
    add_tube(s, {a, b}, radius, color, number);
    s.rods.push_back({a, b, radius});
    return;
  }
  const double wire = 0.6 * line_width(form, length * page, s.zoom) / page;
  // seen from its end a wide coil would be a ball of wire
  const double seen = (s.lens.page(b) - s.lens.page(a)).norm();
  const double whole = amplitude(form, length * page, s.zoom);
  const double wide = whole * std::clamp(seen / (kEndOn * whole), kNarrow, 1.0) / page;
  const std::vector<Vec3> way = helix(form, a, b, wire, wide);
  const Solids::Tube coil{{a, b}, wire, color, {form.turns, 0, whole}};
  add_tube(s, way, wire, color, number, 1, &coil);
  if (length < 1e-9) return;
  // its leads, and what it winds around, of which its wire covers a part
  double wound = 0;
  for (std::size_t i = 2; i + 2 < way.size(); ++i) wound += (way[i + 1] - way[i]).norm();
  const Vec3 from = a + (b - a) * ((way[1] - a).dot(b - a) / (length * length)), to = a + b - from;
  s.rods.push_back({a, from, wire});
  s.rods.push_back({to, b, wire});
  s.rods.push_back(
      {from, to, wide + wire, std::min(1.0, wound * wire / ((to - from).norm() * (wide + wire)))});
}

}  // namespace

void add_links(SpaceFrame& s) {
  const sim::SceneInfo& cast = s.stage.cast;
  const double weight = s.stage.layout.weight, metre = s.zoom / s.lens.scale;  // m a page unit at the start
  const Color color = s.stage.colours.spring;
  int number = int(s.stage.pieces.size());
  std::vector<double> least(cast.bodies.size(), 1e300);  // half the thickness of each body, m
  for (const Piece& piece : s.stage.pieces)
    least[std::size_t(piece.body)] = std::min(least[std::size_t(piece.body)], piece.least);
  const auto slender = [&](int body) { return body < 0 ? 1e300 : least[std::size_t(body)]; };
  const auto between = [&](int a, int b) {
    return link_color(s.stage.look, s.stage.colours, std::array{a, b});
  };
  const auto knob = [&](int body, const Vec3& at, double radius, Color own) {
    if (body < 0 || cast.bodies[body].turns) add_ball(s, at, radius * weight * metre, own, number);
  };
  for (std::size_t i = 0; i < s.now.springs.size() && i < cast.springs.size(); ++i, ++number) {
    const auto& at = s.now.springs[i];
    if (at.loose) continue;
    const Color own = between(cast.springs[i].a, cast.springs[i].b);
    add_coil(s, s.stage.coils[i], at.a, at.b, own, number);
    const double joint = (s.stage.coils[i].turns == 0 ? 0.75 : 1) * kJoint;
    knob(cast.springs[i].a, at.a, joint, own);
    knob(cast.springs[i].b, at.b, joint, own);
  }
  for (std::size_t i = 0; i < s.now.joints.size() && i < cast.joints.size(); ++i, ++number) {
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    const sim::Snapshot::Joint& at = s.now.joints[i];
    if (at.broken) continue;
    switch (const JointMark mark = joint_look(joint.kind).space; mark) {
      case JointMark::none:
      case JointMark::teeth:
        break;
      case JointMark::pulley: {
        std::vector<Vec3> way = rope_way(cast, i, s.now);
        way.erase(std::unique(way.begin(), way.end()), way.end());
        const double radius = 0.5 * kRope * weight * metre;
        const Color own = joint_color(s.stage.look, s.stage.colours, cast, i);
        add_tube(s, way, radius, own, number);
        for (std::size_t k = 1; k < way.size(); ++k) s.rods.push_back({way[k - 1], way[k], radius});
        for (const sim::SceneInfo::Joint::Place& it : joint.places)
          knob(it.body, place_of(s.now, it), it.body < 0 ? kPin : kJoint, own);
        break;
      }
      case JointMark::line:
      case JointMark::rope: {
        const bool rope = mark == JointMark::rope;
        const double radius = 0.5 * (rope ? kRope : kRod) * weight * metre;
        const Vec3 down = cast.gravity.norm() > 0 ? Vec3(cast.gravity.normalized()) : Vec3(-Vec3::UnitY());
        const bool slack = rope && joint.length > (at.b - at.a).norm() * (1 + 1e-6);
        const std::vector<Vec3> way =
            slack ? hanging_rope(at.a, at.b, down, joint.length) : std::vector<Vec3>{at.a, at.b};
        const Color own = between(joint.a, joint.b);
        add_tube(s, way, radius, own, number);
        for (std::size_t k = 1; k < way.size(); ++k) s.rods.push_back({way[k - 1], way[k], radius});
        knob(joint.a, at.a, kJoint, own);
        knob(joint.b, at.b, joint.b < 0 ? kPin : kJoint, own);
        break;
      }
      case JointMark::rail: {
        const Eigen::Matrix3d turn = joint.b < 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                                 : s.now.bodies[joint.b].orientation.toRotationMatrix();
        const Vec3 along = turn * joint.axis;
        const double far = 2 * s.lens.window.width / s.lens.scale;
        const SliderRail rail = slider_rail(cast, s.now, i);
        add_tube(
            s,
            {at.b + std::clamp(rail.from, -far, far) * along, at.b + std::clamp(rail.to, -far, far) * along},
            0.5 * kSpringLine * weight * metre, s.stage.colours.hatch, number);
        break;
      }
      case JointMark::dot:
        // within what it holds together where that is slender; of the body's own dark, or it would be a bead
        // on it
        add_ball(
            s, at.a,
            std::min(0.8 * kPin * weight * metre, kWithin * std::min(slender(joint.a), slender(joint.b))),
            joint.a < 0 && joint.b < 0
                ? color
                : edge(s.stage.own[std::size_t(std::max(joint.a, joint.b))], s.stage.look.theme),
            number);
        break;
    }
  }
  for (const sim::SceneInfo::Rail& rail : cast.rails) {
    std::vector<Vec3> way;
    for (const Vec3& place : rail.places) way.push_back(place_of(s.now, {rail.body, place}));
    // what is rolled on is a bar in the walls' colour, a wire is as thin as a rod
    const bool wire = !rail.left && !rail.right;
    const double radius = 0.5 * (wire ? 1 : kRail) * kRod * weight * metre;
    const Color own = track_color(s.stage.look, rail.name).value_or(wire ? color : s.stage.colours.wall);
    add_tube(s, way, radius, own, number++);
    for (std::size_t k = 1; k < way.size(); ++k) s.rods.push_back({way[k - 1], way[k], radius});
  }
  for (std::size_t i = 0; i < s.now.mice.size() && s.stage.look.pointer; ++i, ++number) {
    const sim::Snapshot::Mouse& mouse = s.now.mice[i];
    if (!mouse.pressed || mouse.body < 0) continue;
    add_coil(s, s.stage.hands[i], mouse.held, mouse.pointer, color, number);
    add_ball(s, mouse.held, kJoint * weight * metre, color, number);
  }
  for (const Arm& arm : arms(cast, s.now, kArmBeyond * weight * metre)) {
    const double radius = 0.5 * kRod * weight * metre;
    add_tube(s, {arm.from, arm.to}, radius,
             joint_color(s.stage.look, s.stage.colours, cast, std::size_t(arm.joint)), number++);
    s.rods.push_back({arm.from, arm.to, radius});
  }
}

}  // namespace obscura::draw
