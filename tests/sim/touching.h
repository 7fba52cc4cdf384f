#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/trig.h"
#include "sim/rooms.h"

namespace obscura::sim {

// Worlds in which things touch.

inline World<2> touching_room(Collision collision = Collision::contact, Vec2 gravity = {0, -9.81}) {
  World<2> world = room(gravity);
  world.model.rate = {600, 1};
  world.model.collision = collision;
  world.model.scale = 4;
  return world;
}

/// A disc that turns.
inline int add_ball(World<2>& world, double radius, double mass, Vec2 x, Vec2 v = {0, 0}, double spin = 0,
                    double elasticity = 1) {
  Body<2> body;
  body.name = "ball[" + std::to_string(world.model.bodies.size()) + "]";
  body.shape = Ball<2>{radius};
  body.mass = mass, body.elasticity = elasticity;
  body.inertia = AngularVec<2>(0.5 * mass * radius * radius);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  world.state.turn.push_back(Orientation<2>(0)), world.state.spin.push_back(AngularVec<2>(spin));
  return int(world.model.bodies.size()) - 1;
}

inline void rub(World<2>& world, double mu) {
  for (Body<2>& body : world.model.bodies) body.friction = mu;
}

/// Kinetic energy and gravity's, J.
inline double energy(const World<2>& world, const State<2>& state) {
  double sum = 0;
  for (int i = 0; i < int(world.model.bodies.size()); ++i) {
    const Body<2>& body = world.model.bodies[i];
    if (body.fixed) continue;
    sum += 0.5 * body.mass * state.v[i].squaredNorm() - body.mass * world.model.gravity.dot(state.x[i]);
    if (const int k = turning(state, i); k >= 0)
      sum += 0.5 * body.inertia[0] * state.spin[k][0] * state.spin[k][0];
  }
  return sum;
}

/// Steps, and wants the energy after each, less the booked work of pushing bodies out of overlaps, to be at
/// most that before it, but for `slack` of that or of `size`, J, where this is more; and that work to stay
/// under 1e-4 of it. `what` is told when it rises.
inline void expect_no_gain(const World<2>& world, int steps, double slack, const std::string& what,
                           double size = 0) {
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  double before = energy(world, state);
  const double all = std::max(std::abs(before), size);
  for (int i = 0; i < steps; ++i) {
    ASSERT_FALSE(stepper.step(state)) << what << " at step " << i;
    const double now = energy(world, state) - state.ledger.displacement;
    ASSERT_LE(now, before + slack * std::max(std::abs(before), size)) << what << " at step " << i;
    before = now;
  }
  EXPECT_LE(std::abs(state.ledger.displacement), 1e-4 * all) << what;
}

/// A convex polygon, its corners about a point that lies at `x` when it is not turned. Mass in kg.
inline int add_polygon(World<2>& world, std::vector<Vec2> corners, double mass, Vec2 x, Vec2 v = {0, 0},
                       double angle = 0, double spin = 0, double elasticity = 1) {
  Body<2> body;
  body.name = "polygon[" + std::to_string(world.model.bodies.size()) + "]";
  const Vec2 c = mass_properties(Shape<2>(Polygon{corners})).center;
  for (Vec2& corner : corners) corner -= c;
  body.shape = Polygon{std::move(corners)};
  body.mass = mass, body.elasticity = elasticity;
  body.inertia = inertia(body.shape, mass);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x + rotation<2>(Orientation<2>(angle)) * c), world.state.v.push_back(v);
  world.state.turn.push_back(Orientation<2>(angle)), world.state.spin.push_back(AngularVec<2>(spin));
  return int(world.model.bodies.size()) - 1;
}

/// Numbers that look random and are the same everywhere: splitmix64.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed) {}

  double between(double low, double high) {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u, z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double((z ^ (z >> 31)) >> 11) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

/// A polygon of `n` corners on a circle, out of true by up to a third of their spacing.
inline std::vector<Vec2> odd_polygon(Chance& chance, int n, double radius) {
  std::vector<Vec2> corners;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::acos(-1) * (i + chance.between(-0.33, 0.33)) / n;
    // the same heap on every machine
    const SinCos at = sin_cos(angle);
    corners.push_back(radius * Vec2(at.cos, at.sin));
  }
  return corners;
}

/// Momentum and, last, angular momentum about the origin.
inline Eigen::Vector3d momenta(const World<2>& world, const State<2>& state) {
  Eigen::Vector3d sum(0, 0, 0);
  for (int i = 0; i < int(world.model.bodies.size()); ++i) {
    const Body<2>& body = world.model.bodies[i];
    const Vec2 p = body.mass * state.v[i];
    sum += Eigen::Vector3d(p.x(), p.y(), state.x[i].x() * p.y() - state.x[i].y() * p.x());
    if (const int k = turning(state, i); k >= 0) sum[2] += body.inertia[0] * state.spin[k][0];
  }
  return sum;
}

/// By how much the contact forces leave Coulomb's cone, of the room's largest weight.
inline double outside_cone(const World<2>& world, const State<2>& state) {
  double worst = 0, heaviest = 0;
  for (const Body<2>& body : world.model.bodies)
    heaviest = std::max(heaviest, body.mass * world.model.gravity.norm());
  for (const auto& contact : state.contacts) {
    double mu = world.model.bodies[contact.key.a].friction;
    if (contact.key.b >= 0) mu = std::sqrt(mu * world.model.bodies[contact.key.b].friction);
    const double fn = contact.force.dot(contact.normal);
    const double ft = (contact.force - fn * contact.normal).norm();
    worst = std::max({worst, -fn, ft - mu * std::max(fn, 0.0)});
  }
  return worst / heaviest;
}

/// The deepest that things lie in each other, m: by the gaps the state reports.
inline double deepest(const State<2>& state) {
  double depth = 0;
  for (const auto& contact : state.contacts) depth = std::max(depth, -contact.gap);
  return depth;
}

/// The force (N) that everything but gravity and joints puts on a body.
inline Vec2 carried(const State<2>& state, int body) {
  Vec2 sum(0, 0);
  for (const auto& contact : state.contacts) {
    if (contact.key.a == body) sum += contact.force;
    if (contact.key.b == body) sum -= contact.force;
  }
  return sum;
}

}  // namespace obscura::sim
