#include "draw/compose/readings.h"

#include <cmath>

namespace obscura::draw {
namespace {

using sim::Vec3;

/// A reading of a rotation about a body's centre.
Reading turning(const sim::SceneInfo& cast, const Vec3& middle, const Vec3& value) {
  return {middle, value, cast.dimension == 2 ? value.z() : value.norm()};
}

/// The velocity of a point of a body.
Vec3 velocity_at(const sim::Snapshot& now, int body, const Vec3& point) {
  const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
  const Vec3 r = point - it.position;
  return it.velocity + it.spin.cross(r);
}

/// All that pushes on a body where it touches: one for each that it touches, at the middle of its contacts.
std::vector<Reading> touches(const sim::Snapshot& now, int body, Quantity what) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < now.contacts.size();) {
    const sim::Snapshot::Contact& first = now.contacts[i];
    Vec3 sum = Vec3::Zero(), point = Vec3::Zero();
    double weight = 0;
    for (; i < now.contacts.size(); ++i) {
      const sim::Snapshot::Contact& each = now.contacts[i];
      if (each.body != first.body || each.other != first.other || each.wall != first.wall) break;
      const Vec3& push = what == Quantity::contact ? each.force : each.impulse;
      const double w = std::max(push.dot(each.normal), what == Quantity::normal ? 1e-12 : 0.0);
      sum += push, point += w * each.point, weight += w;
    }
    if ((first.body != body && first.other != body) || !(weight > 0)) continue;
    const double side = first.body == body ? 1 : -1;
    found.push_back(
        {point / weight, side * (what == Quantity::normal ? first.normal : sum), side * sum.norm()});
  }
  return found;
}

/// The pull of each spring on a body, at the point that it holds.
std::vector<Reading> pulls(const sim::SceneInfo& cast, const sim::Snapshot& now, int body) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < cast.springs.size(); ++i) {
    const sim::SceneInfo::Spring& spring = cast.springs[i];
    if (spring.a != body && spring.b != body) continue;
    const bool at_a = spring.a == body;
    const Vec3 here = at_a ? now.springs[i].a : now.springs[i].b,
               there = at_a ? now.springs[i].b : now.springs[i].a;
    const Vec3 way = there - here;
    if (!(way.norm() > 0)) continue;
    found.push_back({here, spring.stiffness * (way.norm() - spring.rest_length) * way.normalized()});
  }
  return found;
}

}  // namespace

std::vector<Reading> readings(const Figure::Vector& vector, const sim::SceneInfo& cast,
                              const sim::Snapshot& now) {
  if (vector.quantity == Quantity::position) {
    const Vec3 tail = vector.at ? place(*vector.at, now) : Vec3(Vec3::Zero());
    const Vec3 tip = vector.to         ? place(*vector.to, now)
                     : vector.body < 0 ? tail
                                       : now.bodies[std::size_t(vector.body)].position;
    return {{tail, tip - tail}};
  }
  if (vector.body < 0) return {};
  const sim::Snapshot::Body& body = now.bodies[std::size_t(vector.body)];
  const Vec3 at = vector.at ? place(*vector.at, now) : body.position;
  switch (vector.quantity) {
    case Quantity::velocity:
      return {{at, velocity_at(now, vector.body, at)}};
    case Quantity::weight:
      return {{at, cast.bodies[std::size_t(vector.body)].mass * cast.gravity}};
    case Quantity::spring:
      return pulls(cast, now, vector.body);
    case Quantity::contact:
    case Quantity::impulse:
    case Quantity::normal:
      return touches(now, vector.body, vector.quantity);
    case Quantity::blast:
      return {{at, body.blast}};
    case Quantity::spin:
      return {turning(cast, body.position, body.spin)};
    case Quantity::torque: {
      Vec3 torque = Vec3::Zero();
      for (const auto& all : {pulls(cast, now, vector.body), touches(now, vector.body, Quantity::contact)})
        for (const Reading& each : all) torque += (each.tail - body.position).cross(each.value);
      return {turning(cast, body.position, torque)};
    }
    case Quantity::position:
      break;
  }
  return {};
}

std::string_view unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::position:
      return "m";
    case Quantity::velocity:
      return "m/s";
    case Quantity::weight:
    case Quantity::spring:
    case Quantity::contact:
    case Quantity::blast:
      return "N";
    case Quantity::impulse:
      return "N s";
    case Quantity::normal:
      return "";
    case Quantity::spin:
      return "rad/s";
    case Quantity::torque:
      return "N m";
  }
  return "";
}

double* scale_of(Quantity quantity, Scales& scales) {
  switch (quantity) {
    case Quantity::velocity:
      return &scales.velocity;
    case Quantity::weight:
    case Quantity::spring:
    case Quantity::contact:
    case Quantity::blast:
      return &scales.force;
    case Quantity::impulse:
      return &scales.impulse;
    default:
      return nullptr;
  }
}

Color color_of(const Figure::Vector& vector, const Palette& colours) {
  if (vector.color) return *vector.color;
  switch (vector.quantity) {
    case Quantity::position:
      return mix(*color("blue"), colours.ink, 0.3);
    case Quantity::velocity:
      return mix(colours.velocity, colours.ink, 0.25);
    case Quantity::normal:
    case Quantity::spin:
    case Quantity::torque:
      return colours.ink;
    default:
      return mix(colours.force, colours.ink, 0.12);
  }
}

Vec3 place(const Site& site, const sim::Snapshot& now) {
  if (site.body < 0) return site.local;
  const sim::Snapshot::Body& body = now.bodies[std::size_t(site.body)];
  return body.position + body.orientation * site.local;
}

}  // namespace obscura::draw
