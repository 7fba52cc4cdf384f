// Draws joints. A rope that is longer than the distance of its ends hangs in a parabola of its length,
//   p(u) = a + u (b - a) + 4 s u (1 - u) d        d  down, s  how far it sags

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "draw/picture/arms.h"
#include "draw/picture/joint_look.h"
#include "draw/picture/rope_way.h"
#include "draw/picture/slider_rail.h"
#include "draw/plane/stage.h"

namespace obscura::draw {
namespace {

Color color_of_joint(const Stage& stage, std::size_t i) {
  return joint_color(stage.look, stage.colours, stage.cast, i);
}

using sim::Vec3;

constexpr double kStop = 9;   // page units: half a rail's end
constexpr int kPieces = 24;   // of a rope that sags
constexpr double kFar = 1e4;  // page units: a rail without an end
constexpr double kRound = 2 * std::numbers::pi;

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

constexpr double kBracket = 24, kHatchHigh = 12;     // page units: half its width, how high its hatching is
constexpr double kHung = 1.3, kLeastBracket = 0.45;  // of what hangs there: not wider; of its width: nor less
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

/// On which side of a place of the room it is made fast what is held there, `start` (m) from it at the start:
/// from above, but what stands on it from below, and a spring that lies from its side. A whole run has it on
/// one side, wherever what is held swings.
Point made_fast(const Stage& stage, const Vec3& start, bool spring) {
  const Point up = Point(-stage.cast.gravity.x(), stage.cast.gravity.y()).normalized(),
              along(-up.y(), up.x()), way(start.x(), -start.y());
  const double rises = way.dot(up), reach = way.dot(along);
  if (rises > std::abs(reach)) return -up;
  if (spring && std::abs(reach) > std::abs(rises)) return reach > 0 ? Point(-along) : along;
  return up;
}

/// How large a bracket is, of its full size: modest against what is made fast there.
double share_of_bracket(const Stage& stage, const View& view, int body) {
  const sim::SceneInfo::Body& its = stage.cast.bodies[std::size_t(body)];
  if (!its.parts.empty()) return 1;
  double far = its.radius + its.half.norm();
  for (const Vec3& vertex : its.vertices) far = std::max(far, vertex.norm());
  const double dot = stage.dots[std::size_t(body)], size = dot > 0 ? dot : view.scale * far;
  return std::clamp(kHung * size / (kBracket * stage.layout.weight), kLeastBracket, 1.0);
}

/// A piece of ceiling, floor or wall at a place of the room where something is made fast, `out` into it; none
/// near a wall.
void draw_bracket(const Stage& stage, const View& view, const sim::Snapshot& now,
                  const std::vector<HalfPlane>& walls, const Point& at, const Point& out, double share,
                  std::vector<Point>& hatched, List& list) {
  const double weight = stage.layout.weight;
  const Point along(-out.y(), out.x());
  if (outside(view.window, at, 2 * kBracket * weight)) return;
  for (const HalfPlane& wall : walls)
    if ((at - wall.point).dot(wall.normal) < kNearWall * weight) return;
  if (held_there(stage, view, now, at)) return;
  const Color color = stage.colours.wall, hatch = stage.colours.hatch;
  const double half = share * kBracket * weight, high = (0.4 + 0.6 * share) * kHatchHigh * weight;
  // brackets beside each other have their hatching in common: its lines are at fixed places
  const double step = 0.7 * kHatchStep * weight, own = (at - view.origin).dot(along);
  const Point home = at - own * along;
  for (double x = std::ceil((own - half) / step) * step; x + high / 2 <= own + half; x += step) {
    const Point foot = home + x * along;
    const auto drawn = [&](const Point& before) { return (before - foot).norm() < 1e-3; };
    if (std::any_of(hatched.begin(), hatched.end(), drawn)) continue;
    hatched.push_back(foot);
    const double width = kHatchLine * weight;
    list.add({{foot, width, hatch}, {home + (x + high) * along + high * out, width, hatch}}, Cap::butt);
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
    if (now.springs[i].loose || (spring.a < 0) == (spring.b < 0)) continue;
    const bool first = spring.a < 0;
    draw_bracket(stage, view, now, walls, view.page(first ? now.springs[i].a : now.springs[i].b),
                 made_fast(stage, first ? spring.start : Vec3(-spring.start), true),
                 share_of_bracket(stage, view, first ? spring.b : spring.a), hatched, list);
  }
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (!spans(joint_look(joint.kind).plane) || now.joints[i].broken) continue;
    if ((joint.a < 0) == (joint.b < 0)) continue;
    const bool first = joint.a < 0;
    draw_bracket(stage, view, now, walls, view.page(first ? now.joints[i].a : now.joints[i].b),
                 made_fast(stage, first ? joint.start : Vec3(-joint.start), false),
                 share_of_bracket(stage, view, first ? joint.b : joint.a), hatched, list);
  }
}

// How far a rail without limits goes from `home` along a unit vector of the room, m: to the walls, and no
// farther than the picture.
std::pair<double, double> reach_of_rail(const Stage& stage, const View& view, const Vec3& home,
                                        const Vec3& along) {
  double from = -kFar / view.scale, to = kFar / view.scale;
  // inside where off + t rate >= 0
  const auto within = [&](double off, double rate) {
    if (!(off >= 0) || rate == 0) return;
    (rate > 0 ? from : to) = rate > 0 ? std::max(from, -off / rate) : std::min(to, -off / rate);
  };
  for (const sim::SceneInfo::Wall& wall : stage.cast.walls)
    within((home - wall.point).dot(wall.normal), along.dot(wall.normal));
  const Rect& window = view.window;
  const Point at = view.page(home), by = view.scale * Point(along.x(), -along.y());
  within(at.x() - window.x, by.x()), within(window.x + window.width - at.x(), -by.x());
  within(at.y() - window.y, by.y()), within(window.y + window.height - at.y(), -by.y());
  return {from, to};
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
    const auto [least, most] = reach_of_rail(stage, view, now.joints[i].b, Vec3(along.x(), -along.y(), 0));
    const SliderRail rail = slider_rail(stage.cast, now, i);
    const bool starts = std::abs(rail.from) * view.scale < kFar, ends = std::abs(rail.to) * view.scale < kFar;
    const Point from = home + view.scale * (starts ? rail.from : least) * along,
                to = home + view.scale * (ends ? rail.to : most) * along;
    const double width = kSpringLine * weight;
    list.of({Subject::What::joint, int(i)});
    list.add({{from, width, color}, {to, width, color}}, Cap::butt);
    for (const auto& [limit, at] : {std::pair(joint.lower, from), std::pair(joint.upper, to)}) {
      if (std::abs(limit) * view.scale >= kFar) continue;
      const Point half = kStop * weight * across;
      list.add({{at - half, width, color}, {at + half, width, color}}, Cap::butt);
    }
  }
}

void draw_arms(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight, width = kRod * weight;
  for (const Arm& arm : arms(stage.cast, now, kArmBeyond * weight / view.scale)) {
    list.of({Subject::What::joint, arm.joint});
    const Color color = color_of_joint(stage, std::size_t(arm.joint));
    list.add({{view.page(arm.from), width, color}, {view.page(arm.to), width, color}}, Cap::round);
  }
}

void draw_rods(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  const double weight = stage.layout.weight;
  Point down = Point(stage.cast.gravity.x(), -stage.cast.gravity.y());
  down = down.norm() > 0 ? down.normalized() : Point(0, 1);
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    const bool rope = joint_look(joint.kind).plane == JointMark::rope;
    if (!spans(joint_look(joint.kind).plane) || !joint.places.empty() || now.joints[i].broken) continue;
    const Point a = view.page(now.joints[i].a), b = view.page(now.joints[i].b);
    const double width = (rope ? kRope : kRod) * weight, whole = joint.length * view.scale;
    const Color color = color_of_joint(stage, i);
    nodes.clear();
    if (rope && whole > (b - a).norm() + 0.05) {
      const double s = sag(a, b, down, whole);
      for (int k = 0; k <= kPieces; ++k)
        nodes.push_back({hanging(a, b, down, s, double(k) / kPieces), width, color});
    } else {
      nodes = {{a, width, color}, {b, width, color}};
    }
    list.of({Subject::What::joint, int(i)});
    list.add(nodes, Cap::round);
  }
  // made fast to the room, or to a point of a body
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (!spans(joint_look(joint.kind).plane) || !joint.places.empty() || now.joints[i].broken) continue;
    const Color color = color_of_joint(stage, i);
    for (const auto& [body, at] :
         {std::pair(joint.a, now.joints[i].a), std::pair(joint.b, now.joints[i].b)}) {
      const double radius = (body < 0 ? kPin : kJoint) * weight;
      list.of({Subject::What::joint, int(i)});
      if (body < 0 || stage.solid(body)) list.add(Disc{view.page(at), radius, 0, color, color});
    }
  }
}

namespace {

// Belts: around two wheels, along the two lines that both have on one side.
void draw_belts(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  constexpr double kArcPiece = 0.05;  // rad
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (!joint.belt || now.joints[i].broken) continue;
    const Vec3 one = place_of(now, joint.places[0]), other = place_of(now, joint.places[2]);
    const double far = (other - one).norm();
    const Vec3 u = (other - one) / far, across(-u.y(), u.x(), 0);
    const double turn = std::acos(std::clamp((joint.offset_a - joint.offset_b) / far, -1.0, 1.0));
    const Color color = color_of_joint(stage, i);
    nodes.clear();
    const auto arc = [&](const Vec3& center, double radius, double from, double to) {
      const int pieces = std::max(1, int(std::ceil((to - from) / kArcPiece)));
      for (int k = 0; k <= pieces; ++k) {
        const double angle = from + (to - from) * k / pieces;
        nodes.push_back({view.page(center + radius * (std::cos(angle) * u + std::sin(angle) * across)),
                         kRope * stage.layout.weight, color});
      }
    };
    arc(one, joint.offset_a, turn, kRound - turn), arc(other, joint.offset_b, -turn, turn);
    nodes.push_back(nodes.front());
    list.of({Subject::What::joint, int(i)});
    list.add(nodes, Cap::round);
  }
}

}  // namespace

void draw_pulleys(const Stage& stage, const View& view, const sim::Snapshot& now, List& list) {
  draw_belts(stage, view, now, list);
  const double weight = stage.layout.weight;
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = stage.cast.joints[i];
    if (joint_look(joint.kind).plane != JointMark::pulley || now.joints[i].broken) continue;
    const Color color = color_of_joint(stage, i);
    nodes.clear();
    for (const Vec3& at : rope_way(stage.cast, i, now))
      nodes.push_back({view.page(at), kRope * weight, color});
    list.of({Subject::What::joint, int(i)});
    if (!nodes.empty()) list.add(nodes, Cap::round);
    // made fast to the room or to a body, or led around a point of one
    for (const sim::SceneInfo::Joint::Place& at : joint.places) {
      const std::size_t k = std::size_t(&at - joint.places.data());
      const bool inner = k > 0 && k + 1 < joint.places.size() && !joint.around.empty();
      const bool wheel = (k == 0 && joint.offset_a != 0) ||
                         (k + 1 == joint.places.size() && joint.offset_b != 0) ||
                         (inner && joint.around[k - 1] != 0);
      if (wheel || (at.body >= 0 && !stage.solid(at.body))) continue;
      list.add(Disc{view.page(place_of(now, at)), (at.body < 0 ? kPin : kJoint) * weight, 0, color, color});
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
    list.of({Subject::What::joint, int(i)});
    const bool fast = joint.b < 0;
    const Color color = color_of_joint(stage, i);
    list.add(Disc{at, radius, 0.38 * radius, fast ? color : stage.colours.room, color});
  }
}

}  // namespace obscura::draw
