// Momentum, angular momentum and energy where they must hold.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/rooms.h"

namespace obscura::sim {
namespace {

// a box and two particles on springs with dashpots, far from everything
World<2> adrift() {
  World<2> world = room({0, 0});
  add_particle(world, {0, 0}, {1, 0.5}, 0.7);
  add_particle(world, {1, 0.3}, {-1, 0.2}, 1.3);
  add_box(world, {0.6, 0.4}, 2, {0.4, 1.2}, {0, -1}, 0.3, 4);
  add_spring(world, {0, {0, 0}}, {1, {0, 0}}, 30, 0.5, 0.3);
  add_spring(world, {1, {0, 0}}, {2, {0.3, 0.2}}, 20, 0.4, 0.2);
  add_spring(world, {0, {0, 0}}, {2, {-0.3, -0.2}}, 25, 0.6, 0);
  return world;
}

TEST(Conservation, OfMomentumUnderInnerSprings) {
  for (const auto integrator :
       {Integrator::rk4, Integrator::midpoint, Integrator::euler, Integrator::semi_implicit}) {
    World<2> world = adrift();
    world.model.integrator = integrator;
    const auto all = run(world);
    const Vec3 start = shown(*all, {0, 1}).momentum;
    // f and -f are the same bits; sums round
    EXPECT_LT((shown(*all, {10, 1}).momentum - start).norm(), 1e-12) << int(integrator);
  }
}

TEST(Conservation, OfAngularMomentumUnderInnerSprings) {
  const auto all = run(adrift());
  const double start = shown(*all, {0, 1}).angular_momentum.z();
  // RK4 keeps it to its order: 1e-12 (w h)^4-ish a second at 1/1000
  EXPECT_NEAR(shown(*all, {10, 1}).angular_momentum.z(), start, 1e-8);
}

TEST(Conservation, OfAngularMomentumIsOfTheOrderOfTheScheme) {
  const auto error = [](int rate) {
    World<2> world = adrift();
    world.model.rate = {rate, 1};
    const auto all = run(world);
    const double start = shown(*all, {0, 1}).angular_momentum.z();
    double most = 0;
    for (int i = 1; i <= 30; ++i) {
      most = std::max(most, std::fabs(shown(*all, rational(i, 10)).angular_momentum.z() - start));
    }
    return most;
  };
  EXPECT_GT(std::log2(error(200) / error(400)), 3.7);
}

TEST(Conservation, OfEnergyUnderSpringsWithoutDashpots) {
  World<2> world = adrift();
  for (auto& spring : world.model.springs) spring.damping = 0;
  world.model.gravity = {0, -9.81};
  const auto all = run(world);
  const double start = shown(*all, {0, 1}).energies.total();
  EXPECT_NEAR(shown(*all, {5, 1}).energies.total(), start, 1e-7 * start);
}

TEST(Dashpots, OnlyTakeEnergy) {
  const auto all = run(adrift());
  double before = shown(*all, {0, 1}).energies.total();
  for (int i = 1; i <= 100; ++i) {
    const double now = shown(*all, rational(i, 10)).energies.total();
    EXPECT_LT(now, before + 1e-10);
    before = now;
  }
}

TEST(Symmetry, UnderATurnOfTheWholeRoom) {
  // the same room turned by 0.7 rad, gravity and all
  const auto make = [](double angle) {
    const Rotation<2> R = rotation<2>(Orientation<2>(angle));
    World<2> world = room(R * Vec2(0, -9.81));
    add_wall(world, R * Vec2(0, 0), R * Vec2(0.1, 1));
    add_wall(world, R * Vec2(3, 0), R * Vec2(-1, 0));
    add_particle(world, R * Vec2(1, 1), R * Vec2(2, 0), 1, 0.8);
    add_box(world, {0.4, 0.3}, 2, R * Vec2(0.5, 1.5), R * Vec2(3, 1), angle + 0.3, 2, 0.8);
    add_spring(world, {0, {0, 0}}, {1, {0.2, 0.15}}, 30, 0.3, 0.1);
    return world;
  };
  const auto a = stepped(make(0), 1500), b = stepped(make(0.7), 1500);
  const Rotation<2> R = rotation<2>(Orientation<2>(0.7));
  // rounding, grown by a dozen impacts
  EXPECT_LT((R * a.x[0] - b.x[0]).norm(), 1e-10);
  EXPECT_LT((R * a.x[1] - b.x[1]).norm(), 1e-10);
  EXPECT_NEAR(a.turn[0][0] + 0.7, b.turn[0][0], 1e-10);
}

TEST(Symmetry, UnderTimeReversal) {
  // RK4 forward and back: the scheme's error only
  World<2> world = adrift();
  for (auto& spring : world.model.springs) spring.damping = 0;
  World<2> back = world;
  back.state = stepped(world, 1000);
  back.state.step = 0;
  for (auto& v : back.state.v) v = -v;
  for (auto& w : back.state.spin) w = -w;
  const auto there_and_back = stepped(back, 1000);
  for (int i = 0; i < 3; ++i) EXPECT_LT((there_and_back.x[i] - world.state.x[i]).norm(), 1e-7);
}

}  // namespace
}  // namespace obscura::sim
