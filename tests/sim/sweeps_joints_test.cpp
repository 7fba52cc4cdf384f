// Joints of space by sweeps: against the plane's, closed forms, and the direct solver.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/constraint/joints/joint.h"
#include "sim/jointed.h"
#include "sim/space_rooms.h"

namespace obscura::sim {
namespace {

// how far the equalities of all joints are off at most, m or rad
double off(const World<3>& world, const State<3>& state) {
  double worst = 0;
  const BodyMotion<3> room;
  for (const Joint<3>& joint : world.model.joints) {
    Row<3> out[kMostHeld<3>];
    double offs[kMostHeld<3>];
    const auto side = [&](int body) { return body < 0 ? room : body_motion(state, body); };
    const int n = rows(joint, side(joint.a.body), side(joint.b.body), Vec3::Zero(), out, offs);
    for (int i = 0; i < n; ++i) worst = std::max(worst, std::fabs(offs[i]));
  }
  return worst;
}

World<3> swept(World<3> world) {
  world.model.solver = Solver::iterative;
  return world;
}

// one scheme, twice written: Rattle of the plane's iterative solver and of the sweeps
TEST(SweptJoints, PlanarPendulumsOfHingesSwingAsInThePlane) {
  World<2> flat = touching_room();
  flat.model.solver = Solver::iterative;
  add_box(flat, {0.02, 1}, 1, {0.5, 0}, {0, 0}, std::numbers::pi / 2);
  add_box(flat, {0.02, 1}, 1, {1.5, 0}, {0, 0}, std::numbers::pi / 2);
  flat.model.joints = {pin({0, {0, 0.5}}, {-1, {0, 0}}), pin({1, {0, 0.5}}, {0, {0, -0.5}})};
  World<3> deep = swept(extruded(flat, 0.1));
  for (Joint<3>& joint : deep.model.joints) joint.turn.setZero();
  const State<2> want = stepped(flat, 1800);
  const State<3> is = stepped(deep, 1800);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR((is.x[i].head<2>() - want.x[i]).norm(), 0, 1e-9) << i;
    EXPECT_NEAR(is.x[i][2], 0, 1e-12) << i;
  }
  EXPECT_LE(off(deep, is), 1e-13) << "joints do not drift";
}

// both integrate the joints' forces stage by stage: one scheme, twice written
TEST(SweptJoints, ADollInFlightMovesAsByTheDirectSolver) {
  const auto error = [](int rate) {
    World<3> world = doll();
    world.model.walls.clear();
    world.model.rate = {rate, 1};
    world.state.spin[0] = {0.5, -0.7, 2};
    for (Joint<3>& joint : world.model.joints) joint.lower = -3, joint.upper = 3;
    world.model.joints[0].lower = -1e300, world.model.joints[0].upper = 1e300;
    // begin with velocities that agree
    world.state = stepped(world, 1);
    const State<3> want = stepped(world, rate / 2), is = stepped(swept(world), rate / 2);
    double worst = 0;
    for (std::size_t i = 0; i < is.x.size(); ++i) worst = std::max(worst, (is.x[i] - want.x[i]).norm());
    return worst;
  };
  for (const int rate : {300, 600, 1200}) EXPECT_LT(error(rate), 1e-12) << rate;
}

TEST(SweptJoints, AMotorReachesItsSpeedAtItsTorqueAndASliderItsLimit) {
  World<3> world = swept(space({0, 0, 0}));
  world.model.collision = Collision::contact, world.model.scale = 4, world.model.rate = {600, 1};
  add_solid(world, brick({0.1, 0.4, 0.2}), 2, {0, 0, 0});
  Joint<3> hinge;
  hinge.kind = JointKind::hinge, hinge.axis = {1, 0, 0};
  hinge.a = {0, {0, 0, 0}}, hinge.b = {-1, {0, 0, 0}};
  hinge.motor = Joint<3>::Motor{3, 0.5};
  world.model.joints = {hinge};
  const double rate = 0.5 / world.model.bodies[0].inertia[0];
  EXPECT_NEAR((stepped(world, 12).spin[0] - Vec3(0.02 * rate, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((stepped(world, 3000).spin[0] - Vec3(3, 0, 0)).norm(), 0, 1e-12);

  world.model.gravity = {0, -9.81, 0};
  Joint<3> slider;
  slider.kind = JointKind::slider, slider.axis = Vec3(2, -2, 1) / 3, slider.upper = 1;
  slider.a = {0, {0, 0, 0}}, slider.b = {-1, {0, 0, 0}};
  world.model.joints = {slider};
  EXPECT_NEAR((stepped(world, 300).x[0] - 0.5 * 9.81 * 2 / 3 * 0.25 * slider.axis).norm(), 0, 1e-12);
  const State<3> there = stepped(world, 1200);
  EXPECT_NEAR((there.x[0] - slider.axis).norm(), 0, 1e-9);
  EXPECT_LT(there.v[0].norm(), 1e-12);
}

TEST(SweptJoints, ThrownDollsHangTogetherLoseEnergyAndLieStill) {
  // three of them above each other; on hinges that rub, for what spins in a joint without friction spins on
  World<3> world = doll();
  world.model.joints[0].kind = JointKind::hinge, world.model.joints[0].axis = {1, 0, 0};
  world.model.joints[0].friction = 0.05;
  const World<3> one = world;
  for (int k = 1; k < 3; ++k) {
    const int first = int(world.model.bodies.size());
    for (std::size_t i = 0; i < one.model.bodies.size(); ++i) {
      world.model.bodies.push_back(one.model.bodies[i]);
      world.model.bodies.back().group = 1 + k;
      world.state.x.push_back(one.state.x[i] + Vec3(0.15 * k, 1.1 * k, 0.05 * k));
      world.state.v.push_back(one.state.v[i]), world.state.turn.push_back(one.state.turn[i]);
      world.state.spin.push_back(one.state.spin[i]);
    }
    for (Joint<3> joint : one.model.joints) {
      joint.a.body += first, joint.b.body += first;
      world.model.joints.push_back(joint);
    }
    world.model.ignore.emplace_back(1 + k, 1 + k);
  }
  EXPECT_EQ(solver(world.model), Solver::iterative) << "nine bodies";
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  const double begun = energy(world, state);
  double least = begun, gained = 0;
  int steps = 0;
  const auto asleep = [&] {
    return std::all_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
  };
  for (; steps < 6000 && !asleep(); ++steps) {
    ASSERT_FALSE(stepper.step(state));
    ASSERT_LE(off(world, state), 1e-10) << steps;
    const double now = energy(world, state);
    gained = std::max(gained, now - least);
    least = std::min(least, now);
  }
  // contact gives none; joints are of second order in w h, up to 0.02, and give and take
  EXPECT_LE(gained, 2e-5 * begun);
  EXPECT_LT(steps, 6000) << "in ten seconds";
  const State<3> before = state;
  for (int i = 0; i < 60; ++i) ASSERT_FALSE(stepper.step(state));
  EXPECT_EQ(state.x, before.x);
}

// velocities that a joint does not let be are struck together, as by Gauss: of equal masses, half each
TEST(SweptJoints, WhatBeginsApartIsStruckTogether) {
  World<3> world = swept(space(Vec3::Zero()));
  world.model.collision = Collision::contact, world.model.rate = {600, 1};
  add_solid(world, brick({0.2, 0.2, 0.2}), 2, {0, 0, 0}, {1, 0, 0});
  add_solid(world, brick({0.2, 0.2, 0.2}), 2, {0.4, 0, 0});
  Joint<3> ball;
  ball.a = {0, {0.2, 0, 0}}, ball.b = {1, {-0.2, 0, 0}};
  world.model.joints = {ball};
  const State<3> now = stepped(world, 1);
  for (const Vec3& v : now.v) EXPECT_NEAR((v - Vec3(0.5, 0, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR(now.x[0].x(), 0.5 / 600, 1e-14);
}

// A light arm with its joints 20 m from its middle: it yields to a push at them a thousand times more than
// its mass alone, and turns their rows far in a step.
TEST(SweptJoints, ALongLeverStaysOnItsJoints) {
  World<3> world = swept(space());
  world.model.collision = Collision::contact, world.model.scale = 4, world.model.rate = {600, 1};
  add_solid(world, brick({0.3, 0.5, 0.3}), 12, {0, 0, 0}, {2.5, 0.5, 0});
  add_solid(world, brick({0.1, 0.1, 0.36}), 2, {0, 0.17, 20});
  add_solid(world, brick({0.1, 0.1, 0.34}), 1.5, {0, 0.17, 0.66});
  add_solid(world, brick({0.1, 0.1, 0.36}), 2, {0, 0.17, -0.36});
  Joint<3> shoulder, elbow, other;
  shoulder.a = {1, {0, 0, -19.8}}, shoulder.b = {0, {0, 0.17, 0.2}};
  elbow.a = {2, {0, 0, -0.15}}, elbow.b = {1, {0, 0, -19.49}};
  other.a = {3, {0, 0, 0.16}}, other.b = {0, {0, 0.17, -0.2}};
  world.model.joints = {shoulder, elbow, other};
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  const double begun = energy(world, state);
  for (int i = 0; i < 600; ++i) {
    ASSERT_FALSE(stepper.step(state));
    ASSERT_LE(off(world, state), 1e-8) << i;
    // of second order in w h, here up to 0.03
    ASSERT_LE(energy(world, state), begun + 1e-3 * 39) << i;
  }
}

// the second hinge says nothing that the first has not said, but for how they share a load; nor does a weld
// say more with a slider beside it
TEST(SweptJoints, WhatIsHeldTwiceMovesAsHeldOnce) {
  const auto moved = [](std::vector<std::pair<JointKind, double>> kinds) {
    World<3> world = swept(space());
    world.model.collision = Collision::contact, world.model.rate = {600, 1};
    add_solid(world, brick({0.2, 0.2, 0.2}), 5, {0, 0, 0}, {1, 0, 0.3}, no_rotation<3>(), {1.7, 3.5, 0.9});
    add_solid(world, brick({0.2, 0.15, 0.1}), 0.5, {0.5, 0.2, 0.1});
    for (const auto& [kind, height] : kinds) {
      Joint<3> joint;
      joint.kind = kind, joint.axis = {0, 1, 0};
      joint.a = {0, {0.25, 0.1 + height, 0.05}}, joint.b = {1, {-0.25, -0.1 + height, -0.05}};
      world.model.joints.push_back(joint);
    }
    const State<3> now = stepped(world, 600);
    EXPECT_LE(off(world, now), 1e-9);
    return now;
  };
  using enum JointKind;
  for (const auto& [once, twice] : {std::pair{moved({{hinge, 0}}), moved({{hinge, -0.2}, {hinge, 0.2}})},
                                    {moved({{weld, 0}}), moved({{weld, 0}, {slider, 0}})}}) {
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR((once.x[i] - twice.x[i]).norm(), 0, 1e-6) << i;  // the scheme's order, along other rows
      EXPECT_NEAR((once.v[i] - twice.v[i]).norm(), 0, 1e-5) << i;
    }
  }
}

// a rope beside a weld, a millimetre too short: nothing gives, and so it pulls at nothing
TEST(SweptJoints, ARopeThatJointsDoNotLetGiveIsLeft) {
  World<3> world = swept(space());
  world.model.collision = Collision::contact, world.model.scale = 4, world.model.rate = {600, 1};
  add_solid(world, brick({0.2, 0.2, 0.2}), 2, {0, 0, 0});
  Joint<3> weld, rope;
  weld.kind = JointKind::weld, weld.a = {0, {0.1, 0.1, 0}}, weld.b = {-1, {0.1, 0.1, 0}};
  rope.kind = JointKind::rope, rope.a = {0, {-0.1, 0.1, 0}}, rope.b = {-1, {-0.7, 0.5, 0.3}};
  rope.length = std::sqrt(0.36 + 0.16 + 0.09) - 1e-3;
  world.model.joints = {weld, rope};
  const State<3> now = stepped(world, 60);
  EXPECT_NEAR(now.x[0].norm(), 0, 1e-12);
  EXPECT_EQ(now.joint_forces[1], Vec3::Zero());
  EXPECT_NEAR((now.joint_forces[0] - Vec3(0, 2 * 9.81, 0)).norm(), 0, 1e-9);
}

TEST(SweptJoints, AJointBreaksByItsLoad) {
  World<3> world = swept(space());
  world.model.collision = Collision::contact, world.model.scale = 4, world.model.rate = {600, 1};
  add_solid(world, brick({0.2, 0.2, 0.2}), 2, {0, 0, 0});
  Joint<3> ball;
  ball.a = {0, {0, 0.1, 0}}, ball.b = {-1, {0, 0.1, 0}};
  ball.breaks = 2.01 * 9.81;
  world.model.joints = {ball};
  State<3> now = stepped(world, 60);
  EXPECT_FALSE(now.broken[0]);
  EXPECT_NEAR((now.joint_forces[0] - Vec3(0, 2 * 9.81, 0)).norm(), 0, 1e-9);
  world.model.joints[0].breaks = 1.99 * 9.81;
  now = stepped(world, 60);
  EXPECT_TRUE(now.broken[0]);
  EXPECT_LT(now.x[0].y(), -0.04);
}

}  // namespace
}  // namespace obscura::sim
