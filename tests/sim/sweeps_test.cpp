// Many bodies of space by sweeps, against closed forms and sums.

#include "sim/solve/iterate/space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "sim/math/lanes.h"
#include "sim/solids.h"
#include "sim/space_rooms.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

World<3> swept_room(double mu, Vec3 gravity = {0, -kG, 0}) {
  World<3> world = space(gravity);
  world.model.rate = {600, 1};
  world.model.collision = Collision::contact, world.model.solver = Solver::iterative;
  world.model.scale = 4;
  add_wall(world, {0, 0, 0}, {0, 1, 0});
  world.model.walls[0].friction = mu;
  return world;
}

int add_block(World<3>& world, Vec3 size, Vec3 x, Vec3 v = Vec3::Zero(), Vec3 turn = Vec3::Zero(),
              double mu = 0.5) {
  const int i = add_solid(world, brick(size), size.prod() * 1000, x, v, exponential(turn), Vec3::Zero(), 0);
  world.model.bodies[i].friction = mu;
  return i;
}

double deepest(const World<3>& world, const State<3>& state) {
  double depth = 0;
  for (std::size_t a = 0; a < state.x.size(); ++a) {
    for (std::size_t b = a + 1; b < state.x.size(); ++b) {
      depth = std::max(depth, -separation(world.model.bodies[a].shape, body_motion(state, int(a)),
                                          world.model.bodies[b].shape, body_motion(state, int(b))));
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
    add_block(world, {dice.between(0.2, 0.3), dice.between(0.2, 0.3), dice.between(0.2, 0.3)}, place,
              Vec3::Zero(), dice.vec(1), mu);
  }
  return world;
}

TEST(SpaceIterative, ABoxStopsAfterVSquaredOverTwoMuGInEveryDirection) {
  const double mu = 0.3, v = 1;
  for (int i = 0; i < 12; ++i) {
    const double angle = (30 * i + 7) * std::numbers::pi / 180;
    const Vec3 way(std::cos(angle), 0, std::sin(angle));
    World<3> world = swept_room(mu);
    add_block(world, {0.4, 0.1, 0.4}, {0, 0.05, 0}, v * way, Vec3::Zero(), mu);
    const State<3> now = stepped(world, 400);
    // the step in which it stops: (mu g h)^2 / (8 mu g), and what sweeps leave
    EXPECT_NEAR((now.x[0] - Vec3(0, 0.05, 0) - v * v / (2 * mu * kG) * way).norm(), 0, 1e-5) << i;
  }
}

TEST(SpaceIterative, AHeapComesToRestAndCarriesItsWeight) {
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

TEST(SpaceIterative, ASmallHeapLiesInItselfByAMillionthAtMost) {
  World<3> world = heap(12, 2, 0.5);
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  const auto asleep = [&] {
    return std::all_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
  };
  for (int i = 0; i < 3000 && (i == 0 || !asleep()); ++i) ASSERT_FALSE(stepper.step(state));
  EXPECT_TRUE(asleep());
  EXPECT_GT(state.contacts.size(), 30u);
  for (const Contact<3>& contact : state.contacts) EXPECT_GT(contact.gap, -1e-6 * 0.3);
}

TEST(SpaceIterative, ARunCutInTwoIsTheRunInOne) {
  const World<3> world = heap(12, 2, 0.5);
  const State<3> whole = stepped(world, 300);
  for (const int at : {53, 137, 240, 291}) {
    World<3> half = world;
    half.state = stepped(world, at);
    EXPECT_EQ(words(stepped(half, 300 - at)), words(whole)) << at;
  }
}

TEST(SpaceIterative, TwoLanesGiveTheSameBitsAsFour) {
  if (!lanes::four_lanes) GTEST_SKIP() << "this processor has no AVX2";
  const World<3> world = heap(40, 3, 0.5);
  const State<3> four = stepped(world, 400);
  lanes::four_lanes = false;
  const State<3> two = stepped(world, 400);
  lanes::four_lanes = true;
  EXPECT_EQ(words(two), words(four));
}

// less the booked work of pushing overlaps apart
TEST(SpaceIterative, EnergyOfAHeapOnlyFalls) {
  const World<3> world = heap(20, 2, 0.4);
  State<3> state = world.state;
  Stepper<3> stepper(world.model);
  stepper.begin(state);
  double before = energy(world, state);
  const double whole = before;
  for (int i = 0; i < 900; ++i) {
    ASSERT_FALSE(stepper.step(state));
    const double now = energy(world, state) - state.ledger.displacement;
    EXPECT_LT(now, before + 1e-12 * whole) << i;
    before = now;
  }
  EXPECT_LT(before, 0.6 * whole);
}

// Four floors of five by five, blown apart from below their middle.
World<3> blown_apart() {
  World<3> world = swept_room(0.5);
  for (int i = 0; i < 100; ++i) {
    const int box = add_block(world, {0.3, 0.3, 0.3},
                              {0.32 * (i % 5 - 2), 0.15 + 0.3 * (i / 25), 0.32 * (i / 5 % 5 - 2)});
    world.model.bodies[box].elasticity = 0.3;
  }
  Explosion<3> blast;
  blast.center = {0.05, -0.3, 0.08}, blast.strength = 1500, blast.duration = {1, 10};
  blast.softening = 0.1;
  world.model.explosions.push_back(blast);
  return world;
}

TEST(SpaceIterative, AHundredBoxesBlownApartComeToRestWithNoEnergyFromNowhere) {
  const World<3> world = blown_apart();
  const auto run = [&](State<3>& state, double& gained, double& thrown) {
    Stepper<3> stepper(world.model);
    stepper.begin(state);
    const auto asleep = [&] {
      return std::all_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
    };
    double before = 0;
    for (int step = 0; step < 9000; ++step) {
      if (stepper.step(state)) return false;
      const double now = energy(world, state) - state.ledger.displacement;
      if (step == 60) thrown = now;
      if (step > 60) gained = std::max(gained, now - before);
      before = now;
      if (step > 60 && asleep()) return true;
    }
    return false;
  };
  State<3> one = world.state, other = world.state;
  double gained = 0, thrown = 0, again = 0, same = 0;
  bool rests = false, also = false;
  std::thread beside([&] { also = run(other, again, same); });
  rests = run(one, gained, thrown);
  beside.join();
  EXPECT_TRUE(rests) << "in fifteen seconds";
  EXPECT_TRUE(also);
  EXPECT_EQ(words(one), words(other)) << "two threads at once, the same bits";
  EXPECT_GT(thrown, 1.5 * energy(world, world.state)) << "they fly";
  EXPECT_LE(gained, 1e-10 * thrown) << thrown << " J thrown";
  EXPECT_GT(one.x[12].norm(), 0.5) << "apart";
  // without ants
  const State<3> before = one;
  Stepper<3> stepper(world.model);
  stepper.begin(one);
  for (int i = 0; i < 600; ++i) ASSERT_FALSE(stepper.step(one));
  EXPECT_EQ(one.x, before.x);
}

}  // namespace
}  // namespace obscura::sim
