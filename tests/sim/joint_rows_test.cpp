// Joints as rows inside the stages.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/jointed.h"
#include "sim/reference.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

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
    const auto want = row_at(name, 5);
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
  const auto want = row_at("double_pendulum_rods.csv", 5);
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

}  // namespace
}  // namespace obscura::sim
