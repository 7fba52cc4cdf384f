// The scripted hand: its way, what it takes, when it takes it and lets go.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/force/mouse.h"
#include "sim/model/path.h"
#include "sim/model/script.h"
#include "sim/rooms.h"

namespace obscura::sim {
namespace {

std::vector<Knot<2>> bent() {
  return {{{1, 1}, {0, 0}}, {{3, 2}, {1, 0}}, {{2, 1}, {1, 2}}, {{4, 1}, {0, 1}}};
}

TEST(Path, GoesThroughItsKnots) {
  const Path<2> path(bent());
  for (const auto& knot : bent()) EXPECT_LT((path.place(value(knot.time)) - knot.place).norm(), 1e-15);
  EXPECT_EQ(path.place(0), Vec2(0, 0));
  EXPECT_EQ(path.place(9), Vec2(0, 1));
}

TEST(Path, HasNoCornerAtAKnot) {
  const Path<2> path(bent());
  for (const double t : {1.5, 2.0}) {
    EXPECT_LT((path.at(t - 1e-9).velocity - path.at(t + 1e-9).velocity).norm(), 1e-7);
  }
}

TEST(Path, MovesWithTheVelocityItSays) {
  const Path<2> path(bent());
  for (const double t : {1.1, 1.4, 1.7, 2.3, 3.0, 3.9}) {
    const double h = 1e-5;
    const Vec2 slope = (path.place(t + h) - path.place(t - h)) / (2 * h);
    EXPECT_LT((path.at(t).velocity - slope).norm(), 1e-8);
  }
}

TEST(Path, OfAParabolaIsThatParabola) {
  std::vector<Knot<2>> knots;
  const auto at = [](double t) { return Vec2(1 + 2 * t - t * t, 3 * t * t); };
  for (const Rational t : {Rational{0, 1}, {1, 4}, {1, 1}, {3, 2}}) knots.push_back({t, at(value(t))});
  const Path<2> path(knots);
  for (double t = 0; t <= 1.5; t += 0.01) EXPECT_LT((path.place(t) - at(t)).norm(), 1e-14);
}

TEST(Path, OfTwoKnotsIsAStraightLine) {
  const Path<2> path({{{1, 1}, {0, 1}}, {{3, 1}, {4, 3}}});
  EXPECT_LT((path.place(1.5) - Vec2(1, 1.5)).norm(), 1e-15);
  EXPECT_EQ(path.at(1.5).velocity, Vec2(2, 1));
}

TEST(Grip, TakesCornersOfPolygonsAndParts) {
  World<2> world = room();
  const int stone = add_box(world, {1, 1}, 1, {2, 2}, {0, 0}, std::acos(-1) / 2);
  Shape<2>& shape = world.model.bodies[stone].shape;
  shape = Polygon{{{-0.4, -0.2}, {0.6, -0.2}, {-0.2, 0.4}}};
  EXPECT_EQ(closest<2>(world.model, world.state, {2.2, 3}).local, Vec2(0.6, -0.2));
  shape = Compound<2>{{shape, Ball<2>{0, {1, 0}}}};
  EXPECT_EQ(closest<2>(world.model, world.state, {2, 3.1}).local, Vec2(1, 0));
  EXPECT_EQ(closest<2>(world.model, world.state, {1.5, 1.7}).local, Vec2(-0.2, 0.4));
}

TEST(Grip, TakesTheClosestParticleOrCorner) {
  World<2> world = room();
  add_particle(world, {0, 0});
  add_particle(world, {2, 0});
  add_box(world, {1, 0.5}, 1, {4, 0}, {0, 0}, std::acos(-1) / 2);
  EXPECT_EQ(closest<2>(world.model, world.state, {0.9, 0}).body, 0);
  EXPECT_EQ(closest<2>(world.model, world.state, {1.1, 0}).body, 1);
  const auto grip = closest<2>(world.model, world.state, {3.8, 0.4});  // the corner at (3.75, 0.5)
  EXPECT_EQ(grip.body, 2);
  EXPECT_EQ(grip.local, Vec2(0.5, 0.25));
}

TEST(Grip, GoesToTheLowerOfEquals) {
  World<2> world = room();
  add_particle(world, {-1, 0});
  add_particle(world, {1, 0});
  EXPECT_EQ(closest<2>(world.model, world.state, {0, 0}).body, 0);
  World<2> box = room();
  add_box(box, {1, 0.5}, 1, {0, 0});
  EXPECT_EQ(closest<2>(box.model, box.state, {0, 0}).local, Vec2(-0.5, -0.25)) << "the first corner";
}

TEST(Grip, LeavesWhatIsFixed) {
  World<2> world = room();
  add_particle(world, {0, 0});
  add_particle(world, {9, 0});
  world.model.bodies[0].fixed = true;
  EXPECT_EQ(closest<2>(world.model, world.state, {0, 0}).body, 1);
  world.model.bodies[1].fixed = true;
  EXPECT_EQ(closest<2>(world.model, world.state, {0, 0}).body, -1);
}

// a hand that rests at `place` from t = press to release
Mouse<2> resting(Rational press, Rational release, Vec2 place, double k, double rest) {
  return {{{press, place}, {release, place}}, rest, k, 0};
}

TEST(Mouse, ThatRestsIsASpringToThatPlace) {
  World<2> by_hand = room(), by_spring = room();
  add_box(by_hand, {1, 0.5}, 2, {0, 0}), add_box(by_spring, {1, 0.5}, 2, {0, 0});
  by_hand.model.mice.push_back(resting({0, 1}, {5, 1}, {0.8, 1.5}, 30, 0.2));
  add_spring(by_spring, {0, {0.5, 0.25}}, {-1, {0.8, 1.5}}, 30, 0.2);
  const auto a = stepped(by_hand, 1000), b = stepped(by_spring, 1000);
  EXPECT_EQ(a.x[0], b.x[0]);
  EXPECT_EQ(a.turn[0], b.turn[0]);
  EXPECT_EQ(a.spin[0], b.spin[0]);
}

TEST(Mouse, TakesOnceAndHoldsUntilReleased) {
  World<2> world = room({0, 0});
  add_particle(world, {0, 0});
  add_particle(world, {1, 0}, {0, 0});
  // takes particle 0, then moves on over particle 1
  world.model.mice.push_back({{{{1, 10}, {0.1, 0}}, {{2, 10}, {0.9, 0}}, {{3, 10}, {1.2, 0}}}, 0, 5, 0});
  const auto all = run(world);
  EXPECT_FALSE(shown(*all, {99, 1000}).mice[0].pressed);
  EXPECT_EQ(shown(*all, {99, 1000}).mice[0].body, -1);
  const auto pressed = shown(*all, {1, 10});
  EXPECT_TRUE(pressed.mice[0].pressed);
  EXPECT_EQ(pressed.mice[0].body, 0);
  EXPECT_LT((pressed.mice[0].pointer - Vec3(0.1, 0, 0)).norm(), 1e-15);
  const auto held = shown(*all, {299, 1000});
  EXPECT_EQ(held.mice[0].body, 0);
  EXPECT_EQ(held.mice[0].held, held.bodies[0].position);
  EXPECT_GT(held.energies.hand, 0);
  const auto let_go = shown(*all, {3, 10});
  EXPECT_FALSE(let_go.mice[0].pressed);
  EXPECT_EQ(let_go.mice[0].body, -1);
  EXPECT_EQ(let_go.energies.hand, 0);
  const Vec3 v = let_go.bodies[0].velocity;
  EXPECT_GT(v.x(), 0);
  EXPECT_EQ(shown(*all, {1, 1}).bodies[0].velocity, v) << "free again";
  EXPECT_EQ(shown(*all, {1, 1}).bodies[1].position, Vec3(1, 0, 0));
}

TEST(Mouse, SeveralAtOnceAddUp) {
  World<2> two = room({0, 0}), one = room({0, 0});
  add_particle(two, {1, 0}), add_particle(one, {1, 0});
  two.model.mice.push_back(resting({0, 1}, {5, 1}, {0, 0}, 10, 0));
  two.model.mice.push_back(resting({0, 1}, {5, 1}, {0, 0}, 20, 0));
  one.model.mice.push_back(resting({0, 1}, {5, 1}, {0, 0}, 30, 0));
  EXPECT_LT((stepped(two, 1000).x[0] - stepped(one, 1000).x[0]).norm(), 1e-13);
}

TEST(Mouse, WithNothingToTakeHoldsNothing) {
  World<2> world = room();
  add_particle(world, {0, 0});
  world.model.bodies[0].fixed = true;
  world.model.mice.push_back(resting({0, 1}, {1, 1}, {1, 1}, 10, 0));
  const auto now = shown(*run(world), {1, 2});
  EXPECT_TRUE(now.mice[0].pressed);
  EXPECT_EQ(now.mice[0].body, -1);
  EXPECT_EQ(now.bodies[0].position, Vec3::Zero());
}

TEST(Mouse, DampsByItsOwnMotion) {
  // a dashpot alone drags the particle after the hand: dv/dt = -c (v - u) / m along the line
  World<2> world = room({0, 0});
  add_particle(world, {-1, 0});
  world.model.mice.push_back({{{{0, 1}, {0, 0}}, {{2, 1}, {6, 0}}}, 0, 0, 2});
  const auto now = shown(*run(world), {1, 1});
  EXPECT_NEAR(now.bodies[0].velocity.x(), 3 * (1 - std::exp(-2)), 1e-12);
}

TEST(Mouse, IsSampledEquallyInTime) {
  World<2> world = room();
  add_particle(world, {0, 0});
  world.model.mice.push_back({bent(), 0.1, 10, 0});
  const auto all = run(world);
  const auto& mouse = all->scene_info().mice[0];
  EXPECT_EQ(mouse.press, 1);
  EXPECT_EQ(mouse.release, 4);
  ASSERT_EQ(mouse.path.size(), 181u);
  EXPECT_LT((mouse.path[30] - Vec3(1, 0, 0)).norm(), 1e-14) << "at t = 1.5";
  EXPECT_LT((mouse.path[180] - Vec3(0, 1, 0)).norm(), 1e-15);
}

// ---- the script's clock

TEST(TimeStamp, IsExact) {
  EXPECT_EQ(time_stamp({1, 3}, {600, 1}), (TimeStamp{200, 0}));
  EXPECT_EQ(time_stamp({1001, 30000}, {600, 1}).step, 20);
  EXPECT_DOUBLE_EQ(time_stamp({1001, 30000}, {600, 1}).fraction, 0.02);
  // 5/3 of a nanosecond short of step 10^15: a double would be on it
  const auto late = time_stamp({2999999999999999, 3000000000}, {1000000000, 1});
  EXPECT_EQ(late.step, 999999999999999);
  EXPECT_NEAR(late.fraction, 2.0 / 3, 1e-15);
  // the products do not fit 64 bits
  EXPECT_EQ(time_stamp({9000000000000000001, 1000000000000000003}, {30000, 1001}).step, 269);
}

TEST(Edges, WithinABillionthOfAStepOfABoundaryAreThatBoundary) {
  World<2> world = room();
  world.model.rate = {600, 1};
  const Rational just_before{59999999999999, 60000000000000}, just_after{60000000000001, 60000000000000};
  world.model.mice.push_back({{{just_before, {0, 0}}, {{3, 2}, {1, 0}}}, 0, 1, 0});
  world.model.mice.push_back({{{just_after, {0, 0}}, {{16001, 9600}, {1, 0}}}, 0, 1, 0});
  const auto all = edges(world.model);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].at, (TimeStamp{600, 0}));
  EXPECT_EQ(all[1].at, (TimeStamp{600, 0}));
  EXPECT_EQ(all[2].at, (TimeStamp{900, 0}));
  EXPECT_EQ(all[3].at.step, 1000);
  EXPECT_NEAR(all[3].at.fraction, 0.0625, 1e-15);
}

TEST(Edges, CutTheStepWhereTheyAre) {
  // pressed for 3.7 ms within one step of 10 ms: the impulse is that of the time pressed, to the fourth order
  World<2> world = room({0, 0});
  world.model.rate = {100, 1};
  add_particle(world, {1, 0});
  world.model.mice.push_back(resting({12, 10000}, {49, 10000}, {0, 0}, 100, 0));
  const double w = 10, t = 0.0037;
  const auto now = stepped(world, 1);
  EXPECT_NEAR(now.v[0].x(), -w * std::sin(w * t), 1e-8);  // w (w t)^5 / 120 = 6e-9
}

}  // namespace
}  // namespace obscura::sim
