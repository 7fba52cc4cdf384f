// Forces that a program computes: the order of the scheme, one call a stage, work, exceptions; and runs that
// are restored and set.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

#include "sim/step/run.h"

namespace obscura::sim {
namespace {

// n points of 2 kg at (1, 0) and (1, 0) / 2, ... under f = -8 x, a full turn in pi seconds
template <int D>
World<D> springy(int n, int rate, const ForceFunction<D>& function) {
  World<D> world;
  Model<D>& model = world.model;
  model.rate = {rate, 1}, model.gravity.setZero();
  Force<D> force;
  force.name = "spring";
  force.on = Force<D>::On::among, force.law = Force<D>::Law::function;
  force.function = std::make_shared<const ForceFunction<D>>(function);
  for (int i = 0; i < n; ++i) {
    Body<D> body;
    body.name = "b" + std::to_string(i);
    body.mass = 2;
    model.bodies.push_back(body);
    world.state.x.push_back(Vec<D>::Unit(0) / (1 + i)), world.state.v.push_back(Vec<D>::Unit(1));
    force.subjects.push_back({.body = i});
  }
  model.forces.push_back(std::move(force));
  return world;
}

template <int D>
void pull(const ForceStage<D>& at, std::vector<Vec<D>>& forces, std::vector<AngularVec<D>>&) {
  for (std::size_t i = 0; i < at.x.size(); ++i) forces[i] = -8 * at.x[i];
}

Snapshot shown_at(Run& run, Rational t) { return std::get<Snapshot>(run.at(t)); }

template <int D>
double scheme_error(int rate) {
  const auto run = sim::run(springy<D>(1, rate, pull<D>));
  const Vec3 x = shown_at(*run, {1, 1}).bodies[0].position;
  return std::hypot(x[0] - std::cos(2.0), x[1] - std::sin(2.0) / 2);
}

TEST(FunctionForce, KeepsTheOrderOfTheScheme) {
  EXPECT_NEAR(std::log2(scheme_error<2>(20) / scheme_error<2>(40)), 4, 0.1);
  EXPECT_NEAR(std::log2(scheme_error<3>(20) / scheme_error<3>(40)), 4, 0.1);
}

TEST(FunctionForce, IsCalledOnceAStageForAllBodies) {
  int calls = 0;
  const auto run = sim::run(springy<2>(7, 100, [&](const ForceStage<2>& stage, auto& forces, auto& torques) {
    EXPECT_EQ(stage.x.size(), 7u);
    ++calls;
    pull<2>(stage, forces, torques);
  }));
  calls = 0;
  EXPECT_TRUE(std::holds_alternative<std::monostate>(run->go(10)));
  // four stages, and the two points at which work is booked
  EXPECT_EQ(calls, 60);
}

TEST(FunctionForce, TellsTheWorkItDoes) {
  const auto run = sim::run(springy<2>(1, 600, pull<2>));
  // from x = 1 to x = cos 2: the potential is 4 x^2
  const Snapshot now = shown_at(*run, {1, 1});
  const double x = std::cos(2.0), y = std::sin(2.0) / 2;
  EXPECT_NEAR(now.energies.work, 4 - 4 * (x * x + y * y), 1e-8);
  EXPECT_NEAR(now.energies.kinetic, 1 + now.energies.work, 1e-8);
}

TEST(FunctionForce, WhatItThrowsLeavesTheRunAtItsLastStep) {
  bool fails = false;
  const auto run = sim::run(springy<2>(2, 100, [&](const ForceStage<2>& stage, auto& forces, auto& torques) {
    if (fails && stage.time > 0.104) throw std::domain_error("enough");
    pull<2>(stage, forces, torques);
  }));
  (void)run->go(10);
  const auto before = run->words();
  fails = true;
  EXPECT_THROW((void)run->go(11), std::domain_error);
  EXPECT_EQ(run->words(), before);
  fails = false;
  (void)run->go(20);
  const auto other = sim::run(springy<2>(2, 100, pull<2>));
  (void)other->go(20);
  EXPECT_EQ(run->words(), other->words());
}

TEST(FunctionForce, ThatIsNoNumberIsTroubleOfItsBody) {
  const auto run = sim::run(springy<3>(2, 100, [](const ForceStage<3>&, auto& forces, auto&) {
    forces[1][2] = std::numeric_limits<double>::quiet_NaN();
  }));
  const auto end = run->go(1);
  EXPECT_EQ(std::get<Trouble>(end).body, "b1");
  EXPECT_EQ(std::get<Trouble>(end).quantity, "force");
}

// a box of 6 kg in space, turned by a torque about its own x axis, I = 6.5 kg m^2
TEST(FunctionForce, TurnsBodiesInTheAxesOfTheRoom) {
  World<3> world = springy<3>(1, 600, [](const ForceStage<3>& stage, auto&, auto& torques) {
    torques[0] = 6.5 * stage.room_from_body[0].col(0);
  });
  world.model.bodies[0].inertia = {6.5, 4, 3};
  world.state.v[0].setZero();
  // its x axis lies along the room's y
  world.state.turn = {Orientation<3>(0, 0, std::sqrt(0.5), std::sqrt(0.5))};
  world.state.spin = {Vec<3>::Zero()};
  const auto run = sim::run(world);
  const Snapshot now = shown_at(*run, {1, 1});
  EXPECT_NEAR(now.bodies[0].spin[1], 1, 1e-9);
  EXPECT_NEAR(now.energies.work, 0.5 * 6.5, 1e-7);
}

// a block of 2 kg on the floor with mu = 1/2 is pushed with 15 N: a = (15 - mu m g) / m
TEST(FunctionForce, ActsWhereBodiesTouchByEachSolver) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    World<2> world = springy<2>(1, 600, [](const ForceStage<2>&, auto& forces, auto&) {
      forces[0] = {15, 0};
    });
    Model<2>& model = world.model;
    model.collision = Collision::contact, model.solver = solver, model.gravity = {0, -9.81};
    model.walls.push_back({});
    model.bodies[0].shape = Box<2>{{0.5, 0.5}};
    model.bodies[0].inertia[0] = 1.0 / 3, model.bodies[0].friction = 0.5, model.bodies[0].elasticity = 0;
    world.state.x = {{1, 0.5}}, world.state.v = {{0, 0}};
    world.state.turn = {Orientation<2>::Zero()}, world.state.spin = {AngularVec<2>::Zero()};
    const auto run = sim::run(world);
    EXPECT_NEAR(shown_at(*run, {1, 1}).bodies[0].velocity[0], (15 - 0.5 * 2 * 9.81) / 2, 1e-3) << int(solver);
  }
}

TEST(Run, IsRestoredWhereItIs) {
  const auto run = sim::run(springy<2>(3, 100, pull<2>));
  (void)run->go(10);
  const auto saved = run->saved();
  const double* const x = run->columns().x.first;
  (void)run->go(30);
  const auto end = run->words();
  ASSERT_TRUE(run->restore(saved));
  EXPECT_EQ(run->columns().x.first, x);
  (void)run->go(30);
  EXPECT_EQ(run->words(), end);
  const auto other = sim::run(springy<2>(2, 100, pull<2>));
  EXPECT_FALSE(other->restore(saved));
}

TEST(Run, GoesOnFromColumnsThatAreSet) {
  World<2> world = springy<2>(2, 100, [](const auto&, auto&, auto&) {});
  const auto run = sim::run(world);
  (void)run->go(10);
  const std::vector<double> v = {1, 0, 0, -1}, x = {0, 0, 5, 5};
  EXPECT_EQ(run->set({.x = x, .v = v}), "");
  (void)run->go(110);
  const BodyColumns now = run->columns();
  EXPECT_NEAR(now.x.first[0], 1, 1e-12);
  EXPECT_NEAR(now.x.first[3], 4, 1e-12);
  EXPECT_NE(run->set({.x = {x.data(), 3}}), "");
  const std::vector<double> none(4, std::nan(""));
  EXPECT_NE(run->set({.v = none}), "");
  EXPECT_NEAR(run->columns().x.first[0], 1, 1e-12);
}

}  // namespace
}  // namespace obscura::sim
