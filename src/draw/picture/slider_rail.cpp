#include "draw/picture/slider_rail.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kEndless = 1e299;  // m: limits beyond it are none
constexpr double kNowhere = std::numeric_limits<double>::infinity();

// takes in how far a convex form goes along a unit vector, both in its frame and from `middle` there, m
void take_in(const auto& form, const Vec3& along, double middle, SliderRail& rail) {
  double from = -form.radius, to = form.radius;
  if (form.kind == sim::ShapeKind::box) {
    to = along.cwiseAbs().dot(form.half), from = -to;
  } else if (form.kind == sim::ShapeKind::capsule) {
    to = std::fabs(along.y()) * form.half.y() + form.radius, from = -to;
  } else if (!form.vertices.empty()) {
    from = kNowhere, to = -kNowhere;
    for (const Vec3& vertex : form.vertices)
      from = std::min(from, along.dot(vertex)), to = std::max(to, along.dot(vertex));
  }
  rail.from = std::min(rail.from, middle + from), rail.to = std::max(rail.to, middle + to);
}

}  // namespace

SliderRail slider_rail(const sim::SceneInfo& cast, const sim::Snapshot& now, std::size_t number) {
  const sim::SceneInfo::Joint& joint = cast.joints[number];
  SliderRail rail{-kNowhere, kNowhere};
  if (joint.b >= 0 && !cast.bodies[std::size_t(joint.b)].fixed) {
    const sim::SceneInfo::Body& body = cast.bodies[std::size_t(joint.b)];
    const sim::Snapshot::Body& at = now.bodies[std::size_t(joint.b)];
    const Vec3 home = at.orientation.conjugate() * (now.joints[number].b - at.position);
    const double way =
        joint.axis.dot(at.orientation.conjugate() * (now.joints[number].a - now.joints[number].b));
    const double middle = -joint.axis.dot(home);
    rail = {std::min({0.0, way, middle}), std::max({0.0, way, middle})};
    if (body.parts.empty()) take_in(body, joint.axis, middle, rail);
    for (const sim::SceneInfo::Part& part : body.parts)
      take_in(part, part.turn.conjugate() * joint.axis, middle + joint.axis.dot(part.center), rail);
  }
  if (joint.lower > -kEndless) rail.from = joint.lower;
  if (joint.upper < kEndless) rail.to = joint.upper;
  return rail;
}

}  // namespace obscura::draw
