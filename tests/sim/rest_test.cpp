// What moves and is not held goes on moving, however slowly; what is held comes to rest.

#include "sim/constraint/mobility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/solve/sleep.h"
#include "sim/space_rooms.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

// a vector of the plane, in space with what it is along z
template <int D>
Vec<D> at(double x, double y, double z = 0) {
  Vec<D> it = Vec<D>::Zero();
  it[0] = x, it[1] = y;
  if constexpr (D == 3) it[2] = z;
  return it;
}

// a spin about z
template <int D>
AngularVec<D> about_z(double w) {
  return AngularVec<D>::Unit(kAngular<D> - 1) * w;
}

// a room of 4 m; its floor, if there is gravity
template <int D>
World<D> quiet_room(Solver solver, double g, int rate = 600) {
  World<D> world;
  world.model.gravity = at<D>(0, -g);
  world.model.rate = {rate, 1};
  world.model.collision = Collision::contact, world.model.solver = solver;
  world.model.scale = 4;
  if (g > 0) world.model.walls.push_back({at<D>(0, 0), at<D>(0, 1), {}, {}});
  return world;
}

template <int D>
int add(World<D>& world, const Shape<D>& shape, Vec<D> x, Vec<D> v, double mu, double e = 0,
        AngularVec<D> w = AngularVec<D>::Zero()) {
  Body<D> body;
  body.name = "body[" + std::to_string(world.model.bodies.size()) + "]";
  body.shape = shape, body.mass = 1, body.friction = mu, body.elasticity = e;
  body.inertia = solid_inertia(shape, 1);
  world.model.bodies.push_back(body);
  world.state.x.push_back(x), world.state.v.push_back(v);
  world.state.turn.push_back(no_rotation<D>()), world.state.spin.push_back(w);
  return int(world.model.bodies.size()) - 1;
}

template <int D>
Shape<D> round_shape(double radius) {
  return ball_shape<D>(radius);
}

template <int D>
Shape<D> block(double width, double height) {
  return Box<D>{at<D>(width / 2, height / 2, width / 2)};
}

// act(dimension, solver) for both of both
template <class Act>
void each(Act&& act) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    const std::string by = solver == Solver::direct ? "direct" : "iterative";
    {
      SCOPED_TRACE("plane, " + by);
      act(std::integral_constant<int, 2>(), solver);
    }
    {
      SCOPED_TRACE("space, " + by);
      act(std::integral_constant<int, 3>(), solver);
    }
  }
}

struct Flight {
  int rate, count;
  double speed, seconds;
};

TEST(Rest, WhatFliesWithoutGravityFliesOn) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const Flight& it :
         {Flight{60, 1, 0.015, 100}, Flight{60, 1, 1e-9, 10}, Flight{60, 7, 0.015, 10},
          Flight{60, 20, 1e-4, 3}, Flight{60, 100, 0.015, 1}, Flight{60, 1000, 0.015, 1},
          Flight{600, 7, 0.015, 2}, Flight{6000, 1, 1e-6, 1}, Flight{6000, 7, 0.015, 0.5}}) {
      if (solver == Solver::direct && it.count > 100) continue;
      World<D> world = quiet_room<D>(solver, 0, it.rate);
      for (int i = 0; i < it.count; ++i) {
        const double way = 0.7 * i;
        add<D>(world, round_shape<D>(0.1), at<D>(0.5 * (i % 32), 0.5 * (i / 32)),
               it.speed * at<D>(std::cos(way), std::sin(way), 0.1), 0.5, 0.8);
      }
      // what comes nearer to its neighbour than they are apart would touch it
      ASSERT_LT(2 * it.speed * it.seconds, it.count > 1 ? 0.305 : 1e300);
      const State<D> now = stepped(world, int(it.rate * it.seconds));
      for (int i = 0; i < it.count; ++i) {
        const Vec<D> v = world.state.v[i], x = world.state.x[i] + it.seconds * v;
        EXPECT_EQ(now.v[i], v) << i << " of " << it.count;
        EXPECT_LE((now.x[i] - x).norm(), 1e-12 * (1 + x.norm())) << i << " of " << it.count;
        EXPECT_FALSE(now.frozen[i]) << i << " of " << it.count;
      }
    }
  });
}

TEST(Rest, WhatTouchesAndFliesAlongWithoutGravityFliesOn) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    World<D> world = quiet_room<D>(solver, 0);
    for (int i = 0; i < 7; ++i) add<D>(world, block<D>(0.2, 0.2), at<D>(0.2 * i, 0), at<D>(0.005, 0.01), 0.5);
    const State<D> now = stepped(world, 1200);
    for (int i = 0; i < 7; ++i) {
      EXPECT_LE((now.v[i] - world.state.v[i]).norm(), 1e-12) << i;
      EXPECT_LE((now.x[i] - world.state.x[i] - 2 * world.state.v[i]).norm(), 1e-9) << i;
    }
  });
}

TEST(Rest, PucksSlideOnWithoutFriction) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const Flight& it :
         {Flight{60, 1, 0.015, 60}, Flight{60, 1, 1e-6, 20}, Flight{60, 20, 0.01, 5},
          Flight{60, 1000, 0.01, 0.5}, Flight{600, 7, 0.003, 1}, Flight{6000, 1, 0.015, 0.4}}) {
      if (solver == Solver::direct && it.count > 20) continue;
      World<D> world = quiet_room<D>(solver, kG, it.rate);
      for (int i = 0; i < it.count; ++i)
        add<D>(world, block<D>(0.2, 0.1), at<D>(0.5 * i, 0.05), at<D>(it.speed, 0, 0.3 * it.speed), 0);
      const State<D> now = stepped(world, int(it.rate * it.seconds));
      for (int i = 0; i < it.count; ++i) {
        const Vec<D> x = world.state.x[i] + it.seconds * world.state.v[i];
        EXPECT_LE((now.v[i] - world.state.v[i]).norm(), 1e-9 * it.speed) << i << " of " << it.count;
        EXPECT_LE((now.x[i] - x).norm(), 1e-9) << i << " of " << it.count;
      }
    }
  });
}

TEST(Rest, WhatRollsRollsOn) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const Flight& it :
         {Flight{60, 1, 0.01, 120}, Flight{60, 1, 1e-6, 20}, Flight{60, 20, 0.01, 5},
          Flight{60, 1000, 0.01, 0.5}, Flight{600, 7, 0.015, 1}, Flight{6000, 1, 0.01, 0.4}}) {
      if (solver == Solver::direct && it.count > 20) continue;
      World<D> world = quiet_room<D>(solver, kG, it.rate);
      for (int i = 0; i < it.count; ++i)
        add<D>(world, round_shape<D>(0.1), at<D>(0.5 * i, 0.1), at<D>(it.speed, 0), 0.5, 0,
               about_z<D>(-it.speed / 0.1));
      const State<D> now = stepped(world, int(it.rate * it.seconds));
      for (int i = 0; i < it.count; ++i) {
        EXPECT_NEAR(now.v[i][0], it.speed, 1e-9 * it.speed) << i << " of " << it.count;
        EXPECT_NEAR(now.x[i][0], world.state.x[i][0] + it.speed * it.seconds, 1e-9)
            << i << " of " << it.count;
      }
    }
  });
}

// nothing brakes a turn about the one point it stands on
TEST(Rest, ABallThatTurnsAboutTheUprightTurnsOn) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    World<3> world = quiet_room<3>(solver, kG);
    add<3>(world, round_shape<3>(0.1), {0, 0.1, 0}, {0, 0, 0}, 0.5, 0, {0, 0.1, 0});
    const State<3> now = stepped(world, 3000);
    EXPECT_NEAR(now.spin[0][1], 0.1, 1e-12);
  }
}

TEST(Rest, APendulumSwingsOn) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const double wide : {1e-3, 1e-5}) {
      World<D> world = quiet_room<D>(solver, kG);
      add<D>(world, round_shape<D>(0.1), at<D>(wide, 2), at<D>(0, 0), 0.5);
      Joint<D> rod;
      rod.kind = JointKind::rod, rod.length = std::hypot(1, wide);
      rod.a = {0, Vec<D>::Zero()}, rod.b = {-1, at<D>(0, 3)};
      world.model.joints.push_back(rod);
      State<D> state = world.state;
      Stepper<D> stepper(world.model);
      stepper.begin(state);
      for (int i = 0; i < 12000; ++i) {
        ASSERT_FALSE(stepper.step(state));
        ASSERT_FALSE(state.frozen[0]) << wide << " at step " << i;
      }
      const double swing = std::hypot(state.x[0][0], state.v[0][0] / std::sqrt(kG));
      EXPECT_NEAR(swing, wide, 0.02 * wide);
    }
  });
}

// the last part of a slide, v^2 / (2 mu g) long
TEST(Rest, ASlideUnderLittleFrictionIsAsLongAsItIs) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const int rate : {60, 600, 6000}) {
      World<D> world = quiet_room<D>(solver, kG, rate);
      const double v = 0.015, mu = 0.002, way = v * v / (2 * mu * kG);
      add<D>(world, block<D>(0.2, 0.1), at<D>(0, 0.05), at<D>(v, 0), mu);
      const State<D> now = stepped(world, int(1.5 * rate));
      EXPECT_NEAR(now.x[0][0], way, 0.01 * way) << rate;
      EXPECT_TRUE(now.frozen[0]) << rate;
    }
  });
}

// on a slope on which friction all but holds them
TEST(Rest, ABlockRestsBelowTheAngleOfFrictionAndSlidesAboveIt) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    const double slope = 0.3;
    for (const double more : {-1e-3, -1e-4, 1e-4, 1e-3}) {
      World<D> world = quiet_room<D>(solver, 0);
      world.model.gravity = at<D>(kG * std::sin(slope), -kG * std::cos(slope));
      world.model.walls.push_back({at<D>(0, 0), at<D>(0, 1), {}, {}});
      add<D>(world, block<D>(0.2, 0.1), at<D>(0, 0.05), at<D>(0, 0), std::tan(slope) - more);
      const State<D> now = stepped(world, 600);
      const double a = more * kG * std::cos(slope);
      EXPECT_NEAR(now.x[0][0], std::max(0.0, 0.5 * a), 0.1 * std::fabs(a)) << more;
      EXPECT_EQ(now.frozen[0] != 0, more < 0) << more;
    }
  });
}

TEST(Rest, WhatAWeakBlastPushesGoesOn) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const double g : {0.0, kG}) {
      World<D> world = quiet_room<D>(solver, g);
      for (int i = 0; i < 7; ++i)
        add<D>(world, block<D>(0.1, 0.1), at<D>(0.4 + 0.3 * i, 0.05), at<D>(0, 0), 0);
      Explosion<D> weak;
      weak.strength = 1e-3, weak.center = at<D>(-1, 0.05), weak.duration = {2, 1};
      world.model.explosions.push_back(weak);
      const State<D> soon = stepped(world, 1210), late = stepped(world, 2410);
      for (int i = 0; i < 7; ++i) {
        const double r = 1.4 + 0.3 * i, v = 2 * (1 << D) * 1e-3 / (r * r);  // each corner is pushed
        EXPECT_NEAR(soon.v[i][0], v, 0.02 * v) << i << ", g " << g;
        EXPECT_NEAR(late.v[i][0], soon.v[i][0], 1e-9 * v) << i << ", g " << g;
        EXPECT_NEAR(late.x[i][0], soon.x[i][0] + 2 * soon.v[i][0], 1e-9) << i << ", g " << g;
      }
    }
  });
}

// what comes nearer wakes it when it is about to touch, not when it is first seen
TEST(Rest, WhatRestsSleepsUntilItIsReached) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    World<D> world = quiet_room<D>(solver, kG);
    add<D>(world, block<D>(0.2, 0.2), at<D>(0, 0.1), at<D>(0, 0), 0.5);
    add<D>(world, block<D>(0.2, 0.2), at<D>(-0.3, 0.1), at<D>(0.05, 0), 0);
    State<D> state = world.state;
    Stepper<D> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 1140; ++i) {  // 100 mm at 50 mm/s: at 5 mm
      ASSERT_FALSE(stepper.step(state));
      ASSERT_TRUE(state.frozen[0] || i < 300) << "at step " << i;
    }
    for (int i = 1140; i < 1260; ++i) ASSERT_FALSE(stepper.step(state));
    EXPECT_FALSE(state.frozen[0]);
  });
}

// what stands still is as heavy for a slow body as for a fast one
TEST(Rest, WhatComesSlowlyGivesItsMomentum) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const double g : {0.0, kG}) {
      World<D> world = quiet_room<D>(solver, g);
      add<D>(world, block<D>(0.2, 0.1), at<D>(0, 0.05), at<D>(0.01, 0), 0);
      add<D>(world, block<D>(0.2, 0.1), at<D>(0.21, 0.05), at<D>(0, 0), 0);
      const State<D> before = stepped(world, 500), after = stepped(world, 1200);
      EXPECT_NEAR(before.x[0][0], 0.01 * 500 / 600, 1e-9) << g;
      EXPECT_TRUE(before.frozen[1] || g == 0) << g;
      EXPECT_NEAR(after.v[0][0], 0.005, 1e-6) << g;
      EXPECT_NEAR(after.v[1][0], 0.005, 1e-6) << g;
    }
  });
}

TEST(Rest, WhatIsHeldComesToRest) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    for (const int rate : {60, 600, 6000}) {
      World<D> world = quiet_room<D>(solver, kG, rate);
      // a stack, a block that slides, a ball in a corner of two blocks
      for (int i = 0; i < 5; ++i)
        add<D>(world, block<D>(0.3, 0.2), at<D>(0, 0.1 + 0.2 * i), at<D>(0, 0), 0.5);
      add<D>(world, block<D>(0.3, 0.2), at<D>(1, 0.1), at<D>(0.2, 0), 0.5);
      const State<D> now = stepped(world, rate);
      for (int i = 0; i < 6; ++i) {
        EXPECT_TRUE(now.frozen[i]) << i << " at " << rate;
        EXPECT_EQ(now.v[i], at<D>(0, 0)) << i << " at " << rate;
      }
    }
  });
}

// lengths and gravity 2^k times as large: the same run, every number 2^k times as large
template <int D>
World<D> scaled(const World<D>& world, int k) {
  World<D> it = world;
  const double s = std::ldexp(1.0, k);
  it.model.gravity *= s, it.model.scale *= s;
  for (Body<D>& body : it.model.bodies) {
    if (Ball<D>* ball = form<Ball<D>>(body.shape)) ball->radius *= s;
    if (Box<D>* box = form<Box<D>>(body.shape)) box->half *= s;
    body.inertia *= s * s;
  }
  for (Wall<D>& wall : it.model.walls) wall.point *= s;
  for (Vec<D>& x : it.state.x) x *= s;
  for (Vec<D>& v : it.state.v) v *= s;
  return it;
}

TEST(Rest, ARoomScaledInLengthsAndGravityRestsAlike) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    World<D> world = quiet_room<D>(solver, 10);
    for (int i = 0; i < 3; ++i) add<D>(world, block<D>(0.3, 0.2), at<D>(0, 0.1 + 0.2 * i), at<D>(0, 0), 0.5);
    add<D>(world, block<D>(0.3, 0.2), at<D>(1, 0.1), at<D>(0.2, 0), 0.5);
    add<D>(world, round_shape<D>(0.1), at<D>(2, 0.1), at<D>(0.01, 0), 0.5, 0, about_z<D>(-0.1));
    add<D>(world, block<D>(0.3, 0.2), at<D>(3, 0.1), at<D>(0.015, 0), 0);
    add<D>(world, block<D>(0.3, 0.2), at<D>(4, 0.1), at<D>(0.015, 0), 0.001);
    add<D>(world, block<D>(0.3, 0.2), at<D>(5, 0.15), at<D>(0, 0), 0.5, 0.5);
    const State<D> want = stepped(world, 400);
    const std::vector<char> rests = {1, 1, 1, 1, 0, 0, 0, 1};
    EXPECT_EQ(want.frozen, rests);
    for (const int k : {-20, -13, -7, -1, 1, 7, 13, 20}) {
      const World<D> other = scaled(world, k);
      const State<D> now = stepped(other, 400);
      const double s = std::ldexp(1.0, k);
      EXPECT_EQ(now.frozen, rests) << k;
      for (int i = 0; i < int(rests.size()); ++i) {
        EXPECT_EQ(now.x[i], Vec<D>(s * want.x[i])) << i << ", 2^" << k;
        EXPECT_EQ(now.v[i], Vec<D>(s * want.v[i])) << i << ", 2^" << k;
        EXPECT_EQ(now.spin[i], want.spin[i]) << i << ", 2^" << k;
      }
    }
  });
}

// speeds of 1e9 m/s and gaps of 1e9 m too: they once meant that there is no contact
TEST(Rest, ARoomOfAMillionMillionMetresBouncesAlike) {
  World<2> world = touching_room();
  world.model.solver = Solver::iterative;
  add_walls(world, 4, 4);
  add_ball(world, 0.1, 0.5, {2.3, 3}, {1, 0}, 0, 0.5);
  add_box(world, {0.5, 0.3}, 0.7, {2.2, 1}, {0, 0}, std::numbers::pi / 6, 0, 0.8);
  rub(world, 0.5);
  const State<2> want = stepped(world, 600);
  for (const int k : {20, 28, 30, 38}) {
    const State<2> now = stepped(scaled(world, k), 600);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(now.x[i], Vec2(std::ldexp(1.0, k) * want.x[i])) << i << ", 2^" << k;
      EXPECT_EQ(now.turn[i], want.turn[i]) << i << ", 2^" << k;
    }
  }
}

TEST(Rest, WithoutGravityWhatDoesNotMoveAtAllRests) {
  each([](auto d, Solver solver) {
    constexpr int D = d;
    World<D> world = quiet_room<D>(solver, 0);
    for (int i = 0; i < 3; ++i)
      add<D>(world, block<D>(0.2, 0.1), at<D>(0.5 * i, 1), at<D>(0, i == 1 ? 1e-9 : 0), 0.5);
    const State<D> now = stepped(world, 300);
    EXPECT_EQ(now.frozen, (std::vector<char>{1, 0, 1}));
  });
}

// --- what contacts and joints leave free

template <int D>
BearingContact<D> touch(int a, int b, Vec<D> normal, Vec<D> arm_a, double mu, double force,
                        Vec<D> arm_b = Vec<D>::Zero()) {
  return {.a = a,
          .b = b,
          .normal = normal,
          .arm_a = arm_a,
          .arm_b = arm_b,
          .friction = mu,
          .force = force * normal};
}

TEST(Mobility, ABallOnTheFloorRollsFreelyAndDoesNotSlip) {
  World<3> world = quiet_room<3>(Solver::iterative, kG);
  add<3>(world, round_shape<3>(0.1), {0, 0.1, 0}, {0, 0, 0}, 0.5);
  Mobility<3> mobility(world.model);
  const auto moves = [&](const Vec3& v, const Vec3& w, double mu) {
    mobility.clear();
    mobility.add(0, v, w, Rotation<3>::Identity());
    mobility.add_contact(touch<3>(0, -1, {0, 1, 0}, {0, -0.1, 0}, mu, kG));
    return mobility.mobile();
  };
  EXPECT_EQ(moves({0.01, 0, 0}, {0, 0, -0.1}, 0.5), Mobile::yes);
  EXPECT_EQ(moves({0, 0, 0}, {0, 0.1, 0}, 0.5), Mobile::yes);
  EXPECT_EQ(moves({0, 0.01, 0}, {0, 0, 0}, 0.5), Mobile::no);
  EXPECT_EQ(moves({0.01, 0, 0}, {0, 0, 0}, 0), Mobile::yes);
  // what the point on the floor does friction takes: v + w x r along the floor, and of the ball I / (I + m
  // r^2) of its turn
  EXPECT_EQ(moves({0.01, 0, 0}, {0, 0, 0.25}, 0.5), Mobile::no);
  EXPECT_EQ(moves({0.01, 0, 0}, {0, 0, 0.26}, 0.5), Mobile::yes);
}

// --- islands, timers and waking, for all solvers alike

// blocks side by side, of which these touch
template <int D>
World<D> blocks_that_touch(int count, const std::vector<std::pair<int, int>>& pairs) {
  World<D> world = quiet_room<D>(Solver::iterative, kG);
  for (int i = 0; i < count; ++i) add<D>(world, block<D>(0.2, 0.2), at<D>(0.2 * i, 0.1), at<D>(0, 0), 0.5);
  for (const auto& [a, b] : pairs) {
    Contact<D> contact;
    contact.key = {a, b, 0}, contact.normal = at<D>(-1, 0), contact.point = at<D>(0.2 * a + 0.1, 0.1);
    world.state.contacts.push_back(contact);
  }
  world.state.frozen.assign(std::size_t(count), 0), world.state.quiet.assign(std::size_t(count), 1.0);
  return world;
}

// the bodies of each candidate
template <int D>
std::vector<std::vector<int>> candidates(Sleep<D>& sleep, const State<D>& state) {
  std::vector<std::vector<int>> all;
  for (const auto& island : sleep.candidates(state))
    all.emplace_back(island.bodies.begin(), island.bodies.end());
  return all;
}

using Bodies = std::vector<std::vector<int>>;

template <class Dimension>
class SleepIn : public testing::Test {};
using RestDimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(SleepIn, RestDimensions);

TYPED_TEST(SleepIn, AnIslandIsAskedOnceAllOfItHasBeenQuiet) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(4, {{0, 1}, {1, 2}});
  Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{0, 1, 2}, {3}}));
  world.state.quiet[2] = 0.9 * kWait;
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{3}}));
  world.state.contacts[1].gap = 0.01;  // apart, and it bears nothing
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{0, 1}, {3}}));
  world.state.contacts[1].touching = ContactMode::slide;
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{3}}));
}

// what sleeps is as the floor: it joins no islands
TYPED_TEST(SleepIn, WhatSleepsDoesNotJoinThoseBesideIt) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(3, {{0, 1}, {1, 2}});
  world.state.frozen[1] = 1, world.state.quiet[2] = 0;
  Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{0}}));
}

TYPED_TEST(SleepIn, HandsAndDeepOverlapsKeepAnIslandAwake) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(4, {{0, 1}, {2, 3}});
  Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated, 1e-3);
  world.state.grips.push_back({1, at<D>(0, 0)});
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{2, 3}}));
  world.state.contacts[1].gap = -1.1e-3 * bounding_radius(world.model.bodies[2].shape);
  EXPECT_EQ(candidates(sleep, world.state), Bodies{});
  world.state.contacts[1].gap = -0.9e-3 * bounding_radius(world.model.bodies[2].shape);
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{2, 3}}));
}

// by springs the iterative solvers find no forces; the exact solver does
TYPED_TEST(SleepIn, ASpringKeepsAwakeWhereForcesKnowNothingOfIt) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(3, {});
  Spring<D> spring;
  spring.a.body = 0, spring.b.body = 1;
  world.model.springs.push_back(spring);
  world.state.quiet.assign(3, kWait);
  Sleep<D> iterated(world.model, Sleep<D>::Forces::iterated), exact(world.model, Sleep<D>::Forces::exact);
  EXPECT_EQ(candidates(iterated, world.state), (Bodies{{2}}));
  EXPECT_EQ(candidates(exact, world.state), (Bodies{{0, 1}, {2}}));
}

// trials leave other forces behind
TYPED_TEST(SleepIn, WhatHangsOnJointsIsAskedOnceAWait) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(2, {});
  Joint<D> joint;
  joint.kind = JointKind::rod, joint.a.body = 0, joint.b.body = -1;
  world.model.joints.push_back(joint), world.state.broken.push_back(0);
  Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
  const double span = 1.0 / 60;
  for (const double quiet : {kWait, 1.5 * kWait, 2 * kWait + 0.5 * span, 2 * kWait + 1.5 * span}) {
    world.state.quiet.assign(2, quiet);
    const bool asked = std::fmod(quiet, kWait) < span;
    EXPECT_EQ(candidates(sleep, world.state), asked ? (Bodies{{0}, {1}}) : (Bodies{{1}})) << quiet;
  }
  world.state.broken[0] = 1;
  EXPECT_EQ(candidates(sleep, world.state), (Bodies{{0}, {1}}));
}

// they take long to find for all that moves
TYPED_TEST(SleepIn, ByExactForcesAnIslandIsAskedOnceAWait) {
  constexpr int D = TypeParam::value;
  World<D> world = blocks_that_touch<D>(2, {{0, 1}});
  Sleep<D> sleep(world.model, Sleep<D>::Forces::exact);
  const double step = 1.0 / 600;
  for (const double quiet :
       {kWait - step, kWait, kWait + 1.5 * step, 2 * kWait - 0.5 * step, 2 * kWait + 0.5 * step}) {
    world.state.quiet.assign(2, quiet);
    const bool asked = quiet >= kWait && std::fmod(quiet, kWait) < step;
    EXPECT_EQ(candidates(sleep, world.state), asked ? (Bodies{{0, 1}}) : Bodies{}) << quiet / kWait;
  }
}

// a block on the floor, of which nothing is known but where it touches
template <int D>
World<D> block_on_floor() {
  World<D> world = blocks_that_touch<D>(1, {});
  for (const double x : {-0.1, 0.1}) {
    for (const double z : {-0.1, 0.1}) {
      if (D == 2 && z > 0) continue;
      Contact<D> contact;
      contact.key = {0, -1, int(world.state.contacts.size())};
      contact.normal = at<D>(0, 1), contact.point = at<D>(x, 0, z);
      world.state.contacts.push_back(contact);
    }
  }
  return world;
}

TYPED_TEST(SleepIn, WhatIsInEquilibriumAndHeldIsSetAtRestWithItsForces) {
  constexpr int D = TypeParam::value;
  // the solver's forces do not hold it, or do: then they stay
  for (const double residual : {kG, 2e-6 * kG, 0.5e-6 * kG}) {
    World<D> world = block_on_floor<D>();
    State<D>& state = world.state;
    const double weight = residual > 1e-6 * kG ? kG : 0.9 * kG;
    for (Contact<D>& contact : state.contacts) contact.force = at<D>(0, 0.9 * kG / (D == 2 ? 2 : 4));
    Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
    const auto islands = sleep.candidates(state);
    ASSERT_EQ(islands.size(), 1u);
    islands[0].residual = residual;
    EXPECT_TRUE(sleep.put_to_sleep(state));
    EXPECT_TRUE(state.frozen[0]);
    double bears = 0;
    for (const Contact<D>& contact : state.contacts) bears += contact.force[1];
    EXPECT_NEAR(bears, weight, 1e-9 * kG) << residual;
  }
}

// after one wait, two, four, ...
TYPED_TEST(SleepIn, ExactForcesAreLookedForLessAndLessOften) {
  constexpr int D = TypeParam::value;
  World<D> world = block_on_floor<D>();
  Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
  for (const double waits : {1.0, 1.5, 2.0, 3.0, 4.0}) {
    State<D> state = world.state;
    state.quiet[0] = waits * kWait;
    sleep.candidates(state)[0].residual = kG;
    EXPECT_EQ(sleep.put_to_sleep(state), waits != 1.5 && waits != 3) << waits;
  }
}

TYPED_TEST(SleepIn, WhatItsContactsDoNotHoldGoesOn) {
  constexpr int D = TypeParam::value;
  for (const double mu : {0.0, 0.5}) {
    World<D> world = block_on_floor<D>();
    world.model.bodies[0].friction = mu;
    State<D>& state = world.state;
    state.v[0] = at<D>(1e-3, 0);
    for (Contact<D>& contact : state.contacts) contact.force = at<D>(0, kG / (D == 2 ? 2 : 4));
    Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
    sleep.candidates(state)[0].residual = 0;
    EXPECT_EQ(sleep.put_to_sleep(state), mu > 0) << mu;
    EXPECT_EQ(state.v[0][0], mu > 0 ? 0 : 1e-3) << mu;
  }
}

TYPED_TEST(SleepIn, ARowOfAJointHoldsToo) {
  constexpr int D = TypeParam::value;
  for (const bool held : {false, true}) {
    World<D> world = block_on_floor<D>();
    world.model.bodies[0].friction = 0;
    State<D>& state = world.state;
    state.v[0] = at<D>(1e-3, 0);
    for (Contact<D>& contact : state.contacts) contact.force = at<D>(0, kG / (D == 2 ? 2 : 4));
    Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
    const auto islands = sleep.candidates(state);
    islands[0].residual = 0;
    Row<D> row;
    row.a = 0, row.along = at<D>(1, 0);
    if (held) sleep.add_joint_row(islands[0], row, std::numeric_limits<double>::infinity());
    EXPECT_EQ(sleep.put_to_sleep(state), held);
  }
}

//   gap < span (v + w R) + g span (span + h) / 2
TYPED_TEST(SleepIn, AnIslandWakesWhenSomethingAwakeComesWithinReach) {
  constexpr int D = TypeParam::value;
  const double span = 0.01, h = 0.002, v = 0.3, w = 0.7;
  for (const double more : {-1e-9, 1e-9}) {
    World<D> world = blocks_that_touch<D>(4, {{0, 1}, {1, 2}});
    world.state.frozen = {1, 1, 0, 1}, world.state.quiet.assign(4, 0.0);
    world.state.v[2] = at<D>(-v, 0), world.state.spin[2] = about_z<D>(w);
    const double radius = bounding_radius(world.model.bodies[2].shape);
    world.state.contacts[1].gap =
        Sleep<D>::kSooner * span * (v + w * radius) + 0.5 * kG * span * (span + h) + more;
    Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
    EXPECT_EQ(sleep.wake(world.state, world.state.contacts, span, h), more < 0);
    const char asleep = more < 0 ? 0 : 1;
    EXPECT_EQ(world.state.frozen, (std::vector<char>{asleep, asleep, 0, 1}));
  }
}

// two that lie side by side, one of them not yet asleep
TYPED_TEST(SleepIn, WhatIsQuietWakesOnlyWhatItComesNearerTo) {
  constexpr int D = TypeParam::value;
  for (const double v : {-0.01, 0.0, 0.01}) {
    World<D> world = blocks_that_touch<D>(2, {{0, 1}});
    world.state.frozen = {1, 0}, world.state.v[1] = at<D>(v, 0);
    world.state.contacts[0].gap = 3e-4;
    Sleep<D> sleep(world.model, Sleep<D>::Forces::iterated);
    EXPECT_EQ(sleep.wake(world.state, world.state.contacts, 0.1, 0.01), v < 0) << v;
  }
}

}  // namespace
}  // namespace obscura::sim
