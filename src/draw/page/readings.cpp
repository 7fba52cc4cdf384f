#include "draw/page/readings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "draw/page/touching.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kNegligible = 1e-9;

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

/// What a contact gives, as a quantity has it: all of the force, its part along the normal, what is left.
Vec3 given(const sim::Snapshot::Contact& contact, Quantity what) {
  const Vec3 normal = contact.force.dot(contact.normal) * contact.normal;
  switch (what) {
    case Quantity::contact:
      return contact.force;
    case Quantity::normal_force:
      return normal;
    case Quantity::friction:
      return contact.force - normal;
    default:
      return contact.impulse;
  }
}

/// All that pushes on a body where it touches: one for each that it touches, at the middle of its contacts.
std::vector<Reading> touches(const sim::Snapshot& now, int body, Quantity what) {
  std::vector<Reading> found;
  const bool forces = what != Quantity::impulse && what != Quantity::normal;
  const auto push = [&](const sim::Snapshot::Contact& each) -> const Vec3& {
    return forces ? each.force : each.impulse;
  };
  each_touching(now, push, what == Quantity::normal ? 1e-12 : 0.0, [&](const Touching& all) {
    const sim::Snapshot::Contact& first = all.first;
    if ((first.body != body && first.other != body) || !(all.pressed > 0)) return;
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = all.begin; i < all.end; ++i) sum += given(now.contacts[i], what);
    const double side = first.body == body ? 1 : -1;
    const int part = first.body != body ? first.body : first.other >= 0 ? first.other : -1 - first.wall;
    found.push_back(
        {all.point, side * (what == Quantity::normal ? first.normal : sum), side * sum.norm(), part});
  });
  return found;
}

/// The pull of each spring on a body, at the point that it holds: of its stiffness alone, or with its
/// damping.
std::vector<Reading> pulls(const sim::SceneInfo& cast, const sim::Snapshot& now, int body, bool damping) {
  std::vector<Reading> found;
  for (std::size_t i = 0; i < cast.springs.size(); ++i) {
    const sim::SceneInfo::Spring& spring = cast.springs[i];
    if ((spring.a != body && spring.b != body) || now.springs[i].loose) continue;
    const bool at_a = spring.a == body;
    const Vec3 here = at_a ? now.springs[i].a : now.springs[i].b,
               there = at_a ? now.springs[i].b : now.springs[i].a;
    const Vec3 way = there - here;
    if (!(way.norm() > 0)) continue;
    const Vec3 stretch = -now.springs[i].push * way.normalized();
    found.push_back({here, damping ? Vec3((at_a ? 1 : -1) * now.springs[i].force) : stretch, 0, int(i)});
  }
  return found;
}

/// What each joint gives a body, at the point that it holds: the force, or the torque about that point.
std::vector<Reading> held(const sim::SceneInfo& cast, const sim::Snapshot& now, int body,
                          bool torque = false) {
  std::vector<Reading> found;
  const auto add = [&](const Vec3& place, const Vec3& value, std::size_t part) {
    if (torque && value.isZero(0)) return;
    Reading reading{place, value, 0, int(part)};
    if (torque) reading.signed_value = cast.dimension == 2 ? value.z() : value.norm();
    found.push_back(reading);
  };
  const std::size_t n = cast.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    const sim::SceneInfo::Joint& joint = cast.joints[i];
    const sim::Snapshot::Joint& it = now.joints[i];
    if (it.broken) continue;
    if (!joint.places.empty()) {
      std::size_t part = i;
      for (const sim::Snapshot::Joint::Hold& hold : it.holds) {
        if (hold.body != body) continue;
        add(torque ? hold.place : hold.at, torque ? hold.torque : hold.force, part);
        part += n;
      }
      continue;
    }
    if (joint.a == body) add(it.a, torque ? it.torque : it.force, i);
    if (joint.b == body)
      add(it.b, torque ? Vec3(-it.torque - (it.a - it.b).cross(it.force)) : Vec3(-it.force), i);
  }
  return found;
}

Vec3 total(const std::vector<Reading>& all) {
  Vec3 sum = Vec3::Zero();
  for (const Reading& each : all) sum += each.value;
  return sum;
}

/// The sum of all forces on a body; of a fixed one none, for what holds it is not known.
Vec3 net_force(const sim::SceneInfo& cast, const sim::Snapshot& now, int body) {
  const sim::SceneInfo::Body& its = cast.bodies[std::size_t(body)];
  if (its.fixed) return Vec3::Zero();
  const sim::Snapshot::Body& it = now.bodies[std::size_t(body)];
  Vec3 sum = sim::mass(cast, now, body) * now.gravity.value_or(cast.gravity) + it.drag + it.field + it.blast +
             it.held;
  sum += total(touches(now, body, Quantity::contact)) + total(pulls(cast, now, body, true));
  for (const sim::Snapshot::Mouse& mouse : now.mice)
    if (mouse.body == body) sum += mouse.force;
  return sum;
}

}  // namespace

namespace {

std::vector<Reading> all_readings(const Marks::Vector& vector, const sim::SceneInfo& cast,
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
    case Quantity::acceleration:
      return {{at, net_force(cast, now, vector.body) / sim::mass(cast, now, vector.body)}};
    case Quantity::momentum:
      return {{at, sim::mass(cast, now, vector.body) * body.velocity}};
    case Quantity::weight:
      return {{at, sim::mass(cast, now, vector.body) * now.gravity.value_or(cast.gravity)}};
    case Quantity::net_force:
      return {{at, net_force(cast, now, vector.body)}};
    case Quantity::drag:
      return {{at, body.drag}};
    case Quantity::field:
      return {{at, body.field}};
    case Quantity::spring:
    case Quantity::spring_force:
      return pulls(cast, now, vector.body, vector.quantity == Quantity::spring_force);
    case Quantity::joint_force:
      return held(cast, now, vector.body);
    case Quantity::joint_torque:
      return held(cast, now, vector.body, true);
    case Quantity::contact:
    case Quantity::normal_force:
    case Quantity::friction:
    case Quantity::impulse:
    case Quantity::normal:
      return touches(now, vector.body, vector.quantity);
    case Quantity::blast:
      return {{at, body.blast}};
    case Quantity::spin:
      return {turning(cast, body.position, body.spin)};
    case Quantity::torque: {
      Vec3 torque = body.torque;
      for (const auto& all :
           {pulls(cast, now, vector.body, true), touches(now, vector.body, Quantity::contact)})
        for (const Reading& each : all) torque += (each.tail - body.position).cross(each.value);
      for (const sim::Snapshot::Mouse& mouse : now.mice)
        if (mouse.body == vector.body) torque += (mouse.held - body.position).cross(mouse.force);
      return {turning(cast, body.position, torque)};
    }
    case Quantity::position:
      break;
  }
  return {};
}

/// Whether an arrow of it begins where something touches or holds the body.
bool has_place(Quantity quantity) {
  switch (quantity) {
    case Quantity::spring:
    case Quantity::spring_force:
    case Quantity::joint_force:
    case Quantity::contact:
    case Quantity::normal_force:
    case Quantity::friction:
    case Quantity::impulse:
      return true;
    default:
      return false;
  }
}

}  // namespace

std::vector<Reading> readings(const Marks::Vector& vector, const sim::SceneInfo& cast,
                              const sim::Snapshot& now) {
  std::vector<Reading> all = all_readings(vector, cast, now);
  // forces begin where they act, or where the scene has them
  if (vector.at && vector.body >= 0 && has_place(vector.quantity))
    for (Reading& each : all) each.tail = place(*vector.at, now);
  if (vector.with.empty()) return all;
  // a rope over wheels has more parts, behind those of all joints
  const bool joints = vector.quantity == Quantity::joint_force || vector.quantity == Quantity::joint_torque;
  std::erase_if(all, [&](const Reading& each) {
    const int part = joints ? each.part % int(cast.joints.size()) : each.part;
    return std::find(vector.with.begin(), vector.with.end(), part) == vector.with.end();
  });
  return all;
}

void number_arrows(Marks& marks, const sim::SceneInfo& cast, std::span<const sim::Snapshot> moments,
                   std::span<const double> films) {
  for (Marks::Vector& vector : marks.vectors) {
    vector.numbered.clear();
    if (vector.label.empty()) continue;
    bool several = false;
    std::vector<int> seen;
    for (std::size_t k = 0; k < moments.size(); ++k) {
      const double film = films.empty() ? std::numeric_limits<double>::quiet_NaN() : films[k];
      const bool shown = films.empty() ? vector.shown.in(int(k)) : vector.shown.has(moments[k].time, film);
      if (!shown) continue;
      int now = 0;
      for (const Reading& each : readings(vector, cast, moments[k])) {
        if (each.value.isZero(0)) continue;
        ++now;
        if (std::find(seen.begin(), seen.end(), each.part) == seen.end()) seen.push_back(each.part);
      }
      several = several || now > 1;
    }
    if (several) vector.numbered = std::move(seen);
  }
}

Vec3 sum(Quantity quantity, int body, const sim::SceneInfo& cast, const sim::Snapshot& now) {
  Marks::Vector vector;
  vector.quantity = quantity, vector.body = body;
  return body < 0 ? Vec3(Vec3::Zero()) : total(readings(vector, cast, now));
}

std::string_view unit(Quantity quantity) {
  switch (quantity) {
    case Quantity::position:
      return "m";
    case Quantity::velocity:
      return "m/s";
    case Quantity::acceleration:
      return "m/s²";
    case Quantity::momentum:
      return "kg m/s";
    case Quantity::impulse:
      return "N s";
    case Quantity::normal:
      return "";
    case Quantity::spin:
      return "rad/s";
    case Quantity::torque:
    case Quantity::joint_torque:
      return "N m";
    default:
      return "N";
  }
}

bool of_steps(Quantity quantity) {
  switch (quantity) {
    case Quantity::position:
    case Quantity::velocity:
    case Quantity::momentum:
    case Quantity::weight:
    case Quantity::spring:
    case Quantity::spring_force:
    case Quantity::drag:
    case Quantity::field:
    case Quantity::spin:
      return false;
    case Quantity::acceleration:
    case Quantity::normal_force:
    case Quantity::friction:
    case Quantity::net_force:
    case Quantity::joint_force:
    case Quantity::contact:
    case Quantity::impulse:
    case Quantity::blast:
    case Quantity::normal:
    case Quantity::torque:
    case Quantity::joint_torque:
      return true;
  }
  return true;
}

double negligible(std::string_view unit, const sim::SceneInfo& cast, int body) {
  double mass = 0;
  if (body >= 0)
    mass = cast.bodies[std::size_t(body)].mass;
  else
    for (const sim::SceneInfo::Body& each : cast.bodies) mass = std::max(mass, each.mass);
  if (!(mass > 0)) mass = 1;
  // a length of the scene, and an acceleration: that of gravity, or the length in a square second
  const double length = cast.scale, acceleration = std::max(cast.gravity.norm(), length);
  double typical = 1;
  if (unit == "m")
    typical = length;
  else if (unit == "m/s")
    typical = std::sqrt(acceleration * length);
  else if (unit == "m/s²")
    typical = acceleration;
  else if (unit == "kg m/s" || unit == "N s")
    typical = mass * std::sqrt(acceleration * length);
  else if (unit == "N")
    typical = mass * acceleration;
  else if (unit == "J" || unit == "N m")
    typical = mass * acceleration * length;
  return kNegligible * std::min(1.0, typical);
}

double* scale_of(Quantity quantity, Scales& scales) {
  switch (quantity) {
    case Quantity::position:
    case Quantity::normal:
    case Quantity::spin:
    case Quantity::torque:
    case Quantity::joint_torque:
      return nullptr;
    case Quantity::velocity:
      return &scales.velocity;
    case Quantity::acceleration:
      return &scales.acceleration;
    case Quantity::momentum:
      return &scales.momentum;
    case Quantity::impulse:
      return &scales.impulse;
    default:
      return &scales.force;
  }
}

Color inked(Color color, const Palette& colours) { return color == Color{0, 0, 0} ? colours.ink : color; }

Color color_of(const Marks::Vector& vector, const Palette& colours) {
  if (vector.color) return inked(*vector.color, colours);
  if (vector.quiet) return colours.quiet;
  switch (vector.quantity) {
    case Quantity::position:
      return mix(*color("blue"), colours.ink, 0.3);
    case Quantity::velocity:
    case Quantity::momentum:
      return mix(colours.velocity, colours.ink, 0.25);
    case Quantity::acceleration:
      return mix(*color("purple"), colours.ink, 0.3);
    case Quantity::normal:
    case Quantity::spin:
    case Quantity::torque:
    case Quantity::joint_torque:
      return colours.ink;
    default:
      return mix(colours.force, colours.ink, 0.12);
  }
}

bool Interval::has(double time, double film) const {
  constexpr double kSame = 1e-9;
  const auto past = [&](const Cue& cue) {
    return cue.after && !std::isnan(film) ? film >= cue.film - kSame : time >= cue.time - kSame;
  };
  return (!start || past(*start)) && (!end || !past(*end));
}

Vec3 place(const Site& site, const sim::Snapshot& now) {
  if (site.body < 0) return site.local;
  const sim::Snapshot::Body& body = now.bodies[std::size_t(site.body)];
  return body.position + body.orientation * site.local;
}

}  // namespace obscura::draw
