#pragma once

#include <cmath>

#include "sim/rooms.h"
#include "sim/trig.h"

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
  body.shape.kind = ShapeKind::ball;
  body.shape.radius = radius;
  body.mass = mass, body.elasticity = elasticity;
  body.inertia = Spin<2>(0.5 * mass * radius * radius);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  world.state.turn.push_back(Turn<2>(0)), world.state.spin.push_back(Spin<2>(spin));
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

}  // namespace obscura::sim
