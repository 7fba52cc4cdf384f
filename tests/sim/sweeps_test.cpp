// Many bodies of space by sweeps, against closed forms and sums.

#include "sim/sweeps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/energy.h"
#include "sim/solids.h"
#include "sim/space_rooms.h"

namespace obscura::sim {
namespace {

constexpr double kG = 9.81;

World<3> swept_room(double mu, Vec3 gravity = {0, -kG, 0}) {
  World<3> world = space(gravity);
  world.model.rate = {600, 1};
  world.model.collision = Collision::contact, world.model.solver = Solver::iterative;
  world.model.scale = 4;
  add_wall(world, {0, 0, 0}, {0, 1, 0});
  world.model.walls[0].friction = mu;
  return world;
}

int add_box(World<3>& world, Vec3 size, Vec3 x, Vec3 v = Vec3::Zero(), Vec3 turn = Vec3::Zero(),
            double mu = 0.5) {
  const int i = add_solid(world, brick(size), size.prod() * 1000, x, v, exponential(turn), Vec3::Zero(), 0);
  world.model.bodies[i].friction = mu;
  return i;
}

double deepest(const World<3>& world, const State<3>& state) {
  double depth = 0;
  for (std::size_t a = 0; a < state.x.size(); ++a) {
    for (std::size_t b = a + 1; b < state.x.size(); ++b) {
      depth = std::max(depth, -separation(world.model.bodies[a].shape, stance(state, int(a)),
                                          world.model.bodies[b].shape, stance(state, int(b))));
    }
  }
  return depth;
}

World<3> heap(int n, int side, double mu) {
  World<3> world = swept_room(mu);
  SpaceDice dice(7);
  for (int i = 0; i < n; ++i) {
    const Vec3 place(0.45 * (i % side) - 0.2 * side, 0.3 + 0.45 * (i / (side * side)),
                     0.45 * (i / side % side) - 0.2 * side);
    add_box(world, {dice.between(0.2, 0.3), dice.between(0.2, 0.3), dice.between(0.2, 0.3)}, place,
            Vec3::Zero(), dice.vec(1), mu);
  }
  return world;
}

TEST(Sweeps, ABoxStopsAfterVSquaredOverTwoMuGInEveryDirection) {
  const double mu = 0.3, v = 1;
  for (int i = 0; i < 12; ++i) {
    const double angle = (30 * i + 7) * std::numbers::pi / 180;
    const Vec3 way(std::cos(angle), 0, std::sin(angle));
    World<3> world = swept_room(mu);
    add_box(world, {0.4, 0.1, 0.4}, {0, 0.05, 0}, v * way, Vec3::Zero(), mu);
    const State<3> now = stepped(world, 400);
    // the step in which it stops: (mu g h)^2 / (8 mu g), and what sweeps leave
    EXPECT_NEAR((now.x[0] - Vec3(0, 0.05, 0) - v * v / (2 * mu * kG) * way).norm(), 0, 1e-5) << i;
  }
}

TEST(Sweeps, AHeapComesToRestAndCarriesItsWeight) {
  const World<3> world = heap(30, 3, 0.6);
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  int steps = 0;
  const auto asleep = [&] {
    return std::all_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
  };
  while (steps < 6000 && !(steps > 0 && asleep())) {
    ASSERT_FALSE(stepper.step(state));
    ++steps;
  }
  EXPECT_LT(steps, 6000);
  EXPECT_LT(deepest(world, state), 1e-3);
  double carried = 0, weight = 0;
  for (const Contact<3>& contact : state.contacts) {
    if (contact.key.b < 0) carried += contact.force[1];
  }
  for (const Body<3>& body : world.model.bodies) weight += body.mass * kG;
  EXPECT_NEAR(carried, weight, 1e-4 * weight);
  const State<3> before = state;
  for (int i = 0; i < 60; ++i) stepper.step(state);
  EXPECT_EQ(state.x, before.x);
}

TEST(Sweeps, ARunCutInTwoIsTheRunInOne) {
  const World<3> world = heap(12, 2, 0.5);
  const State<3> whole = stepped(world, 300);
  World<3> half = world;
  half.state = stepped(world, 137);
  EXPECT_EQ(words(stepped(half, 163)), words(whole));
}

TEST(Sweeps, EnergyOfAHeapOnlyFalls) {
  const World<3> world = heap(20, 2, 0.4);
  const auto energy = [&](const State<3>& state) {
    double sum = 0;
    for (int i = 0; i < int(state.x.size()); ++i) {
      sum += kinetic(world.model, state, i) + lifted(world.model, state, i);
    }
    return sum;
  };
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  double before = energy(state);
  const double whole = before;
  for (int i = 0; i < 900; ++i) {
    ASSERT_FALSE(stepper.step(state));
    const double now = energy(state);
    // putting what is too deep back lifts it a little
    EXPECT_LT(now, before + 1e-4 * whole) << i;
    before = now;
  }
  EXPECT_LT(before, 0.6 * whole);
}

}  // namespace
}  // namespace obscura::sim
