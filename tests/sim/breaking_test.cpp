// Joints that are loaded beyond what they bear, and what joints report.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/jointed.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

// m = 2 kg on a rod of 1 m about the origin, let go level
World<2> cross_velocity() {
  World<2> world = touching_room();
  add_particle(world, {1, 0}, {0, 0}, 2);
  world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
  return world;
}

TEST(Breaking, ARodReportsTheTensionOfASwing) {
  // T = 3 m g cos of the angle from straight down, here as the place says it. 1e-8: the speed is
  // Runge-Kutta's
  State<2> state = cross_velocity().state;
  const World<2> world = cross_velocity();
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 300; ++i) {
    ASSERT_FALSE(stepper.step(state));
    const double tension = -3 * 2 * 9.81 * state.x[0].y();
    EXPECT_NEAR((state.joint_forces[0] + tension * state.x[0]).norm(), 0, 1e-8 * 60) << i;
  }
}

TEST(Breaking, ASwingBreaksItsRodWhereTheTensionSays) {
  // at 1.5 m g the cosine is 1/2: y = -1/2. Broken at the end of the first step beyond it, then a parabola
  World<2> world = cross_velocity();
  world.model.joints[0].breaks = 1.5 * 2 * 9.81;
  State<2> state = world.state, before = state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 600 && !state.broken[0]; ++i) {
    before = state;
    ASSERT_FALSE(stepper.step(state));
  }
  ASSERT_TRUE(state.broken[0]);
  EXPECT_GE(before.x[0].y(), -0.5 - 1e-9);
  EXPECT_LT(state.x[0].y(), -0.5);

  const State<2> loose = state;
  EXPECT_NEAR(loose.v[0].squaredNorm(), -2 * 9.81 * loose.x[0].y(), 1e-8);
  for (int i = 0; i < 120; ++i) ASSERT_FALSE(stepper.step(state));
  const double t = 120.0 / 600;
  EXPECT_NEAR((state.x[0] - loose.x[0] - t * loose.v[0] - 0.5 * t * t * Vec2(0, -9.81)).norm(), 0, 1e-12);
  EXPECT_EQ(state.joint_forces[0], Vec2(0, 0));
}

// Two boxes of 1 kg bonded side by side, one of them held by what transmits a torque. The other weighs on its
// bond with m g, and with the moment m g l about the bond's point: sqrt(2) m g.
TEST(Breaking, ABondBearsTheTorqueThatAJointTransmits) {
  const double load = std::sqrt(2) * 9.81;
  for (int held = 0; held < 4; ++held) {
    for (const double over : {0.99, 1.01}) {
      World<2> world = room({0, -9.81});
      world.model.scale = 8, world.model.collision = Collision::contact;
      add_box(world, {0.2, 0.2}, 1, {4, 4}), add_box(world, {0.2, 0.2}, 1, {4.2, 4});
      Joint<2> joint;
      joint.a = {0, {0, 0}}, joint.b = {-1, {4, 4}};
      joint.kind = held == 0 ? JointKind::weld : held == 1 ? JointKind::slider : JointKind::pin;
      if (held == 2) joint.lower = joint.upper = 0;
      if (held == 3) joint.motor = Joint<2>::Motor{0, 100};
      world.model.joints.push_back(joint);
      world.model.bonds.push_back({0, 1, load / over});
      const State<2> now = stepped(world, held == 1 ? 1 : 300);
      EXPECT_EQ(int(now.intact[0]), over < 1 ? 1 : 0) << held << " " << over;
    }
  }
}

TEST(Breaking, AChainBreaksWhereItCarriesMost) {
  // two weights under each other: the upper rod carries both, to rounding; it breaks at once, the lower holds
  World<2> world = touching_room();
  add_particle(world, {0, -1}, {0, 0}, 1), add_particle(world, {0, -2}, {0, 0}, 3);
  world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
  world.model.joints.push_back(rod({1, {0, 0}}, {0, {0, 0}}, 1));
  const State<2> hanging = stepped(world, 600);
  EXPECT_NEAR(hanging.joint_forces[0].y(), 4 * 9.81, 1e-11);
  EXPECT_NEAR(hanging.joint_forces[1].y(), 3 * 9.81, 1e-11);
  EXPECT_EQ(hanging.frozen[0] + hanging.frozen[1], 2) << "what hangs still is at rest, and keeps its forces";

  for (Joint<2>& joint : world.model.joints) joint.breaks = 3.5 * 9.81;
  const State<2> now = stepped(world, 1);
  EXPECT_TRUE(now.broken[0]);
  EXPECT_FALSE(now.broken[1]);
  const State<2> later = stepped(world, 61);
  EXPECT_NEAR(later.x[1].y(), -2 - 0.5 * 9.81 * 0.01, 1e-12);
  EXPECT_NEAR((later.x[0] - later.x[1]).norm(), 1, 1e-14);
}

TEST(Breaking, AHandPullsARodApart) {
  // a box at rest on a rod; the hand's spring draws it down by k l, until the rod has all it bears
  World<2> world = touching_room();
  add_box(world, {0.2, 0.2}, 1, {0, -1});
  world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
  world.model.joints[0].breaks = 9.81 + 20;
  Mouse<2> hand;
  hand.path = {{{1, 1}, {0.1, -1.1}}, {{6, 1}, {0.1, -2.1}}};
  hand.stiffness = 100;
  world.model.mice.push_back(hand);
  const State<2> still = stepped(world, 590);
  EXPECT_TRUE(still.frozen[0]);
  EXPECT_FALSE(still.broken[0]);
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  while (!state.broken[0] && state.step < 3600) ASSERT_FALSE(stepper.step(state));
  ASSERT_TRUE(state.broken[0]);
  EXPECT_GT(state.joint_forces[0].norm(), 29.81);
  ASSERT_FALSE(stepper.step(state));
  EXPECT_FALSE(state.frozen[0]);
  EXPECT_EQ(state.joint_forces[0], Vec2(0, 0));
}

}  // namespace
}  // namespace obscura::sim
