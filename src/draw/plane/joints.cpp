// Draws joints. A rope that is longer than the distance of its ends hangs in a parabola of its length,
//   p(u) = a + u (b - a) + 4 s u (1 - u) d        d  down, s  how far it sags

#include <algorithm>
#include <cmath>
#include <utility>

#include "draw/picture/joint_look.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

constexpr double kStop = 9;   // page units: half a rail's end
constexpr int kPieces = 24;   // of a rope that sags
constexpr double kFar = 1e4;  // page units: a rail without an end

Point hanging(const Point& a, const Point& b, const Point& down, double sag, double u) {
  return a + u * (b - a) + 4 * sag * u * (1 - u) * down;
}

double length(const Point& a, const Point& b, const Point& down, double sag) {
  double sum = 0;
  for (int i = 0; i < kPieces; ++i)
    sum += (hanging(a, b, down, sag, double(i + 1) / kPieces) - hanging(a, b, down, sag, double(i) / kPieces))
               .norm();
  return sum;
}

/// How far a rope of this length sags, by halves; all in page units.
double sag(const Point& a, const Point& b, const Point& down, double rope) {
  double low = 0, high = rope;
  for (int i = 0; i < 40; ++i) {
    const double half = (low + high) / 2;
    (length(a, b, down, half) < rope ? low : high) = half;
  }
  return low;
}

/// Half the narrowest of the bodies at a joint, page units: the limit on the size of the joint's picture.
double room_for(const Stage& stage, const View& view, const sim::SceneInfo::Joint& joint) {
  double least = 1e300;
  for (int i : {joint.a, joint.b}) {
    if (i < 0) continue;
    const sim::SceneInfo::Body& body = stage.cast.bodies[i];
    if (body.kind == sim::ShapeKind::box) least = std::min(least, body.half.head<2>().minCoeff());
    if (body.kind == sim::ShapeKind::ball) least = std::min(least, body.radius);
  }
  return view.scale * least;
}

constexpr double kBracket = 24, kHatchHigh = 12;  // page units: half its width, how high its hatching is
constexpr double kNearWall = 14;  // page units: what is made fast so near to a wall hangs from that

/// Whether a body that is held fast is at a place of the page, or as near as a bracket is wide.
bool held_there(const Stage& stage, const View& view, const sim::Snapshot& now, const Point& at) {
  for (std::size_t i = 0; i < stage.cast.bodies.size() && i < now.bodies.size(); ++i) {
    const sim::SceneInfo::Body& body = stage.cast.bodies[i];
    if (!body.fixed) continue;
    const double s = std::sin(now.bodies[i].angle), c = std::cos(now.bodies[i].angle);
    const Point d = at - view.page(now.bodies[i].position), own(c * d.x() - s * d.y(), s * d.x() + c * d.y());
    Point half = view.scale * body.half.head<2>();
    if (body.kind != sim::ShapeKind::box) {
      double reach = body.radius;
      for (const sim::Vec3& vertex : body.vertices) reach = std::max(reach, vertex.norm());
      half = Point::Constant(view.scale * reach);
    }
    if ((own.cwiseAbs() - half).maxCoeff() < kNearWall * stage.layout.weight) return true;
  }
  return false;
}

/// A piece of ceiling over a place of the room from which something hangs; none near a wall. It goes where
/// what it holds swings up to its height, for it does not hang then.
void draw_bracket(const Stage& stage, const View& view, const sim::Snapshot& now,
                  const std::vector<HalfPlane>& walls, const Point& at, const Point& other,
                  std::vector<Point>& hatched, List& list) {
  const double weight = stage.layout.weight;
  const Point up = Point(-stage.cast.gravity.x(), stage.cast.gravity.y()).normalized(),
              along(-up.y(), up.x());
  const double hangs = -(other - at).normalized().dot(up);
  const double strength = std::clamp(hangs / 0.5, 0.0, 1.0);
  if (!(strength > 0) || outside(view.window, at, 2 * kBracket * weight)) return;
  for (const HalfPlane& wall : walls)
    if ((at - wall.point).dot(wall.normal) < kNearWall * weight) return;
  if (held_there(stage, view, now, at)) return;
  Color color = stage.colours.wall, hatch = stage.colours.hatch;
  color.a = hatch.a = std::uint8_t(std::lround(255 * strength));
  const double half = kBracket * weight, high = kHatchHigh * weight;
  // brackets beside each other have their hatching in common: its lines are at fixed places
  const double step = 0.7 * kHatchStep * weight, own = (at - view.origin).dot(along);
  const Point home = at - own * along;
  for (double x = std::ceil((own - half) / step) * step; x + high / 2 <= own + half; x += step) {
    const Point foot = home + x * along;
    const auto drawn = [&](const Point& before) { return (before - foot).norm() < 1e-3; };
    if (std::any_of(hatched.begin(), hatched.end(), drawn)) continue;
    hatched.push_back(foot);
    const double width = kHatchLine * weight;
    list.add({{foot, width, hatch}, {home + (x + high) * along + high * up, width, hatch}}, Cap::butt);
  }
  const double line = kWallLine * weight;
  list.add({{at - half * along, line, color}, {at + half * along, line, color}}, Cap::butt);
}

}  // namespace

void draw_brackets(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  if (!(stage.cast.gravity.head<2>().norm() > 0)) return;
  const std::vector<HalfPlane> walls = half_planes(stage.cast, view);
  std::vector<Point> hatched;
  for (std::size_t i = 0; i < now.springs.size(); ++i) {
    const sim::SceneInfo::Spring& spring = stage.cast.springs[i];
    const Point a = view.page(now.springs[i].a), b = view.page(now.springs[i].b);
    if (spring.a < 0 && spring.b >= 0) draw_bracket(stage, view, now, walls, a, b, hatched, list);
    if (spring.b < 0 && spring.a >= 0) draw_bracket(stage, view, now, walls, b, a, hatched, list);
  }
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (!spans(joint_look(joint.kind).plane) || now.joints[i].broken) continue;
    const Point a = view.page(now.joints[i].a), b = view.page(now.joints[i].b);
    if (joint.a < 0 && joint.b >= 0) draw_bracket(stage, view, now, walls, a, b, hatched, list);
    if (joint.b < 0 && joint.a >= 0) draw_bracket(stage, view, now, walls, b, a, hatched, list);
  }
}

void draw_rails(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (joint_look(joint.kind).plane != JointMark::rail || now.joints[i].broken) continue;
    const double angle = joint.b < 0 ? 0 : now.bodies[joint.b].angle;
    const double s = std::sin(angle), c = std::cos(angle);
    const Point along(c * joint.axis.x() - s * joint.axis.y(), -(s * joint.axis.x() + c * joint.axis.y()));
    const Point across(-along.y(), along.x()), home = view.page(now.joints[i].b);
    const Color color = stage.colours.hatch;
    const auto end = [&](double limit) { return std::clamp(limit * view.scale, -kFar, kFar); };
    const Point from = home + end(joint.lower) * along, to = home + end(joint.upper) * along;
    const double width = kSpringLine * weight;
    list.add({{from, width, color}, {to, width, color}}, Cap::butt);
    for (const auto& [limit, at] : {std::pair(joint.lower, from), std::pair(joint.upper, to)}) {
      if (std::abs(limit) * view.scale >= kFar) continue;
      const Point half = kStop * weight * across;
      list.add({{at - half, width, color}, {at + half, width, color}}, Cap::butt);
    }
  }
}

void draw_rods(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight;
  const Color color = stage.colours.spring;
  Point down = Point(stage.cast.gravity.x(), -stage.cast.gravity.y());
  down = down.norm() > 0 ? down.normalized() : Point(0, 1);
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    const bool rope = joint_look(joint.kind).plane == JointMark::rope;
    if (!spans(joint_look(joint.kind).plane) || now.joints[i].broken) continue;
    const Point a = view.page(now.joints[i].a), b = view.page(now.joints[i].b);
    const double width = (rope ? kRope : kRod) * weight, whole = joint.length * view.scale;
    nodes.clear();
    if (rope && whole > (b - a).norm() + 0.05) {
      const double s = sag(a, b, down, whole);
      for (int k = 0; k <= kPieces; ++k)
        nodes.push_back({hanging(a, b, down, s, double(k) / kPieces), width, color});
    } else {
      nodes = {{a, width, color}, {b, width, color}};
    }
    list.add(nodes, Cap::round);
  }
  // made fast to the room, or to a point of a body
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (!spans(joint_look(joint.kind).plane) || now.joints[i].broken) continue;
    for (const auto& [body, at] :
         {std::pair(joint.a, now.joints[i].a), std::pair(joint.b, now.joints[i].b)}) {
      const double radius = (body < 0 ? kPin : kJoint) * weight;
      if (body < 0 || stage.solid(body)) list.add(Disc{view.page(at), radius, 0, color, color});
    }
  }
}

void draw_pins(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (joint_look(joint.kind).plane != JointMark::dot || now.joints[i].broken) continue;
    const Point at = view.page(now.joints[i].a);
    const double radius = std::max(std::min(kPin * weight, 0.7 * room_for(stage, view, joint)), 1.6 * weight);
    if (outside(view.window, at, radius)) continue;
    // a ring; filled where it is fast to the room
    const bool fast = joint.b < 0;
    const Color color = stage.colours.spring;
    list.add(Disc{at, radius, 0.38 * radius, fast ? color : stage.colours.room, color});
  }
}

}  // namespace obscura::draw
