#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "rooms.h"
#include "sim/exponential.h"

namespace obscura::sim {

// Worlds of space by hand. Bodies that do not turn go in before those that do.

inline World<3> space(Vec3 gravity = {0, -9.81, 0}) {
  World<3> world;
  world.model.gravity = gravity;
  world.model.rate = {1000, 1};
  return world;
}

inline int add_point(World<3>& world, Vec3 x, Vec3 v = Vec3::Zero(), double mass = 1, double elasticity = 1,
                     double radius = 0) {
  Body<3> body;
  body.name = "particle[" + std::to_string(world.model.bodies.size()) + "]";
  body.shape.kind = radius > 0 ? ShapeKind::ball : ShapeKind::point;
  body.shape.radius = radius;
  body.mass = mass, body.elasticity = elasticity;
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  return int(world.model.bodies.size()) - 1;
}

/// Any shape as a body that turns, of uniform density.
inline int add_solid(World<3>& world, const Shape<3>& shape, double mass, Vec3 x, Vec3 v = Vec3::Zero(),
                     Turn<3> turn = upright<3>(), Vec3 spin = Vec3::Zero(), double elasticity = 1) {
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

inline Shape<3> brick(Vec3 size) {
  Shape<3> shape;
  shape.kind = ShapeKind::box;
  shape.half = size / 2;
  return shape;
}

inline Shape<3> capsule(double half, double radius) {
  Shape<3> shape;
  shape.kind = ShapeKind::capsule;
  shape.half = {0, half, 0};
  shape.radius = radius;
  return shape;
}

/// A box as a hull: corners as in corner(), faces counter-clockwise from outside.
inline Shape<3> as_hull(const Shape<3>& box) {
  Shape<3> shape;
  shape.kind = ShapeKind::hull;
  for (int i = 0; i < 8; ++i) shape.vertices.push_back(box.center + rotation<3>(box.turn) * corner(box, i));
  shape.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  return shape;
}

inline void add_plane(World<3>& world, Vec3 point, Vec3 normal) {
  world.model.walls.push_back({point, normal / normal.norm(), {}, {}});
}

inline State<3> stepped(const World<3>& world, int steps) {
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < steps; ++i) {
    if (auto trouble = stepper.step(state)) throw *trouble;
  }
  return state;
}

}  // namespace obscura::sim
