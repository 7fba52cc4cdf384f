// Where nothing pulls, drives or explodes, contact may only take energy: random rooms of balls, boxes, rods
// and other shapes, of any friction and elasticity, by every solver; and the account that sees to it.

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>

#include "sim/energy/energy_guard.h"
#include "sim/space_rooms.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

World<2> plane_room(int seed, int bodies) {
  Chance chance(std::uint64_t(seed) * 77 + 5);
  World<2> world = touching_room();
  add_walls(world, 3, 3);
  const int columns = bodies > 12 ? 6 : 4;
  const double cell = 3.0 / columns, r = 0.45 * cell;
  for (int i = 0; i < bodies; ++i) {
    const Vec2 x(cell * (0.5 + i % columns), cell * (0.5 + i / columns));
    const Vec2 v{chance.between(-4, 4), chance.between(-4, 4)};
    const double e = chance.between(0, 1), angle = chance.between(-3, 3), spin = chance.between(-8, 8),
                 m = chance.between(0.2, 4), kind = chance.between(0, 5);
    if (kind < 1) {
      add_ball(world, chance.between(0.3 * r, r), m, x, v, spin, e);
    } else if (kind < 2) {
      add_box(world, {chance.between(0.4 * r, 1.3 * r), chance.between(0.2 * r, 1.3 * r)}, m, x, v, angle,
              spin, e);
    } else if (kind < 3) {
      add_polygon(world, odd_polygon(chance, 3 + int(chance.between(0, 4)), r), m, x, v, angle, spin, e);
    } else {
      add_box(world, {chance.between(r, 1.9 * r), 0.04}, m, x, v, angle, spin, e);
    }
    world.model.bodies.back().friction = chance.between(0, 1.1);
  }
  return world;
}

World<3> space_room(int seed, int bodies) {
  SpaceDice dice(std::uint32_t(seed + 1));
  World<3> world = space();
  world.model.rate = {600, 1}, world.model.scale = 4;
  world.model.collision = Collision::contact;
  add_wall(world, {0, 0, 0}, {0, 1, 0}), add_wall(world, {-1, 0, 0}, {1, 0, 0});
  add_wall(world, {1, 0, 0}, {-1, 0, 0}), add_wall(world, {0, 0, -1}, {0, 0, 1});
  add_wall(world, {0, 0, 1}, {0, 0, -1});
  for (int i = 0; i < bodies; ++i) {
    const Vec3 x(0.6 * (i % 3) - 0.6, 0.4 + 0.6 * (i / 9), 0.6 * ((i / 3) % 3) - 0.6);
    const double kind = dice.between(0, 4);
    Shape<3> shape = brick({0.3, 0.3, 0.3});
    if (kind < 1) shape = brick({dice.between(0.1, 0.5), dice.between(0.1, 0.4), dice.between(0.1, 0.4)});
    if (kind > 2) shape = brick({0.04, dice.between(0.3, 0.5), 0.04});
    if (kind > 3) shape = capsule(dice.between(0.05, 0.15), dice.between(0.05, 0.12));
    const double mass = dice.between(0.2, 5);
    const Vec3 v = dice.vec(3);
    const Orientation<3> turn = exponential(dice.vec(1));
    const Vec3 spin = dice.vec(8);
    add_solid(world, shape, mass, x, v, turn, spin, dice.between(0, 1));
    world.model.bodies.back().friction = dice.between(0, 1);
  }
  return world;
}

// of what the room has above its floor at the start
template <int D>
void expect_only_losses(const World<D>& world, int steps, double slack, const std::string& what) {
  State<D> state = world.state;
  Stepper<D> stepper(world.model);
  stepper.begin(state);
  const auto left = [&] { return energy(world, state) - state.ledger.displacement; };
  double before = left();
  const double all = before;
  for (int i = 0; i < steps; ++i) {
    ASSERT_FALSE(stepper.step(state)) << what << " at step " << i;
    const double now = left();
    ASSERT_LE(now, before + slack * all) << what << " at step " << i;
    before = now;
  }
  EXPECT_LT(before, all) << what;
}

// flight under gravity is exact, contact is kept account of: sums of a dozen bodies round by 1e-14
constexpr double kPlane = 1e-12;
// a thin rod tumbles by Runge and Kutta's steps: 8e-12 in one at 14 rad/s, as w h to the fifth
constexpr double kSpace = 1e-10;

TEST(Passive, RandomRoomsOfThePlaneOnlyLose) {
  for (int seed = 0; seed < 44; ++seed) {
    World<2> world = plane_room(seed, 2 + seed % 8);
    if (seed % 4 == 0) world.model.collision = Collision::event;
    ASSERT_NO_FATAL_FAILURE(expect_only_losses(world, 600, kPlane, "seed " + std::to_string(seed)));
  }
}

// beside the booked work of pushing overlaps apart: iterations end before the last contact has settled, and
// err both ways; were only their gains taken back, a pile that topples slowly would be braked
constexpr double kHeap = 3e-6;

TEST(Passive, RandomHeapsOfThePlaneOnlyLose) {
  for (int seed = 0; seed < 20; ++seed) {
    World<2> world = plane_room(seed, 8 + seed);
    world.model.solver = Solver::iterative;
    ASSERT_NO_FATAL_FAILURE(expect_only_losses(world, 900, kHeap, "seed " + std::to_string(seed)));
  }
}

TEST(Passive, RandomRoomsOfSpaceOnlyLose) {
  for (int seed = 0; seed < 16; ++seed) {
    World<3> world = space_room(seed, 2 + seed % 4);
    if (seed % 4 == 0) world.model.collision = Collision::event;
    ASSERT_NO_FATAL_FAILURE(expect_only_losses(world, 400, kSpace, "seed " + std::to_string(seed)));
  }
}

TEST(Passive, RandomHeapsOfSpaceOnlyLose) {
  for (int seed = 0; seed < 24; ++seed) {
    World<3> world = space_room(seed, 6 + seed);
    world.model.solver = Solver::iterative;
    ASSERT_NO_FATAL_FAILURE(expect_only_losses(world, 900, kSpace, "seed " + std::to_string(seed)));
  }
}

// Up to a dozen in a closed room, each on one before it or on the room by a joint of any kind, some held
// twice and some in loops, masses up to 50 : 1, thrown at random; joints up to a metre from the middles they
// hold.
template <int D>
World<D> tangle(int seed);

template <int D>
void join_tangle(World<D>& world, SpaceDice& dice, int bodies, std::span<const JointKind> kinds) {
  const auto vec = [&](double most) { return Vec<D>(dice.vec(most).template head<D>()); };
  const auto join = [&](int a, int b, const Vec<D>& at, JointKind kind) {
    Joint<D> joint;
    joint.kind = kind;
    const auto end = [&](int body, const Vec<D>& p) {
      return End<D>{body, body < 0 ? p : Vec<D>(p - world.state.x[std::size_t(body)])};
    };
    const bool reaches = kind == JointKind::rod || kind == JointKind::rope;
    const Vec<D> other = reaches ? Vec<D>(at + vec(0.3)) : at;
    joint.a = end(a, at), joint.b = end(b, other);
    joint.length = (other - at).norm();
    joint.axis = vec(1).normalized();
    const bool turns = kind == (D == 2 ? JointKind::pin : JointKind::hinge);
    if (turns && dice.between(0, 1) < 0.3) joint.lower = -0.2, joint.upper = 0.3;
    if (kind == JointKind::slider) joint.lower = -0.1, joint.upper = 0.1;
    world.model.joints.push_back(joint);
  };
  for (int i = 0; i < bodies; ++i) {
    const int on = int(dice.between(0, i + 1)) - 1, more = dice.between(0, 1) < 0.4 ? 2 : 1;
    const Vec<D> at = world.state.x[std::size_t(i)] + vec(dice.between(0, 1) < 0.2 ? 1 : 0.2);
    for (int k = 0; k < more; ++k) join(i, on, at, kinds[std::size_t(dice.between(0, double(kinds.size())))]);
  }
}

template <>
World<3> tangle<3>(int seed) {
  SpaceDice dice(std::uint32_t(seed + 1000));
  World<3> world = space();
  world.model.rate = {600, 1}, world.model.scale = 4, world.model.solver = Solver::iterative;
  world.model.collision = Collision::contact;
  for (int k = 0; k < 3; ++k) {
    const double half = k == 1 ? 0.75 : 1;
    const Vec3 middle(0, 0.75, 0), way = Vec3::Unit(k);
    add_wall(world, middle - half * way, way), add_wall(world, middle + half * way, -way);
  }
  const int bodies = 4 + int(dice.between(0, 9));
  for (int i = 0; i < bodies; ++i) {
    const Vec3 x(0.5 * (i % 3) - 0.5, 0.3 + 0.45 * (i / 9), 0.5 * ((i / 3) % 3) - 0.5);
    const bool box = dice.between(0, 2) < 1;
    const Vec3 size(dice.between(0.05, 0.3), dice.between(0.05, 0.3), dice.between(0.05, 0.3));
    const Shape<3> shape = box ? brick(size) : capsule(size[0] / 2, size[1] / 2);
    const double mass = dice.between(0, 1) < 0.3 ? 10 : dice.between(0.2, 2);
    const Vec3 v = dice.vec(3), spin = dice.vec(6);
    add_solid(world, shape, mass, x, v, no_rotation<3>(), spin, dice.between(0, 1));
    world.model.bodies.back().friction = dice.between(0, 1);
  }
  constexpr JointKind kKinds[] = {JointKind::pin,    JointKind::hinge, JointKind::weld,
                                  JointKind::slider, JointKind::rod,   JointKind::rope};
  join_tangle<3>(world, dice, bodies, kKinds);
  return world;
}

template <>
World<2> tangle<2>(int seed) {
  SpaceDice dice(std::uint32_t(seed + 2000));
  World<2> world = touching_room();
  world.model.solver = Solver::iterative;
  add_walls(world, 2.4, 1.8);
  const int bodies = 4 + int(dice.between(0, 9));
  for (int i = 0; i < bodies; ++i) {
    const Vec2 x(0.4 + 0.5 * (i % 4), 0.4 + 0.5 * (i / 4)), v = dice.vec(3).head<2>();
    const double mass = dice.between(0, 1) < 0.3 ? 10 : dice.between(0.2, 2), e = dice.between(0, 1);
    const double spin = dice.between(-6, 6), a = dice.between(0.05, 0.3), b = dice.between(0.05, 0.3);
    if (dice.between(0, 2) < 1)
      add_box(world, {a, b}, mass, x, v, 0, spin, e);
    else
      add_ball(world, a / 2, mass, x, v, spin, e);
    world.model.bodies.back().friction = dice.between(0, 1);
  }
  constexpr JointKind kKinds[] = {JointKind::pin, JointKind::weld, JointKind::slider, JointKind::rod,
                                  JointKind::rope};
  join_tangle<2>(world, dice, bodies, kKinds);
  return world;
}

// What joints, limits, ropes and contacts do, beside the booked work of putting positions back, gives no
// energy; the scheme errs by (w h)^5, with w of up to 67 rad/s.
constexpr double kWhirl = 1.7e-5;

// the energy that two steps of half the length give from there, J
template <int D>
double given_by_halves(World<D> world, State<D> state) {
  world.model.rate.num *= 2, state.step *= 2;
  Stepper<D> stepper(world.model);
  const double before = energy(world, state) - state.ledger.displacement;
  for (int half = 0; half < 2; ++half) EXPECT_FALSE(stepper.step(state));
  return energy(world, state) - state.ledger.displacement - before;
}

template <int D>
void expect_tangles_only_lose() {
  for (int seed = 0; seed < 30; ++seed) {
    const World<D> world = tangle<D>(seed);
    State<D> state = world.state;
    Stepper<D> stepper(world.model);
    stepper.begin(state);
    ASSERT_FALSE(stepper.step(state)) << seed;  // joints strike what begins apart
    const auto left = [&] { return energy(world, state) - state.ledger.displacement; };
    const double all = energy(world, state);
    double before = left();
    for (int step = 1; step < 300; ++step) {
      const State<D> begun = state;
      const auto trouble = stepper.step(state);
      ASSERT_FALSE(trouble) << "seed " << seed << " at step " << step << ": " << trouble->what;
      const double now = left();
      // where a link turns over within few steps it errs by more, and its order tells
      if (now > before + kWhirl * all) {
        ASSERT_LE(given_by_halves(world, begun), (now - before) / 8)
            << "seed " << seed << " at step " << step;
      }
      before = now;
    }
    for (const Vec<D>& x : state.x) EXPECT_LT(x.cwiseAbs().maxCoeff(), 2.5) << "seed " << seed;
  }
}

TEST(Passive, TanglesOfJointsInThePlaneOnlyLose) { expect_tangles_only_lose<2>(); }
TEST(Passive, TanglesOfJointsInSpaceOnlyLose) { expect_tangles_only_lose<3>(); }

// a step that has made all of it faster by a thousandth
template <int D>
State<D> hastened(const State<D>& state) {
  State<D> now = state;
  for (auto& v : now.v) v *= 1.001;
  for (auto& w : now.spin) w *= 1.001;
  return now;
}

template <int D>
void expect_taken_back(const World<D>& world) {
  EnergyGuard<D> account(world.model);
  account.open(world.state);
  EXPECT_FALSE(account.risen(world.state));
  State<D> state = hastened(world.state);
  ASSERT_TRUE(account.risen(state));
  const State<D> fast = state;
  for (int i = 1; i < int(state.x.size()); ++i) account.touch(i - 1, i);
  account.take_back(state, true);
  const double had = energy(world, world.state);
  EXPECT_NEAR(energy(world, state), had, 1e-13 * had);
  // of what nothing holds
  const double p = momentum(world.model, fast).norm(), L = angular_momentum(world.model, fast).norm();
  EXPECT_LT((momentum(world.model, state) - momentum(world.model, fast)).norm(), 1e-13 * p);
  EXPECT_LT((angular_momentum(world.model, state) - angular_momentum(world.model, fast)).norm(), 1e-11 * L);
}

TEST(EnergyGuard, TakesBackWhatAStepHasMadeAndLeavesMomentumAlone) {
  expect_taken_back(plane_room(3, 7));
  expect_taken_back(space_room(3, 7));
}

TEST(EnergyGuard, LowersWhatRestsAndHasBeenLifted) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {0.4, 0.2}, 1, {0, 0.1}), add_box(world, {0.4, 0.2}, 2, {0, 0.3});
  for (const bool lifted : {false, true}) {
    EnergyGuard<2> account(world.model);
    account.open(world.state);
    State<2> state = world.state;
    state.x[0].y() += 1e-6, state.x[1] += Vec2(1e-6, 3e-6);
    ASSERT_TRUE(account.risen(state));
    account.touch(0, -1), account.touch(0, 1);
    if (lifted) account.excuse(0, 1);
    account.take_back(state, true);
    EXPECT_NEAR(state.x[1].y(), 0.3 + (lifted ? 3e-6 : 0), 1e-15);
    EXPECT_EQ(state.x[1].x(), 1e-6);
  }
}

}  // namespace
}  // namespace obscura::sim
