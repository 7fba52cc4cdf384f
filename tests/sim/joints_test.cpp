// What a joint does, whichever solver holds it.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/jointed.h"

namespace obscura::sim {
namespace {

class Joints : public testing::TestWithParam<Solver> {
 protected:
  static World<2> jointed_room(Vec2 gravity = {0, -9.81}) {
    World<2> world = touching_room(Collision::contact, gravity);
    world.model.solver = GetParam();
    return world;
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, Joints, testing::Values(Solver::direct, Solver::iterative),
                         [](const auto& it) { return it.param == Solver::direct ? "Direct" : "Iterative"; });

TEST_P(Joints, ASliderFallsAlongItsWayAndStopsAtItsLimit) {
  World<2> world = jointed_room();
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

TEST_P(Joints, AMotorReachesItsSpeedAtItsTorque) {
  World<2> world = jointed_room({0, 0});
  add_box(world, {1, 0.5}, 2, {0, 0});
  Joint<2> hinge = pin({0, {0, 0}}, {-1, {0, 0}});
  hinge.motor = Joint<2>::Motor{3, 0.5};
  world.model.joints.push_back(hinge);
  const double rate = 0.5 / world.model.bodies[0].inertia[0];
  EXPECT_NEAR(stepped(world, 300).spin[0][0], 0.5 * rate, 1e-12);
  EXPECT_NEAR(stepped(world, 3000).spin[0][0], 3, 1e-12);
}

TEST_P(Joints, ARopeIsSlackUntilItIsTight) {
  World<2> world = jointed_room();
  add_particle(world, {0.3, 0}, {0, 0}, 1, 0);
  Joint<2> rope = rod({0, {0, 0}}, {-1, {0, 0}}, 1);
  rope.kind = JointKind::rope;
  world.model.joints.push_back(rope);
  const double fall = std::sqrt(1 - 0.09), t = std::sqrt(2 * fall / 9.81);
  EXPECT_NEAR(stepped(world, int(600 * t) - 1).x[0].x(), 0.3, 1e-15);
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
