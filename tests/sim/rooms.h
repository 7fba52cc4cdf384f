#pragma once

#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/model/state.h"
#include "sim/shape/shape.h"
#include "sim/step/run.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

// Worlds by hand, one thing at a time. Bodies that do not turn go in before those that do.

using Vec2 = Vec<2>;

inline World<2> room(Vec2 gravity = {0, -9.81}) {
  World<2> world;
  world.model.gravity = gravity;
  world.model.rate = {1000, 1};
  return world;
}

template <int D>
int add_particle(World<D>& world, std::type_identity_t<Vec<D>> x,
                 std::type_identity_t<Vec<D>> v = Vec<D>::Zero(), double mass = 1, double elasticity = 1,
                 double radius = 0) {
  Body<D> body;
  body.name = "particle[" + std::to_string(world.model.bodies.size()) + "]";
  if (radius > 0) body.shape = Ball<D>{radius};
  body.mass = mass, body.elasticity = elasticity;
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  return int(world.model.bodies.size()) - 1;
}

inline int add_box(World<2>& world, Vec2 size, double mass, Vec2 x, Vec2 v = {0, 0}, double angle = 0,
                   double spin = 0, double elasticity = 1) {
  Body<2> body;
  body.name = "box[" + std::to_string(world.model.bodies.size()) + "]";
  body.shape = Box<2>{size / 2};
  body.mass = mass, body.elasticity = elasticity;
  body.inertia = inertia(body.shape, mass);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  world.state.turn.push_back(Orientation<2>(angle)), world.state.spin.push_back(AngularVec<2>(spin));
  return int(world.model.bodies.size()) - 1;
}

template <int D>
void add_wall(World<D>& world, std::type_identity_t<Vec<D>> point, std::type_identity_t<Vec<D>> normal) {
  world.model.walls.push_back({point, normal / normal.norm(), {}, {}});
}

/// Floor, ceiling and two walls around (0, 0) .. (w, h).
inline void add_walls(World<2>& world, double w, double h) {
  add_wall(world, {0, 0}, {0, 1}), add_wall(world, {0, h}, {0, -1});
  add_wall(world, {0, 0}, {1, 0}), add_wall(world, {w, 0}, {-1, 0});
  world.model.scale = h;
}

inline void add_spring(World<2>& world, End<2> a, End<2> b, double k, double rest, double c = 0) {
  world.model.springs.push_back({a, b, rest, k, c});
}

inline Snapshot shown(Run& run, Rational t) {
  auto answer = run.at(t);
  if (const auto* trouble = std::get_if<Trouble>(&answer)) throw *trouble;
  return std::get<Snapshot>(std::move(answer));
}

/// The state after whole steps, without a Run around it.
template <int D>
State<D> stepped(const World<D>& world, int steps) {
  State<D> state = world.state;
  Stepper<D> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < steps; ++i) {
    if (auto trouble = stepper.step(state)) throw *trouble;
  }
  return state;
}

}  // namespace obscura::sim
