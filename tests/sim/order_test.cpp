// The order of each integrator, measured: errors at steps h and h/2.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/rooms.h"

namespace obscura::sim {
namespace {

// a swinging box on a spring, to a place or to a moving hand, and a particle on the same spring's other end
World<2> swinging(bool hand) {
  World<2> world = room();
  add_particle(world, {1.1, -0.3}, {0.2, 0}, 0.7);
  add_box(world, {1, 0.5}, 2, {0.2, -1}, {0, 0.5}, 0.4, -1);
  add_spring(world, {0, {0, 0}}, {1, {0.5, 0.25}}, 20, 0.3, 0.1);
  if (hand) {
    // the knots lie between steps: those steps are cut
    world.model.mice.push_back({{{{0, 1}, {1.1, 0.4}},
                                 {{311, 1000}, {1.3, 0.9}},
                                 {{777, 1000}, {0.3, 1.1}},
                                 {{1234, 1000}, {0.9, 0.2}}},
                                0.2,
                                30,
                                0.3});
  } else {
    add_spring(world, {0, {0, 0}}, {-1, {0.8, 1.5}}, 30, 0.2);
  }
  return world;
}

std::vector<double> end(World<2> world, Integrator integrator, int rate) {
  world.model.integrator = integrator;
  world.model.rate = {rate, 1};
  const auto now = shown(*run(world), {1, 1});
  const auto &a = now.bodies[0], &b = now.bodies[1];
  return {a.position.x(), a.position.y(), a.velocity.x(), a.velocity.y(),
          b.position.x(), b.position.y(), b.angle,        b.spin.z()};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

double order(const World<2>& world, Integrator integrator, int rate) {
  const auto exact = end(world, Integrator::rk4, 20000);  // its own error is below 1e-12
  return std::log2(distance(end(world, integrator, rate), exact) /
                   distance(end(world, integrator, 2 * rate), exact));
}

TEST(Order, IsFourTwoOneOneOnAFixedAnchor) {
  const auto world = swinging(false);
  EXPECT_NEAR(order(world, Integrator::rk4, 400), 4, 0.1);
  EXPECT_NEAR(order(world, Integrator::midpoint, 1000), 2, 0.1);
  EXPECT_NEAR(order(world, Integrator::euler, 8000), 1, 0.1);
  EXPECT_NEAR(order(world, Integrator::semi_implicit, 8000), 1, 0.1);
}

// a hand sampled once a step would leave RK4 an order of one
TEST(Order, IsFourTwoOneOneUnderAMovingHand) {
  const auto world = swinging(true);
  EXPECT_NEAR(order(world, Integrator::rk4, 400), 4, 0.1);
  EXPECT_NEAR(order(world, Integrator::midpoint, 1000), 2, 0.1);
  EXPECT_NEAR(order(world, Integrator::euler, 8000), 1, 0.1);
  EXPECT_NEAR(order(world, Integrator::semi_implicit, 8000), 1, 0.1);
}

TEST(SemiImplicit, HoldsTheEnergyOfAnOscillator) {
  World<2> world = room({0, 0});
  add_particle(world, {1, 0});
  add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 100, 0);
  world.model.integrator = Integrator::semi_implicit;
  const auto swing = run(world);
  for (int t = 1; t <= 100; ++t) {
    // it conserves (v^2 + w^2 x^2 - h w^2 x v)/2: off by at most h w / 2 of itself
    EXPECT_NEAR(shown(*swing, {t, 1}).energies.total(), 50, 50 * 0.006);
  }
}

TEST(Euler, FeedsAnOscillator) {
  World<2> world = room({0, 0});
  add_particle(world, {1, 0});
  add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 100, 0);
  world.model.integrator = Integrator::euler;
  // E grows by 1 + h^2 w^2 a step
  EXPECT_NEAR(shown(*run(world), {1, 1}).energies.total(), 50 * std::pow(1 + 1e-4, 1000), 1e-10);
}

}  // namespace
}  // namespace obscura::sim
