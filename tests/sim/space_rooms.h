#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "sim/energy/energy.h"
#include "sim/math/exponential.h"
#include "sim/rooms.h"
#include "sim/solids.h"

namespace obscura::sim {

// Worlds of space by hand. Bodies that do not turn go in before those that do.

inline World<3> space(Vec3 gravity = {0, -9.81, 0}) {
  World<3> world;
  world.model.gravity = gravity;
  world.model.rate = {1000, 1};
  return world;
}

/// Any shape as a body that turns, of uniform density.
inline int add_solid(World<3>& world, const Shape<3>& shape, double mass, Vec3 x, Vec3 v = Vec3::Zero(),
                     Orientation<3> turn = no_rotation<3>(), Vec3 spin = Vec3::Zero(),
                     double elasticity = 1) {
  Body<3> body;
  body.name = "solid[" + std::to_string(world.model.bodies.size()) + "]";
  body.shape = shape;
  body.mass = mass, body.elasticity = elasticity;
  body.inertia = solid_inertia(body.shape, mass);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  world.state.turn.push_back(turn), world.state.spin.push_back(spin);
  return int(world.model.bodies.size()) - 1;
}

/// A world of the plane, given a depth (m).
inline World<3> extruded(const World<2>& flat, double depth) {
  World<3> world = space({flat.model.gravity[0], flat.model.gravity[1], 0});
  const auto up = [](const Vec<2>& p) { return Vec3(p[0], p[1], 0); };
  world.model.rate = flat.model.rate, world.model.collision = flat.model.collision;
  world.model.scale = flat.model.scale;
  for (const Wall<2>& wall : flat.model.walls) {
    world.model.walls.push_back({up(wall.point), up(wall.normal), wall.elasticity, wall.friction});
  }
  for (std::size_t i = 0; i < flat.model.bodies.size(); ++i) {
    const Body<2>& body = flat.model.bodies[i];
    Body<3> it;
    it.name = body.name, it.mass = body.mass, it.elasticity = body.elasticity, it.friction = body.friction;
    it.fixed = body.fixed;
    it.shape = extruded(body.shape, depth);
    it.inertia = solid_inertia(it.shape, body.mass);
    if (body.turns()) it.inertia[2] = body.inertia[0];
    world.model.bodies.push_back(it);
    world.state.x.push_back(up(flat.state.x[i])), world.state.v.push_back(up(flat.state.v[i]));
    const int k = turning(flat.state, int(i));
    world.state.turn.push_back(exponential(Vec3(0, 0, flat.state.turn[k][0])));
    world.state.spin.push_back({0, 0, flat.state.spin[k][0]});
  }
  for (const Joint<2>& joint : flat.model.joints) {
    Joint<3> it;
    it.kind = joint.kind == JointKind::pin ? JointKind::hinge : joint.kind;
    it.a = {joint.a.body, up(joint.a.local)}, it.b = {joint.b.body, up(joint.b.local)};
    it.axis = joint.kind == JointKind::pin ? Vec3(0, 0, 1) : up(joint.axis);
    it.turn = {0, 0, joint.turn[0]};
    it.length = joint.length, it.lower = joint.lower, it.upper = joint.upper;
    if (joint.motor) it.motor = Joint<3>::Motor{joint.motor->speed, joint.motor->most};
    it.friction = joint.friction;
    world.model.joints.push_back(it);
  }
  return world;
}

/// A doll of capsules on a ball and a hinge with limits, thrown over the floor.
inline World<3> doll() {
  World<3> world = space();
  world.model.collision = Collision::contact, world.model.rate = {600, 1}, world.model.scale = 4;
  add_wall(world, {0, 0, 0}, {0, 1, 0});
  const Vec3 v(1, 0, 0.3);
  add_solid(world, brick({0.4, 0.6, 0.2}), 6, {0, 1.2, 0}, v, no_rotation<3>(), {0, 0, 0}, 0.2);
  add_solid(world, capsule(0.2, 0.06), 1, {0.3, 1.3, 0}, v, no_rotation<3>(), {0, 0, 0}, 0.2);
  add_solid(world, capsule(0.2, 0.06), 1, {-0.1, 0.65, 0}, v, no_rotation<3>(), {0, 0, 0}, 0.2);
  Joint<3> ball, hinge;
  ball.a = {1, {0, 0.2, 0}}, ball.b = {0, {0.3, 0.3, 0}};
  hinge.kind = JointKind::hinge, hinge.axis = {1, 0, 0};
  hinge.a = {2, {0, 0.25, 0}}, hinge.b = {0, {-0.1, -0.3, 0}}, hinge.lower = -0.5, hinge.upper = 1.5;
  world.model.joints = {ball, hinge};
  for (Body<3>& body : world.model.bodies) body.friction = 0.5, body.group = 1;
  world.model.ignore = {{1, 1}};
  return world;
}

/// Of motion and height, J.
inline double energy(const World<3>& world, const State<3>& state) {
  double sum = 0;
  for (int i = 0; i < int(state.x.size()); ++i)
    sum += kinetic(world.model, state, i) + gravity_energy(world.model, state, i);
  return sum;
}

}  // namespace obscura::sim
