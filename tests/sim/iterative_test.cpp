// Contact by sweeps: against closed forms, statics, and itself.

#include "sim/solve/iterate/plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "allocations.h"
#include "rooms.h"
#include "sim/energy/energy.h"
#include "sim/math/lanes.h"
#include "sim/math/trig.h"
#include "sim/solve/iterate/wide_sin_cos.h"
#include "sim/step/stepper.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

// a world, its solver and its clock
struct Room {
  World<2> world = room();
  std::vector<Path<2>> paths;
  std::unique_ptr<PlaneIterative> solver;

  Room() { world.model.rate = {600, 1}, world.model.collision = Collision::contact; }
  int box(Vec2 size, Vec2 x, double friction, double elasticity = 0, Vec2 v = {0, 0}, double angle = 0,
          double spin = 0) {
    const int i = add_box(world, size, size[0] * size[1], x, v, angle, spin, elasticity);
    world.model.bodies[i].friction = friction;
    return i;
  }
  int disc(double radius, Vec2 x, double friction, double elasticity, Vec2 v = {0, 0}, double spin = 0) {
    Body<2> body;
    body.shape = Ball<2>{radius};
    body.mass = 1, body.inertia[0] = 0.5 * radius * radius;
    body.friction = friction, body.elasticity = elasticity;
    world.model.bodies.push_back(body);
    world.state.x.push_back(x), world.state.v.push_back(v);
    world.state.turn.push_back(Orientation<2>(0)), world.state.spin.push_back(AngularVec<2>(spin));
    return int(world.model.bodies.size()) - 1;
  }
  void floor(double slope = 0) { add_wall(world, {0, 0}, {-std::sin(slope), std::cos(slope)}); }
  void run(double seconds) {
    if (!solver) solver = std::make_unique<PlaneIterative>(world.model, paths);
    const double h = 1 / value(world.model.rate);
    for (const auto end = world.state.step + std::llround(seconds / h); world.state.step < end;
         ++world.state.step)
      solver->step(world.state, double(world.state.step) * h, h);
  }
  double energy() const { return energies(world.model, world.state, paths, 0).total(); }
  State<2>& state() { return world.state; }
};

Room pyramid(int base) {
  Room r;
  r.floor();
  for (int row = 0; row < base; ++row) {
    for (int i = 0; i < base - row; ++i) r.box({1, 1}, {1.125 * (i + 0.5 * row), 0.5 + row}, 0.6);
  }
  return r;
}

// the mean velocity moves a body under constant friction exactly; only the step in which it stops is cut
// short, by less than (mu g h)^2 / (8 mu g)
TEST(PlaneIterative, BoxStopsAfterVSquaredOverTwoMuG) {
  for (const double mu : {0.1, 0.3, 0.8}) {
    Room r;
    r.floor();
    r.box({1, 0.5}, {0, 0.25}, mu, 0, {5, 0});
    r.run(6);
    const double distance = 25 / (2 * mu * kG), h = 1.0 / 600;
    EXPECT_NEAR(r.state().x[0][0], distance, mu * kG * h * h / 8 + 1e-9) << mu;
    EXPECT_NEAR(r.state().v[0][0], 0, 1e-15) << mu;
  }
}

TEST(PlaneIterative, BlockSticksBelowTheAngleOfFrictionAndSlidesAbove) {
  const double mu = 0.5;
  for (const double off : {-0.01, 0.01}) {
    const double slope = std::atan(mu) + off * std::numbers::pi / 180;
    Room r;
    r.floor(slope);
    r.box({1, 0.5}, {-0.25 * std::sin(slope), 0.25 * std::cos(slope)}, mu, 0, {0, 0}, slope);
    r.run(2);
    const double way =
        std::hypot(r.state().x[0][0] + 0.25 * std::sin(slope), r.state().x[0][1] - 0.25 * std::cos(slope));
    if (off < 0) {
      // the first step starts without forces and may creep
      EXPECT_LT(way, 1e-6);
    } else {
      const double a = kG * (std::sin(slope) - mu * std::cos(slope));
      EXPECT_NEAR(way, 0.5 * a * 4, 0.01 * a * 4);
    }
  }
}

// m v = J, I w = J r, v = w r with I = m r^2 / 2
TEST(PlaneIterative, SlidingDiscRollsAtTwoThirdsOfItsSpeed) {
  Room r;
  r.floor();
  r.disc(0.2, {0, 0.2}, 0.3, 0, {3, 0});
  r.run(3);
  EXPECT_NEAR(r.state().v[0][0], 2, 1e-9);
  EXPECT_NEAR(r.state().spin[0][0], -10, 1e-8);
}

// the blow is placed within the step, to second order in it: what is left is rounding
// Discs in flight, with drag and without, and one that no contact disturbs among others that touch: the same
// scheme by either solver, to rounding.
TEST(PlaneIterative, FreeBodiesMoveByTheIntegratorThatIsNamed) {
  for (const Integrator integrator :
       {Integrator::rk4, Integrator::midpoint, Integrator::euler, Integrator::semi_implicit}) {
    Room r;
    for (int i = 0; i < 4; ++i) {
      r.disc(0.1, {double(i), 2}, 0.5, 0.5, {1.0 + i, 2}, 3);
      r.world.model.bodies.back().drag = 0.5 * i;
    }
    r.world.model.rate = {600, 1}, r.world.model.integrator = integrator;
    r.world.model.solver = Solver::iterative;
    World<2> exact = r.world;
    exact.model.solver = Solver::direct;
    Stepper<2> many(r.world.model), few(exact.model);
    many.begin(r.world.state), few.begin(exact.state);
    for (int step = 0; step < 300; ++step) {
      ASSERT_FALSE(many.step(r.world.state));
      ASSERT_FALSE(few.step(exact.state));
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_LT((r.world.state.x[i] - exact.state.x[i]).norm(), 1e-13) << int(integrator) << ", " << i;
      EXPECT_LT((r.world.state.v[i] - exact.state.v[i]).norm(), 1e-13) << int(integrator) << ", " << i;
    }
  }
}

TEST(PlaneIterative, ElasticBouncesKeepTheEnergy) {
  Room r;
  r.floor();
  r.disc(0.3, {0, 2}, 0, 1);
  const double begun = r.energy();
  r.run(60);
  EXPECT_NEAR(r.energy(), begun, 1e-10 * begun);
}

// heavy and light, thin and spinning, some of them too fast to be seen coming: no blow gives to one what it
// has not taken from the other, to rounding (about 1e-16 a blow). Where many touch at once some is lost
TEST(PlaneIterative, AnElasticGasGainsNoEnergy) {
  Room r;
  for (const auto& [at, normal] :
       {std::pair<Vec2, Vec2>{{0, 0}, {0, 1}}, {{0, 3}, {0, -1}}, {{0, 0}, {1, 0}}, {{4, 0}, {-1, 0}}})
    add_wall(r.world, at, normal);
  r.world.model.gravity.setZero();
  r.world.model.rate = {1000, 1};
  for (int i = 0; i < 40; ++i) {
    const Vec2 x(0.25 + 0.5 * (i % 8), 0.3 + 0.6 * (i / 8)), v(4 * std::sin(i * 1.7), 4 * std::cos(i * 2.3));
    const int body = r.box({0.06 + 0.03 * (i % 5), 0.2}, x, 0, 1, v, 0.7 * i, 9 * std::sin(i * 0.9));
    const double heavier = i % 4 == 0 ? 1000 : 1;
    r.world.model.bodies[body].mass *= heavier, r.world.model.bodies[body].inertia *= heavier;
  }
  double before = r.energy();
  for (int i = 0; i < 200; ++i) {
    r.run(0.01);
    const double now = r.energy();
    ASSERT_LE(now, before * (1 + 1e-12)) << i;
    before = now;
  }
}

TEST(PlaneIterative, CradleHandsTheBlowOn) {
  Room r;
  r.world.model.gravity = {0, 0};
  r.disc(0.1, {-0.5, 0}, 0, 1, {1, 0});
  for (int i = 0; i < 4; ++i) r.disc(0.1, {0.2 * i, 0}, 0, 1);
  r.world.model.impacts = Impacts::sequential;
  r.run(1);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(r.state().v[i][0], 0, 1e-12) << i;
  EXPECT_NEAR(r.state().v[4][0], 1, 1e-12);
}

// by Newton's law for all at once: the pair that meets parts as fast as it met, the others stay together
TEST(PlaneIterative, WhatTouchesMeetsABlowTogether) {
  Room r;
  r.world.model.gravity = {0, 0};
  r.disc(0.1, {-0.5, 0}, 0, 1, {1, 0});
  for (int i = 0; i < 4; ++i) r.disc(0.1, {0.2 * i, 0}, 0, 1);
  r.run(1);
  EXPECT_NEAR(r.state().v[0][0], -0.6, 1e-12);
  for (int i = 1; i < 5; ++i) EXPECT_NEAR(r.state().v[i][0], 0.4, 1e-12) << i;
}

// e = 0: what is left of the blow is what the iterations leave, 1e-7 widths a second
TEST(PlaneIterative, AHeavyBallOnALightBoxDoesNotBounceWhateverMovesElsewhere) {
  for (const bool beside : {false, true}) {
    for (const int rate : {60, 240, 600}) {
      Room r;
      r.world.model.rate = {rate, 1};
      r.floor();
      r.box({0.5, 0.2}, {0, 0.1}, 0.5);
      const int ball = r.disc(0.2, {0.03, 1}, 0.5, 0);
      r.world.model.bodies[ball].mass = 50, r.world.model.bodies[ball].inertia[0] = 0.5 * 50 * 0.04;
      if (beside) {
        // to and fro, 40 widths a second
        for (const double x : {19.5, 22.5}) r.world.model.bodies[r.box({1, 4}, {x, 2}, 0)].fixed = true;
        r.disc(0.5, {21, 2}, 0, 1, {40, 0});
      }
      r.run(0.34);
      double most = 0;
      for (int i = 0; i < rate / 2; ++i) {
        r.run(1.0 / rate);
        for (const int body : {0, ball}) most = std::max(most, r.state().v[body][1]);
      }
      EXPECT_LT(most, 1e-6) << rate << " " << beside;
      EXPECT_NEAR(r.state().x[ball][1], 0.4, 1e-6) << rate << " " << beside;
    }
  }
}

// both corners of a flat landing are one blow
TEST(PlaneIterative, FlatLandingDoesNotTurnABox) {
  Room r;
  r.floor();
  r.box({1, 1}, {0, 2}, 0.5, 0.4);
  r.run(2);
  EXPECT_NEAR(r.state().turn[0][0], 0, 1e-13);
  EXPECT_NEAR(r.state().x[0][0], 0, 1e-13);
}

TEST(PlaneIterative, EachInterfaceOfAStackCarriesTheWeightAbove) {
  Room r;
  r.floor();
  for (int i = 0; i < 10; ++i) r.box({1, 1}, {0, 0.5 + i}, 0.5);
  r.run(1);
  std::vector<double> carried(10, 0);
  for (const Contact<2>& contact : r.state().contacts) {
    if (contact.key.b < 0) carried[0] += contact.force[1];
    if (contact.key.b >= 0) carried[contact.key.b] -= contact.force[1];
  }
  // half a second of sweeps, forty a step
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(carried[i], (10 - i) * kG, 1e-6 * kG) << i;
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(r.state().x[i][1], 0.5 + i, 1e-6) << i;
}

TEST(PlaneIterative, PyramidStands) {
  Room r = pyramid(20);
  const auto begun = r.state().x;
  r.run(5);
  for (std::size_t i = 0; i < begun.size(); ++i) {
    // it settles by a thousandth of a box while the first sweeps find the forces
    EXPECT_LT((r.state().x[i] - begun[i]).norm(), 2e-3) << i;
    EXPECT_LT(r.state().v[i].norm(), 1e-3) << i;
  }
}

// six seconds in one, and cut at each of some instants, s: the same words
void expect_cut_is_whole(const Room& begun, std::initializer_list<double> cuts) {
  Room whole;
  whole.world = begun.world;
  whole.run(6);
  for (const double first : cuts) {
    Room cut;
    cut.world = begun.world;
    cut.run(first);
    cut.solver.reset();
    cut.run(6 - first);
    EXPECT_EQ(words(whole.state()), words(cut.state())) << first;
  }
}

// everything a step needs is in the state, also between two looks for pairs
TEST(PlaneIterative, RunCutInTwoIsTheRunInOne) {
  Room whole;
  whole.floor();
  for (int i = 0; i < 12; ++i)
    whole.box({0.5, 0.5}, {0.3 * (i % 3), 0.6 + 0.7 * i}, 0.4, 0.2, {0.1 * i, 0}, 0.3 * i);
  whole.disc(0.2, {0.4, 12}, 0.3, 0.5);
  expect_cut_is_whole(whole, {303 / 600.0, 901 / 600.0, 3001 / 600.0});
}

// the same where a step is several stretches, with joints that bear loads
TEST(PlaneIterative, RunCutInTwoIsTheRunInOneAtALowRate) {
  Room whole;
  whole.world.model.rate = {60, 1};
  whole.floor();
  for (int i = 0; i < 12; ++i)
    whole.box({0.5, 0.5}, {0.3 * (i % 3), 0.6 + 0.7 * i}, 0.4, 0.2, {0.1 * i, 0}, 0.3 * i);
  for (int i = 0; i < 4; ++i) {
    Joint<2> joint;
    joint.a = {2 * i + 1, {-0.25, 0}}, joint.b = {2 * i, {0.3, 0}};
    joint.a.local = rotation<2>(whole.state().turn[2 * i + 1]).transpose() *
                    (whole.state().x[2 * i] + rotation<2>(whole.state().turn[2 * i]) * joint.b.local -
                     whole.state().x[2 * i + 1]);
    joint.friction = 0.1 * i, joint.lower = -1, joint.upper = 0.5;
    whole.world.model.joints.push_back(joint);
  }
  expect_cut_is_whole(whole, {0.5, 1.25, 4.0});
}

// pairs that come and go leave the others in their seats, where a run that goes on seats them all anew
TEST(PlaneIterative, AHeapCutInTwoIsTheHeapInOne) {
  Room whole;
  whole.world.model.rate = {60, 1};
  whole.floor();
  for (int i = 0; i < 200; ++i)
    whole.box({0.5, 0.5}, {0.7 * (i % 20) + 0.1 * (i / 20 % 3), 0.6 + 0.7 * (i / 20)}, 0.4, 0.2, {0, 0},
              0.1 * (i % 7));
  expect_cut_is_whole(whole, {0.5, 1.25, 4.0});
}

TEST(PlaneIterative, TwoLanesGiveTheSameBitsAsFour) {
  if (!lanes::four_lanes) GTEST_SKIP() << "this processor has no AVX2";
  const auto run = [](bool four) {
    lanes::four_lanes = four;
    Room r;
    r.floor();
    for (int i = 0; i < 200; ++i) {
      const Vec2 x{0.7 * (i % 20) + 0.1 * (i / 20 % 3), 0.6 + 0.7 * (i / 20)};
      i % 3 ? r.box({0.5, 0.5}, x, 0.4, 0.2, {0, 0}, 0.1 * (i % 7)) : r.disc(0.25, x, 0.4, 0.2);
    }
    r.run(1);
    lanes::four_lanes = true;
    return words(r.state());
  };
  EXPECT_EQ(run(false), run(true));
}

// 400 boxes dropped come to rest and stay there to the bit, each at most a hundredth of its reach in another.
// Put right to the last they crept for ever: their sweeps are few
TEST(PlaneIterative, AHeapOfHundredsComesToRest) {
  Room r;
  r.world.model.rate = {60, 1};
  r.floor(), add_wall(r.world, {0, 0}, {1, 0}), add_wall(r.world, {40, 0}, {-1, 0});
  for (int i = 0; i < 400; ++i)
    r.box({0.5, 0.5}, {2 + 0.9 * (i % 20) + 0.03 * (i / 20), 1 + 0.9 * (i / 20) + 0.01 * (i % 20)}, 0.6, 0,
          {0, 0}, 0.12 * (i % 7));
  r.run(15);
  EXPECT_EQ(std::count(r.state().frozen.begin(), r.state().frozen.end(), 1), 400);
  for (const Contact<2>& contact : r.state().contacts) EXPECT_GT(contact.gap, -1.1e-2 * std::sqrt(0.125));
  const auto before = r.state().x;
  r.run(5);
  EXPECT_EQ(r.state().x, before);
}

// half a millimetre apart they bear nothing of one another: who has lain still need not wake the other
TEST(PlaneIterative, TwoThatLieBesideEachOtherLetEachOtherSleep) {
  for (int height = 1; height <= 12; ++height) {
    Room r;
    r.world.model.rate = {60, 1};
    r.floor();
    r.box({0.5, 0.5}, {0, 0.25}, 0.6);
    r.box({0.5, 0.5}, {0.5005, 0.25 + 0.04 * height}, 0.6);
    r.run(4);
    for (int i = 0; i < 60; ++i) {
      r.run(1.0 / 60);
      ASSERT_EQ(r.state().frozen, std::vector<char>({1, 1})) << height << " at " << i;
    }
  }
}

// forces from the top down are its equilibrium: it never moves by more than rounding, and freezes
TEST(PlaneIterative, PyramidOfBaseAHundredStandsAndFreezes) {
  Room r = pyramid(100);
  r.world.model.rate = {60, 1};
  const auto begun = r.state().x;
  r.run(0.5);
  for (std::size_t i = 0; i < begun.size(); ++i) {
    ASSERT_TRUE(r.state().frozen[i]) << i;
    ASSERT_LT((r.state().x[i] - begun[i]).norm(), 1e-12) << i;
  }
}

TEST(PlaneIterative, TurnsManyAtOnceToTheBit) {
  std::vector<double> turns;
  for (int i = -4000; i < 4000; ++i) turns.push_back(i * 0.0137), turns.push_back(i * 261.7);
  turns.insert(turns.end(), {0.0, -0.0, 1e-300, 1048576, -1048577, 1e15});
  std::vector<plane::Pose> poses(turns.size());
  plane::turn_all(turns.data(), poses.data(), int(turns.size()));
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const SinCos want = sin_cos(turns[i]);
    ASSERT_TRUE(poses[i].c == want.cos && poses[i].s == want.sin) << turns[i];
    ASSERT_EQ(std::signbit(poses[i].s), std::signbit(want.sin)) << turns[i];
  }
}

// a spring takes part of the weight and pulls sideways, less than friction holds: what the floor gives is the
// rest. Springs act along the free fall of a step, so their dampers feel c a h / 2 of what the floor stops
TEST(PlaneIterative, SpringsAndTheFloorShareAWeight) {
  Room r;
  r.floor();
  const int i = r.box({1, 1}, {0, 0.5}, 0.5);
  add_spring(r.world, {-1, {0, 3}}, {i, {0, 0}}, 2, 0.5, 1);
  add_spring(r.world, {-1, {2, 0.5}}, {i, {0, 0}}, 1, 1, 1);
  r.run(2);
  EXPECT_NEAR((r.state().x[i] - Vec2(0, 0.5)).norm(), 0, 1e-6);
  Vec2 sum(0, 0);
  for (const Contact<2>& contact : r.state().contacts) sum += contact.force;
  EXPECT_NEAR(sum[1], kG - 2 * 2, 1.01 * (kG - 4) / 1200);
  EXPECT_NEAR(sum[0], -1, 1.01 / 1200);
}

// static equilibrium found, to 1e-6 of g: from then on nothing changes by a bit
TEST(PlaneIterative, StackAndPyramidFreezeAndStayToTheBit) {
  Room stack;
  stack.floor();
  for (int i = 0; i < 10; ++i) stack.box({1, 1}, {0.01 * (i % 2), 0.5 + i}, 0.5);
  Room heap = pyramid(8);
  for (Room* r : {&stack, &heap}) {
    r->run(10);
    for (const char frozen : r->state().frozen) EXPECT_TRUE(frozen);
    const State<2> then = r->state();
    r->run(2);
    EXPECT_EQ(r->state().x, then.x);
    EXPECT_EQ(r->state().contacts, then.contacts);
  }
}

// a speed threshold would freeze it: 0.96 mm/s after half a second
TEST(PlaneIterative, SlowSlideIsNotFrozen) {
  const double mu = 0.5, slope = std::atan(mu) + 0.01 * std::numbers::pi / 180;
  Room r;
  r.floor(slope);
  r.box({1, 0.5}, {-0.25 * std::sin(slope), 0.25 * std::cos(slope)}, mu, 0, {0, 0}, slope);
  r.run(1);
  EXPECT_FALSE(r.state().frozen[0]);
  EXPECT_GT(r.state().v[0].norm(), 1e-3);
}

TEST(PlaneIterative, SleepersWakeWhenTouched) {
  Room r;
  r.floor();
  for (int i = 0; i < 4; ++i) r.box({1, 1}, {0, 0.5 + i}, 0.5);
  r.disc(0.25, {-16, 2.5}, 0.3, 0.5, {4, 8});
  r.run(1.2);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(r.state().frozen[i]) << i;
  r.world.model.gravity = {0, -9.81};
  r.state().x[4] = {-4, 2.5}, r.state().v[4] = {30, 0};
  r.run(0.5);
  EXPECT_FALSE(r.state().frozen[2]);
  EXPECT_GT(r.state().x[2][0], 0.1);
}

TEST(PlaneIterative, FastBallStaysInTheRoomAndOutOfBoxes) {
  for (const Vec2& v : {Vec2(1e4, 0), Vec2(7e3, 7.1e3), Vec2(3e3, -9e3)}) {
    Room r;
    add_walls(r.world, 8, 4.5);
    r.disc(0.05, {1, 2}, 0.2, 0.9, v);
    r.box({0.5, 3}, {5, 1.5}, 0.5, 0.5);
    r.world.model.bodies[1].fixed = true;
    for (int i = 0; i < 240; ++i) {
      r.run(1 / 600.0);
      const Vec2 at = r.state().x[0];
      ASSERT_TRUE(at[0] > 0 && at[0] < 8 && at[1] > 0 && at[1] < 4.5) << i << " " << at.transpose();
      ASSERT_FALSE(std::fabs(at[0] - 5) < 0.25 && at[1] < 3) << i << " " << at.transpose();
    }
  }
}

TEST(PlaneIterative, WarmStepAllocatesNothing) {
  Room r = pyramid(10);
  r.run(0.5);
  const std::size_t before = allocations();
  r.run(1);
  EXPECT_EQ(allocations(), before);
}

}  // namespace
}  // namespace obscura::sim
