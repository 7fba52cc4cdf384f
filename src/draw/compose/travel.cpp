// How far things move on the page. No point of a body with velocity v, spin w and bounding radius r, seen at
// p and then at p', moves farther than
//   |p' - p| + scale |w| r dt
// For things that stand still while the camera moves, no point of the window moves farther than one of its
// corners: exactly in the plane, where a view is a scale and a shift; in space, corners are tried at two
// depths.

#include "draw/compose/travel.h"

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kNearestDepth = 0.05;  // depth over the target's, nearer than which nothing is looked at

// the position of a pointer on its path
Vec3 along(const sim::SceneInfo::Mouse& mouse, double time) {
  const double span = mouse.release - mouse.press, n = double(mouse.path.size() - 1);
  const double at = span > 0 ? std::clamp((time - mouse.press) / span, 0.0, 1.0) * n : 0;
  const auto i = std::min(std::size_t(at), mouse.path.size() - 1), k = std::min(i + 1, mouse.path.size() - 1);
  return mouse.path[i] + (at - double(i)) * (mouse.path[k] - mouse.path[i]);
}

double seen_travel(const Rect& window, const Point& from, const Point& to, double around, double turned) {
  const double way = (to - from).norm() + turned;
  return outside(window, from, around + way) ? 0 : way;
}

double spatial(const SpaceStage& stage, const Panel& panel, const sim::Snapshot& now,
               const sim::Snapshot& then) {
  const CameraProjection a = lens_of(stage, panel, now), b = lens_of(stage, panel, then);
  const auto way = [&](const Vec3& from, const Vec3& to, double around, double turned) {
    if (a.depth(from) < kNearestDepth || b.depth(to) < kNearestDepth) return 0.0;
    const double scale = a.scale_at(from);
    return seen_travel(a.window, a.page(from), b.page(to), scale * around, scale * turned);
  };
  double most = 0;
  const double across = a.window.width / a.scale / 2, up = a.window.height / a.scale / 2;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner = a.target + (i & 1 ? across : -across) * a.right + (i & 2 ? up : -up) * a.up +
                        (i & 4 ? across : -across) * a.back;
    most = std::max(most, way(corner, corner, across, 0));
  }
  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
    const double far = reach(stage.cast.bodies[i]);
    const double turned = now.bodies[i].spin.norm() * far * (then.time - now.time);
    most = std::max(most, way(now.bodies[i].position, then.bodies[i].position, far, turned));
  }
  for (std::size_t i = 0; stage.look.pointer && i < stage.cast.mice.size(); ++i) {
    const sim::SceneInfo::Mouse& mouse = stage.cast.mice[i];
    if (mouse.path.empty() || !(shown(mouse, now.time) > 0)) continue;
    most = std::max(most, way(along(mouse, now.time), along(mouse, then.time), 0, 0));
  }
  return most;
}

}  // namespace

sim::Snapshot later(const sim::Snapshot& now, double seconds) {
  sim::Snapshot then;
  then.time = now.time + seconds;
  then.bodies = now.bodies;
  for (sim::Snapshot::Body& body : then.bodies) body.position += seconds * body.velocity;
  return then;
}

double reach(const sim::SceneInfo::Body& body) {
  double far = std::max(body.radius + (body.kind == sim::ShapeKind::capsule ? body.half.norm() : 0),
                        body.kind == sim::ShapeKind::box ? body.half.norm() : 0);
  for (const Vec3& vertex : body.vertices) far = std::max(far, vertex.norm());
  for (const sim::SceneInfo::Part& part : body.parts) {
    far = std::max(far, part.center.norm() + part.radius + part.half.norm());
    for (const Vec3& vertex : part.vertices) far = std::max(far, vertex.norm());
  }
  return far;
}

double travel(const Stage& stage, const View& a, const View& b, const sim::Snapshot& now,
              const sim::Snapshot& then) {
  const Rect& w = a.window;
  double most = 0;
  for (const Point& corner : {Point(w.x, w.y), Point(w.x + w.width, w.y), Point(w.x, w.y + w.height),
                              Point(w.x + w.width, w.y + w.height)}) {
    const Point world = (corner - a.origin) / a.scale;
    most = std::max(most, (b.origin + b.scale * world - corner).norm());
  }
  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
    const double far = a.scale * reach(stage.cast.bodies[i]);
    const double turned = now.bodies[i].spin.norm() * far * (then.time - now.time);
    most = std::max(most, seen_travel(w, a.page(now.bodies[i].position), b.page(then.bodies[i].position),
                                      far + stage.dots[i], turned));
  }
  for (std::size_t i = 0; stage.look.pointer && i < stage.cast.mice.size(); ++i) {
    const sim::SceneInfo::Mouse& mouse = stage.cast.mice[i];
    if (mouse.path.empty() || !(shown(mouse, now.time) > 0)) continue;
    most = std::max(most, (b.page(along(mouse, then.time)) - a.page(along(mouse, now.time))).norm());
  }
  return most;
}

double travel(const SpaceStage& stage, const sim::Snapshot& now, const sim::Snapshot& then) {
  double most = 0;
  for (const Panel& panel : stage.panels) most = std::max(most, spatial(stage, panel, now, then));
  return most;
}

}  // namespace obscura::draw
