// Runs that cannot go on say so, with the body and the likely cause; the others are left alone.

#include "sim/model/trouble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "sim/energy/divergence_monitor.h"
#include "sim/jointed.h"
#include "sim/math/limits.h"
#include "sim/motion/stability.h"
#include "sim/rooms.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

using testing::HasSubstr;

std::optional<Trouble> trouble(const World<2>& world, Rational until) {
  const auto all = run(world);
  auto answer = all->at(until);
  const auto* found = std::get_if<Trouble>(&answer);
  if (!found) return {};
  // it stays the answer
  auto again = all->at(until);
  EXPECT_EQ(std::get<Trouble>(again).what, found->what);
  EXPECT_EQ(std::get<Trouble>(again).time, found->time);
  return *found;
}

TEST(Runaway, SeesWhatIsTooLargeOrNoNumber) {
  EXPECT_GE(within(5.0, 5.0), 0);
  EXPECT_GE(within(-5.0, 5.0), 0);
  EXPECT_GE(within(0.0, 0.0), 0);
  EXPECT_LT(within(std::nextafter(5.0, 6.0), 5.0), 0);
  EXPECT_LT(within(-5.1, 5.0), 0);
  for (const double x :
       {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_LT(within(x, 1e300), 0);
  }
}

// a particle in a closed room on a spring of k = 4000 about its middle
World<2> stiff(int rate, Integrator integrator = Integrator::rk4) {
  World<2> world = room();
  world.model.rate = {rate, 1};
  world.model.integrator = integrator;
  add_walls(world, 4, 3);
  add_particle(world, {1.5, 1.2}, {0, 0}, 0.1);
  world.model.bodies[0].name = "ball";
  add_spring(world, {-1, {2, 1.5}}, {0, {0, 0}}, 4000, 0.1);
  return world;
}

TEST(Trouble, OfAnUnstableSpringInAClosedRoomNamesTheStep) {
  // 2.828 sqrt(0.1/4000) = 0.01414 s
  const auto found = trouble(stiff(60), {20, 1});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->body, "ball");
  EXPECT_EQ(found->quantity, "energy");
  EXPECT_THAT(found->likely, HasSubstr("1/60 s is longer than 2.828 sqrt(m/k) = 0.0141 s of spring[0]"));
  EXPECT_THAT(found->likely, HasSubstr("above 71"));
  EXPECT_GT(found->time, 0);
  EXPECT_LT(found->time, 2);
  EXPECT_FALSE(trouble(stiff(72), {60, 1}));
}

TEST(Trouble, OfAnUnstableSpringInTheOpenIsRunaway) {
  World<2> world = stiff(60);
  world.model.walls.clear();
  const auto found = trouble(world, {20, 1});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->likely, HasSubstr("2.828"));
}

TEST(Trouble, OfEveryStartThatIsUnstable) {
  // near the middle and far from it, elastic walls and soft ones
  for (const double x : {0.3, 1.0, 1.8}) {
    for (const double e : {0.2, 1.0}) {
      for (const int rate : {30, 50, 60}) {
        World<2> world = stiff(rate);
        world.state.x[0][0] = x;
        world.model.bodies[0].elasticity = e;
        EXPECT_TRUE(trouble(world, {30, 1})) << x << ' ' << e << ' ' << rate;
      }
    }
  }
}

TEST(Trouble, OfAMouseNamesTheMouse) {
  World<2> world = room();
  world.model.rate = {60, 1};
  add_walls(world, 4, 3);
  add_box(world, {0.4, 0.4}, 1, {2, 1.5});
  world.model.mice.push_back({{{{1, 1}, {2.5, 1.6}}, {{20, 1}, {1, 2}}}, 0.1, 20000, 0});
  const auto found = trouble(world, {20, 1});
  ASSERT_TRUE(found);
  EXPECT_GT(found->time, 1);
  EXPECT_THAT(found->likely, HasSubstr("mouse[0]"));
}

TEST(Trouble, OfANumberThatIsNone) {
  World<2> world = room();
  add_particle(world, {0, 0});
  add_particle(world, {0, 0}, {std::nan(""), 0});
  const auto found = trouble(world, {1, 1});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->body, "particle[1]");
  EXPECT_EQ(found->what, "is not a number");
  EXPECT_EQ(found->time, 0) << "it is none from the start";
}

TEST(Trouble, OfASpinThatIsNone) {
  World<2> world = room();
  add_box(world, {1, 1}, 1, {0, 0}, {0, 0}, 0, std::numeric_limits<double>::infinity());
  const auto found = trouble(world, {1, 1});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->quantity, "spin");
}

TEST(Trouble, OfWhatFallsForEver) {
  World<2> world = room();
  world.model.rate = {10, 1};
  world.model.scale = 0.01;
  add_particle(world, {0, 0});
  const auto found = trouble(world, {1000, 1});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->quantity, "position");
  EXPECT_THAT(found->what, HasSubstr("grew past"));
  EXPECT_THAT(found->likely, HasSubstr("no walls"));
  EXPECT_NEAR(found->time, std::sqrt(2 * 1e4 / 9.81), 0.2);
}

TEST(Trouble, IsNotWhatIsOnlyLively) {
  // a heavy ball on a soft spring bounces for a minute, thrown by a quick hand
  World<2> world = room();
  world.model.rate = {600, 1};
  add_walls(world, 4, 3);
  for (int i = 0; i < 10; ++i) add_particle(world, {0.3 + 0.3 * i, 2}, {9.0 - i, 1}, 5, 1);
  for (int i = 0; i + 1 < 10; ++i) add_spring(world, {i, {0, 0}}, {i + 1, {0, 0}}, 200, 0.1);
  Mouse<2> mouse{{}, 0.1, 100, 0};
  for (int i = 0; i <= 100; ++i)
    mouse.path.push_back({rational(i, 2), {2 + 1.5 * (i % 2), 1.0 + 0.5 * (i % 3)}});
  world.model.mice.push_back(mouse);
  EXPECT_FALSE(trouble(world, {60, 1}));
  EXPECT_TRUE(stability_warnings(world.model).empty());
}

TEST(Trouble, IsNotASpringAtRest) {
  World<2> world = room({0, 0});
  add_particle(world, {0.1, 0.2});
  add_spring(world, {0, {0, 0}}, {-1, {0.4, 0.6}}, 1000, 0.5);
  EXPECT_FALSE(trouble(world, {60, 1}));
}

TEST(Trouble, IsNotAFallOfAThousandRoomHeights) {
  World<2> world = room();
  add_particle(world, {0, 0});
  add_particle(world, {0, 1});
  add_spring(world, {0, {0, 0}}, {1, {0, 0}}, 10, 0.5);
  EXPECT_FALSE(trouble(world, {30, 1}));
}

// ---- the limits behind it

Tightness oscillator(double w2, double g) {
  Tightness t;
  t.body = 0, t.stiffness = w2, t.damping = g;
  return t;
}

TEST(LongestStep, IsTheIntegratorsLimit) {
  const double w = 10;
  EXPECT_NEAR(longest_step(Integrator::rk4, oscillator(w * w, 0), 1), std::sqrt(8) / w, 1e-9);
  EXPECT_NEAR(longest_step(Integrator::semi_implicit, oscillator(w * w, 0), 1), 2 / w, 1e-9);
  // drag alone: the real axis
  EXPECT_NEAR(longest_step(Integrator::rk4, oscillator(0, 50), 1), 2.7852935634052816 / 50, 1e-9);
  EXPECT_NEAR(longest_step(Integrator::midpoint, oscillator(0, 50), 1), 2.0 / 50, 1e-3);
  EXPECT_NEAR(longest_step(Integrator::euler, oscillator(0, 50), 1), 2.0 / 50, 1e-3);
  // short enough: the step itself
  EXPECT_EQ(longest_step(Integrator::rk4, oscillator(w * w, 0), 0.1), 0.1);
  // Euler grows by (h w)^2 / 2 a step: a factor e in a second at h = 2 / w^2
  EXPECT_NEAR(longest_step(Integrator::euler, oscillator(w * w, 0), 1), 2 / (w * w), 1e-9);
}

TEST(LongestStep, IsWhereAnOscillatorBeginsToGrow) {
  for (const auto integrator : {Integrator::rk4, Integrator::semi_implicit}) {
    for (const double c : {0.0, 5.0, 60.0}) {
      const double limit = longest_step(integrator, oscillator(100, c), 1);
      for (const double times : {0.99, 1.01}) {
        World<2> world = room({0, 0});
        world.model.integrator = integrator;
        world.model.rate = *from_double(std::round(1e6 / (times * limit)) / 1e6);
        add_particle(world, {1e-3, 0});
        add_spring(world, {0, {0, 0}}, {-1, {0, 0}}, 100, 0, c);
        world.model.scale = 1e6;  // let it grow
        State<2> state = world.state;
        Stepper<2> stepper(world.model);
        stepper.begin(state);
        for (int i = 0; i < 3000 && std::fabs(state.x[0].x()) < 1; ++i) ASSERT_FALSE(stepper.step(state));
        const double late = std::fabs(state.x[0].x());
        EXPECT_EQ(late > 1e-2, times > 1) << int(integrator) << ' ' << c << ' ' << times;
      }
    }
  }
}

TEST(Foreboding, IsNoneWhereTheStepIsShortEnough) {
  EXPECT_TRUE(stability_warnings(stiff(72).model).empty());
  EXPECT_FALSE(stability_warnings(stiff(70).model).empty());
}

TEST(Foreboding, NamesBodySpringAndRate) {
  const auto all = stability_warnings(stiff(60).model);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].body, "ball");
  EXPECT_THAT(all[0].likely, HasSubstr("spring[0] on ball: raise physics.rate above 71"));
}

TEST(Foreboding, OfWhatNoRateCanFollowNamesNone) {
  World<2> world = stiff(60);
  world.model.springs[0].stiffness = 1e36;
  const auto all = stability_warnings(world.model);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_THAT(all[0].likely, HasSubstr("spring[0] on ball: it is too stiff for any physics.rate"));
}

TEST(Foreboding, TakesAQuarterOfTheMassAtASquaresCorner) {
  for (const auto& [local, rate] : {std::pair{Vec2(0, 0), 36}, {Vec2(0.2, 0.2), 71}}) {
    // m = 0.4: 2.828 sqrt(0.4/4000) = 0.0283 at the centre, half of it at the corner
    World<2> world = room();
    add_box(world, {0.4, 0.4}, 0.4, {0, 0});
    add_spring(world, {0, local}, {-1, {2, 2}}, 4000, 0.1);
    world.model.rate = {rate - 1, 1};
    EXPECT_FALSE(stability_warnings(world.model).empty()) << rate;
    world.model.rate = {rate, 1};
    EXPECT_TRUE(stability_warnings(world.model).empty()) << rate;
  }
}

TEST(Foreboding, AddsTheSpringsOfABody) {
  World<2> world = stiff(80);
  EXPECT_TRUE(stability_warnings(world.model).empty());
  add_spring(world, {0, {0, 0}}, {-1, {1, 1}}, 4000, 0.1);  // sqrt(2) less: 1/101 would do
  ASSERT_EQ(stability_warnings(world.model).size(), 1u);
  EXPECT_THAT(stability_warnings(world.model)[0].likely, HasSubstr("2 springs"));
  EXPECT_THAT(stability_warnings(world.model)[0].likely, HasSubstr("above 100"));
}

// A damped spring on a slider makes its own box diverge, c/m = 1e4 1/s where Runge-Kutta stands 2.785/h;
// beside it an ordinary spring is too stiff too, and bears up longer.
TEST(Foreboding, WhatTheSpringOfAJointDoesIsNotLaidToAnotherSpring) {
  World<2> world = touching_room();
  world.model.solver = Solver::direct;
  add_particle(world, {0, 0}, {0, 0}, 0.01);
  add_spring(world, {0, {0, 0}}, {-1, {0, 1}}, 1000, 1, 30);
  add_box(world, {0.2, 0.2}, 1, {2, 0});
  Joint<2> rail;
  rail.kind = JointKind::slider, rail.name = "rail", rail.a = {1, {0, 0}}, rail.b = {-1, {2, 0}};
  rail.axis = {0, 1}, rail.coil = Joint<2>::Coil{1e5, 1e4, 0};
  world.model.joints = {rail};
  DivergenceMonitor<2> monitor(world.model, {});
  State<2> state = world.state;
  state.v[1] = {0, 1e9};
  const auto trouble = monitor.check_bounds(state, 1);
  ASSERT_TRUE(trouble);
  EXPECT_THAT(trouble->likely, HasSubstr("of the spring of rail on"));
  EXPECT_THAT(trouble->likely, HasSubstr("raise physics.rate above 3587"));
}

TEST(Foreboding, LooksAtTheMice) {
  World<2> world = room();
  world.model.rate = {60, 1};
  add_particle(world, {0, 0}, {0, 0}, 0.1);
  world.model.mice.push_back({{{{1, 1}, {0, 0}}, {{2, 1}, {1, 0}}}, 0.1, 4000, 0});
  ASSERT_EQ(stability_warnings(world.model).size(), 1u);
  EXPECT_THAT(stability_warnings(world.model)[0].likely, HasSubstr("mouse[0]"));
}

TEST(Foreboding, LooksAtDashpotsAndDrag) {
  World<2> world = room();
  world.model.rate = {60, 1};
  add_particle(world, {0, 0}, {0, 0}, 0.01);
  world.model.bodies[0].drag = 5;  // 2.785 m / c = 0.0056 s
  ASSERT_EQ(stability_warnings(world.model).size(), 1u);
  EXPECT_THAT(stability_warnings(world.model)[0].likely, HasSubstr("of the drag"));
  EXPECT_THAT(stability_warnings(world.model)[0].likely, HasSubstr("above 180"));
}

// Ten rods a metre long, with a million kilograms at their end: plucked, they swing at 5,000 rad/s, which no
// step of 1/600 s follows.
TEST(Trouble, OfJointsThatDoNotHoldNamesTheJoint) {
  for (const Solver solver : {Solver::direct, Solver::iterative}) {
    World<2> world = touching_room();
    world.model.solver = solver;
    for (int i = 0; i < 10; ++i) {
      const Vec2 x(0, -(i + 0.5));
      add_box(world, {0.05, 1}, i < 9 ? 0.1 : 1e6, x, {i == 4 ? 3.0 : 0.0, 0});
      Joint<2> joint = pin({i, {0, 0.5}}, {i - 1, i == 0 ? Vec2(0, 0) : Vec2(0, -0.5)});
      joint.name = "joint[" + std::to_string(i) + "]";
      world.model.joints.push_back(joint);
    }
    world.model.ignore.emplace_back(0, 0);
    const auto found = trouble(world, {2, 1});
    ASSERT_TRUE(found);
    EXPECT_THAT(found->likely, HasSubstr("raise physics.rate"));
  }
}

}  // namespace
}  // namespace obscura::sim
