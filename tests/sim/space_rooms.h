#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "sim/exponential.h"
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

}  // namespace obscura::sim
