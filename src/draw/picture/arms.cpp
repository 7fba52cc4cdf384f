#include "draw/picture/arms.h"

#include <algorithm>

namespace obscura::draw {
namespace {

using sim::Vec3;

// how far p, in the frame of one convex form, is from it, m
double off(const auto& form, const Vec3& p) {
  switch (form.kind) {
    case sim::ShapeKind::point:
    case sim::ShapeKind::ball:
      return std::max(0.0, p.norm() - form.radius);
    case sim::ShapeKind::box:
      return (p.cwiseAbs() - form.half).cwiseMax(0).norm();
    case sim::ShapeKind::capsule: {
      const Vec3 axis(0, std::clamp(p.y(), -form.half.y(), form.half.y()), 0);
      return std::max(0.0, (p - axis).norm() - form.radius);
    }
    default:
      break;
  }
  double radius = 0;
  for (const Vec3& vertex : form.vertices) radius = std::max(radius, vertex.norm());
  const std::size_t n = form.vertices.size();
  if (form.kind != sim::ShapeKind::polygon || n < 3) return std::max(0.0, p.norm() - radius);
  // of a convex polygon at least as far as beyond each of its sides
  double far = 0, turn = 0;
  const auto cross = [](const Vec3& a, const Vec3& b) { return a.x() * b.y() - a.y() * b.x(); };
  for (std::size_t k = 0; k < n; ++k) turn += cross(form.vertices[k], form.vertices[(k + 1) % n]);
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 side = form.vertices[(k + 1) % n] - form.vertices[k];
    if (side.norm() > 0)
      far = std::max(far, cross(p - form.vertices[k], side) / side.norm() * (turn > 0 ? 1 : -1));
  }
  return far;
}

}  // namespace

double beyond(const sim::SceneInfo::Body& body, const Vec3& local) {
  if (body.parts.empty()) return off(body, local);
  double least = 1e300;
  for (const auto& part : body.parts)
    least = std::min(least, off(part, part.turn.conjugate() * (local - part.center)));
  return least;
}

std::vector<Arm> arms(const sim::SceneInfo& cast, const sim::Snapshot& now, double margin) {
  std::vector<Arm> all;
  for (std::size_t i = 0; i < now.joints.size() && i < cast.joints.size(); ++i) {
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    const bool point = joint.kind == sim::JointKind::pin || joint.kind == sim::JointKind::hinge ||
                       joint.kind == sim::JointKind::weld;
    if (!point || now.joints[i].broken) continue;
    for (const auto& [body, at] :
         {std::pair(joint.a, now.joints[i].a), std::pair(joint.b, now.joints[i].b)}) {
      if (body < 0 || cast.bodies[std::size_t(body)].bare) continue;
      const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
      const Vec3 local = it.orientation.conjugate() * (at - it.position);
      if (beyond(cast.bodies[std::size_t(body)], local) > margin)
        all.push_back({int(i), body, it.position, at});
    }
  }
  return all;
}

}  // namespace obscura::draw
