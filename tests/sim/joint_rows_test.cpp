// Joints as rows inside the stages.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reference.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

Vec2 hanging(double angle) { return {std::sin(angle), -std::cos(angle)}; }

Joint<2> rod(End<2> a, End<2> b, double length) {
  Joint<2> joint;
  joint.kind = JointKind::rod, joint.a = a, joint.b = b, joint.length = length;
  return joint;
}

Joint<2> pin(End<2> a, End<2> b) {
  Joint<2> joint;
  joint.a = a, joint.b = b;
  return joint;
}

// A table's row at t = 5 s.
std::vector<double> at_five(const char* name) {
  for (const auto& row : table(name)) {
    if (std::abs(row[0] - 5) < 1e-9) return row;
  }
  return {};
}

TEST(JointRows, ADoublePendulumOfRodsAndParticlesFollowsTheTable) {
  // plain Runge-Kutta in angles errs by 1.3e-9 here; the bar for rows is 1e-8
  for (const auto& [name, first, second] : {std::tuple{"double_pendulum_point_large.csv", 90.0, 90.0},
                                            std::tuple{"double_pendulum_point_regular.csv", 30.0, 45.0}}) {
    const double degree = std::acos(-1) / 180;
    World<2> world = touching_room();
    const Vec2 p = hanging(first * degree), q = p + hanging(second * degree);
    add_particle(world, p), add_particle(world, q);
    world.model.joints.push_back(rod({0, {0, 0}}, {-1, {0, 0}}, 1));
    world.model.joints.push_back(rod({1, {0, 0}}, {0, {0, 0}}, 1));
    const State<2> now = stepped(world, 3000);
    const auto want = at_five(name);
    EXPECT_NEAR((now.x[0] - hanging(want[1])).norm(), 0, 1e-8) << name;
    EXPECT_NEAR((now.x[1] - now.x[0] - hanging(want[2])).norm(), 0, 1e-8) << name;
    EXPECT_NEAR(now.x[0].norm(), 1, 1e-13);
    EXPECT_NEAR((now.x[1] - now.x[0]).norm(), 1, 1e-13);
  }
}

TEST(JointRows, ADoublePendulumOfPinnedRodsFollowsTheTable) {
  World<2> world = touching_room();
  const double right = std::acos(-1) / 2;
  add_box(world, {0.02, 1}, 1, 0.5 * hanging(right), {0, 0}, right);
  add_box(world, {0.02, 1}, 1, 1.5 * hanging(right), {0, 0}, right);
  for (auto& body : world.model.bodies) body.inertia[0] = 1.0 / 12;
  world.model.joints.push_back(pin({0, {0, 0.5}}, {-1, {0, 0}}));
  world.model.joints.push_back(pin({1, {0, 0.5}}, {0, {0, -0.5}}));
  const State<2> now = stepped(world, 3000);
  const auto want = at_five("double_pendulum_rods.csv");
  EXPECT_NEAR(now.turn[0][0], want[1], 1e-8);
  EXPECT_NEAR(now.turn[1][0], want[2], 1e-8);
  EXPECT_NEAR(now.spin[0][0], want[3], 1e-7);
  EXPECT_NEAR((now.x[0] - 0.5 * hanging(now.turn[0][0])).norm(), 0, 1e-13) << "joints do not drift";
}

TEST(JointRows, AWeldMakesOneBodyOfTwo) {
  World<2> world = touching_room(Collision::contact, {0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0}, {1, 0}, 0, 0);
  add_box(world, {1, 0.5}, 2, {1, 0}, {1, 0.6}, 0, 0);
  Joint<2> weld = pin({0, {0.5, 0}}, {1, {-0.5, 0}});
  weld.kind = JointKind::weld;
  world.model.joints.push_back(weld);
  // the impulse that makes their velocities agree keeps momentum and angular momentum: L = 2 0.6 0.5 about
  // the middle
  const State<2> now = stepped(world, 600);
  const double inertia = 2 * (2 * 1.25 / 12 + 2 * 0.25), w = 2 * 0.6 * 0.5 / inertia;
  EXPECT_NEAR(now.spin[0][0], w, 1e-12);
  EXPECT_NEAR(now.spin[1][0], w, 1e-12);
  EXPECT_NEAR((0.5 * (now.x[0] + now.x[1]) - Vec2(1.5, 0.3)).norm(), 0, 1e-11);
  EXPECT_NEAR(now.turn[0][0], now.turn[1][0], 1e-13);
}

TEST(JointRows, ASliderFallsAlongItsWayAndStopsAtItsLimit) {
  World<2> world = touching_room();
  const Vec2 axis = Vec2(3, -4) / 5;
  add_box(world, {0.2, 0.2}, 1, {0, 0});
  Joint<2> slider = pin({0, {0, 0}}, {-1, {0, 0}});
  slider.kind = JointKind::slider, slider.axis = axis, slider.upper = 1;
  world.model.joints.push_back(slider);
  const State<2> half = stepped(world, 300);
  EXPECT_NEAR((half.x[0] - 0.5 * 9.81 * 0.8 * 0.25 * axis).norm(), 0, 1e-12);
  const State<2> now = stepped(world, 1200);
  EXPECT_NEAR((now.x[0] - axis).norm(), 0, 1e-9);
  EXPECT_LT(now.v[0].norm(), 1e-12);
  EXPECT_NEAR(now.turn[0][0], 0, 1e-14);
}

TEST(JointRows, AMotorReachesItsSpeedAtItsTorque) {
  World<2> world = touching_room(Collision::contact, {0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0});
  Joint<2> hinge = pin({0, {0, 0}}, {-1, {0, 0}});
  hinge.motor = Joint<2>::Motor{3, 0.5};
  world.model.joints.push_back(hinge);
  const double rate = 0.5 / world.model.bodies[0].inertia[0];
  const State<2> early = stepped(world, 300);
  EXPECT_NEAR(early.spin[0][0], 0.5 * rate, 1e-12);
  const State<2> late = stepped(world, 3000);
  EXPECT_NEAR(late.spin[0][0], 3, 1e-12);
}

TEST(JointRows, ARopeIsSlackUntilItIsTight) {
  World<2> world = touching_room();
  add_particle(world, {0.3, 0}, {0, 0}, 1, 0);
  Joint<2> rope = rod({0, {0, 0}}, {-1, {0, 0}}, 1);
  rope.kind = JointKind::rope;
  world.model.joints.push_back(rope);
  const double fall = std::sqrt(1 - 0.09), t = std::sqrt(2 * fall / 9.81);
  const State<2> before = stepped(world, int(600 * t) - 1);
  EXPECT_NEAR(before.x[0].x(), 0.3, 1e-15);
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  for (int i = 0; i < 6000; ++i) {
    ASSERT_FALSE(stepper.step(state));
    ASSERT_LE(state.x[0].norm(), 1 + 1e-8);
  }
}

}  // namespace
}  // namespace obscura::sim
