// What nothing ties: projectiles, drag, free turning, blocks.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reference.h"
#include "sim/rooms.h"

namespace obscura::sim {
namespace {

World<2> projectile(double g, Rational rate) {
  World<2> world = room({0, -g});
  add_particle(world, {0, 1}, {3, 4});
  world.model.rate = rate;
  return world;
}

TEST(Projectile, IsExactWhereItsNumbersAreDyadic) {
  const auto world = projectile(157.0 / 16, {64, 1});
  const auto flight = run(world);
  for (const auto& [t, key] :
       {std::pair{Rational{1, 2}, "at t=0.5"}, {Rational{1, 1}, "at t=1 "}, {Rational{2, 1}, "at t=2"}}) {
    const auto want = closed_form({"projectile_dyadic", key});
    const auto body = shown(*flight, t).bodies[0];
    EXPECT_EQ(body.position, Vec3(want[0], want[1], 0));
    EXPECT_EQ(body.velocity, Vec3(want[2], want[3], 0));
  }
}

TEST(Projectile, IsAParabola) {
  const auto flight = run(projectile(9.81, {600, 1}));
  for (const auto& [t, key] : {std::pair{Rational{1, 2}, "at t=0.5\""},
                               {Rational{1, 1}, "at t=1\""},
                               {Rational{2, 1}, "at t=2\""}}) {
    const auto want = closed_form({"projectile,", key});
    const auto body = shown(*flight, t).bodies[0];
    // 1200 steps, each rounding a number below 16 by at most 9e-16
    EXPECT_LT((body.position - Vec3(want[0], want[1], 0)).norm(), 1.1e-12);
    EXPECT_LT((body.velocity - Vec3(want[2], want[3], 0)).norm(), 1.1e-12);
  }
}

TEST(Projectile, RisesToItsApex) {
  // the exact apex lies between two steps: v = 0 at t = 4/g = 400/981
  const auto flight = run(projectile(9.81, {1000, 1}));
  const auto body = shown(*flight, {400, 981}).bodies[0];
  EXPECT_NEAR(body.position.y(), closed_form({"apex height"})[0], 1e-13);
  EXPECT_NEAR(body.velocity.y(), 0, 1e-13);
}

TEST(Drag, SlowsExponentially) {
  // v = v0 exp(-c t / m), x = v0 m/c (1 - exp(-c t / m)); RK4 at 1/1000: (c h / m)^5 / 120 a step
  World<2> world = room({0, 0});
  const int body = add_particle(world, {0, 0}, {2, -1}, 0.5);
  world.model.bodies[body].drag = 0.8;
  const auto at = shown(*run(world), {2, 1}).bodies[0];
  const double left = std::exp(-0.8 * 2 / 0.5);
  EXPECT_LT((at.velocity - left * Vec3(2, -1, 0)).norm(), 1e-13);
  EXPECT_LT((at.position - (1 - left) * 0.5 / 0.8 * Vec3(2, -1, 0)).norm(), 1e-12);
}

TEST(Drag, ReachesTheTerminalVelocity) {
  World<2> world = room({0, -9.81});
  const int body = add_box(world, {1, 1}, 2, {0, 0});
  world.model.bodies[body].drag = 4;
  // v = m g / c (1 - exp(-c t / m))
  EXPECT_NEAR(shown(*run(world), {3, 1}).bodies[0].velocity.y(), -2 * 9.81 / 4 * (1 - std::exp(-6)), 1e-12);
}

TEST(FreeBox, KeepsItsSpin) {
  World<2> world = room();
  add_box(world, {1, 0.5}, 2, {0, 0}, {1, 2}, 0.3, 5);
  const auto at = shown(*run(world), {2, 1}).bodies[0];
  EXPECT_EQ(at.spin.z(), 5);
  EXPECT_NEAR(at.angle, 10.3, 2000 * 1e-15);  // a rounding of a number near 10 a step
  EXPECT_NEAR(at.orientation.w(), std::cos(10.3 / 2), 1e-12);
}

TEST(FixedBody, StaysWhereItStarts) {
  World<2> world = room();
  const int body = add_box(world, {1, 0.5}, 2, {0, 0}, {1, 2}, 0.3, 5);
  world.model.bodies[body].fixed = true;
  const auto at = shown(*run(world), {1, 1});
  EXPECT_EQ(at.bodies[0].position, Vec3::Zero());
  EXPECT_EQ(at.bodies[0].velocity, Vec3::Zero());
  EXPECT_EQ(at.bodies[0].angle, 0.3);
  EXPECT_EQ(at.energies.total(), 0);
}

// a body's motion does not depend on who shares its block
TEST(Blocks, GiveTheBitsOfOneByOne) {
  for (const auto integrator :
       {Integrator::rk4, Integrator::midpoint, Integrator::euler, Integrator::semi_implicit}) {
    World<2> all = room();
    all.model.integrator = integrator;
    add_walls(all, 4, 3);
    const auto some = [](World<2>& world, int i) {
      const double a = 0.37 * i;
      add_particle(world, {2 + 1.9 * std::sin(a), 1.5 + 1.4 * std::cos(1.7 * a)},
                   {3 * std::cos(5 * a), 2 * std::sin(3 * a)}, 1 + 0.01 * i, 0.5 + 0.001 * i,
                   i % 3 ? 0 : 0.02);
      world.model.bodies.back().drag = i % 2 ? 0.1 : 0;
    };
    constexpr int kMany = 300;
    for (int i = 0; i < kMany; ++i) some(all, i);
    const auto together = stepped(all, 1500);
    for (const int i : {0, 1, 127, 128, 129, 255, 256, 299}) {
      World<2> one = room();
      one.model.integrator = integrator;
      add_walls(one, 4, 3);
      some(one, i);
      const auto alone = stepped(one, 1500);
      EXPECT_EQ(alone.x[0], together.x[i]) << i;
      EXPECT_EQ(alone.v[0], together.v[i]) << i;
    }
  }
}

// a spring that pulls nothing changes no bit: tied and free bodies feel the same
TEST(Blocks, GiveTheBitsOfTiedBodies) {
  World<2> free = room();
  add_walls(free, 4, 3);
  add_particle(free, {1, 2}, {3, 1}, 0.7, 0.9);
  free.model.bodies[0].drag = 0.2;
  add_box(free, {0.4, 0.2}, 2, {2, 2}, {1, 0}, 0.4, 3, 0.8);
  World<2> tied = free;
  add_spring(tied, {0, {0, 0}}, {-1, {1, 1}}, 0, 0);
  add_spring(tied, {1, {0.2, 0.1}}, {-1, {1, 1}}, 0, 0);
  const auto a = stepped(free, 2000), b = stepped(tied, 2000);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.v, b.v);
  EXPECT_EQ(a.turn, b.turn);
  EXPECT_EQ(a.spin, b.spin);
}

}  // namespace
}  // namespace obscura::sim
