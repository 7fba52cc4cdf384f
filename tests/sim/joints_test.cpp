// What a joint does, whichever solver holds it.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

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

// x = r cos a + sqrt(l^2 - r^2 sin^2 a), and the motor is strong enough to be at its speed after a step: to
// what is rounded where joints are put back
TEST_P(Joints, ACrankDrivesItsPistonAsTheClosedFormSays) {
  World<2> world = jointed_room();
  const double r = 0.3, l = 1, speed = 6;
  add_bar(world, {0, 0}, {r, 0}), add_bar(world, {r, 0}, {r + l, 0});
  add_box(world, {0.2, 0.2}, 1, {r + l, 0});
  Joint<2> drive = pin({0, {-r / 2, 0}}, {-1, {0, 0}});
  drive.motor = Joint<2>::Motor{speed, 1e5};
  Joint<2> slider = pin({2, {0, 0}}, {-1, {r + l, 0}});
  slider.kind = JointKind::slider, slider.axis = {1, 0};
  world.model.joints = {drive, pin({0, {r / 2, 0}}, {1, {-l / 2, 0}}), pin({1, {l / 2, 0}}, {2, {0, 0}}),
                        slider};
  for (const int steps : {1, 300, 1433}) {
    const State<2> now = stepped(world, steps);
    const double a = now.turn[0][0];
    EXPECT_NEAR(now.spin[0][0], speed, 1e-13) << steps;
    EXPECT_NEAR(now.x[2].x(), r * std::cos(a) + std::sqrt(l * l - std::pow(r * std::sin(a), 2)), 1e-12);
    EXPECT_NEAR(now.x[2].y(), 0, 1e-13);
  }
}

// Peaucellier's linkage turns a circle through its pivot into a straight line: arms a, rhombus b, and for the
// pole P beyond the corner C that the crank moves |OC| |OP| = a^2 - b^2
TEST_P(Joints, APeaucellierLinkageDrawsAStraightLine) {
  World<2> world = jointed_room({0, 0});
  const double a = 1, b = 0.6, crank = 0.45, begun = 1.4;
  const Vec2 o(0, 0), middle(crank, 0), c = middle + crank * Vec2(std::cos(begun), std::sin(begun));
  const Vec2 pole = c / c.squaredNorm() * (a * a - b * b);
  const Vec2 across = Vec2(-c.y(), c.x()).normalized() * std::sqrt(b * b - (pole - c).squaredNorm() / 4);
  const Vec2 up = (c + pole) / 2 + across, down = (c + pole) / 2 - across;
  const std::pair<Vec2, Vec2> bars[] = {{o, up},    {o, down},    {c, up},    {c, down},
                                        {pole, up}, {pole, down}, {middle, c}};
  for (const auto& [from, to] : bars) add_bar(world, from, to);
  const auto join = [&](int p, bool first_p, int q, bool first_q, Vec2 at) {
    const auto end = [&](int i, bool first) {
      const double half = (bars[i].second - bars[i].first).norm() / 2;
      return End<2>{i, {first ? -half : half, 0}};
    };
    world.model.joints.push_back(pin(end(p, first_p), q < 0 ? End<2>{-1, at} : end(q, first_q)));
  };
  join(0, true, -1, false, o), join(1, true, -1, false, o), join(6, true, -1, false, middle);
  join(0, false, 2, false, up), join(0, false, 4, false, up);
  join(1, false, 3, false, down), join(1, false, 5, false, down);
  join(2, true, 3, true, c), join(2, true, 6, false, c), join(4, true, 5, true, pole);
  world.model.joints[2].motor = Joint<2>::Motor{-0.4, 100};
  world.model.ignore.emplace_back(0, 0);
  for (const int steps : {300, 1500}) {
    const State<2> now = stepped(world, steps);
    const Vec2 at = now.x[4] - b / 2 * Vec2(std::cos(now.turn[4][0]), std::sin(now.turn[4][0]));
    EXPECT_NEAR(at.x(), pole.x(), 1e-12);
    EXPECT_LT(at.y(), pole.y() - 1e-4 * steps);
  }
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
