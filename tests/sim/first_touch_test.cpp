// First touches against closed forms and against looking very often.

#include "sim/first_touch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/gap.h"
#include "sim/shapes.h"

namespace obscura::sim {
namespace {

Motion<2> straight(const Vec<2>& x, const Vec<2>& v, double h, double turn = 0, double w = 0) {
  Motion<2> of;
  of.x0 = x;
  of.x1 = x + h * v;
  of.v0 = of.v1 = v;
  of.turn0[0] = turn;
  of.turn1[0] = turn + h * w;
  of.w0[0] = of.w1[0] = w;
  of.h = h;
  return of;
}

Motion<2> resting(const Vec<2>& x, double turn = 0) { return straight(x, {0, 0}, 0.01, turn); }

// a parabola is a cubic
Motion<2> thrown(const Vec<2>& x, const Vec<2>& v, double h) {
  Motion<2> of = straight(x, v, h);
  of.x1[1] -= 9.81 * h * h / 2;
  of.v1[1] -= 9.81 * h;
  return of;
}

TEST(Motion, IsTheParabolaItWasGiven) {
  const Motion<2> of = thrown({1, 2}, {3, 4}, 0.5);
  for (const double s : {0.0, 0.3, 1.0}) {
    const double t = 0.5 * s;
    EXPECT_NEAR(of.at(s).x[0], 1 + 3 * t, 1e-15);
    EXPECT_NEAR(of.at(s).x[1], 2 + 4 * t - 9.81 * t * t / 2, 2e-15);
    EXPECT_NEAR(of.at(s).v[1], 4 - 9.81 * t, 5e-15);
  }
}

TEST(FirstTouch, OfABulletAndAPlateIsNeverMissed) {
  // 1e4 m/s through 0.1 m in 1/600 s: 17 m in a step
  const Shape<2> plate = box_shape(0.1, 5);
  for (const double radius : {0.0, 0.01, 0.3}) {
    for (int i = 1; i < 50; ++i) {
      const double away = 0.33 * i;
      const auto s =
          first_touch(ball_shape(radius), straight({-away - radius - 0.05, 0.2}, {1e4, 3}, 1.0 / 600), plate,
                      resting({0, 0}), 0.0, 1e-9);
      ASSERT_TRUE(s) << away;
      // a rounding of 17 m
      EXPECT_NEAR(*s * 1e4 / 600, away, 1e-9 + 1e-14) << away;
      EXPECT_LE(*s * 1e4 / 600, away + 1e-14);
    }
  }
  EXPECT_FALSE(first_touch(ball_shape(0.01), straight({-1, 2.52}, {1e4, 0}, 1.0 / 600), plate,
                           resting({0, 0}), 0.0, 1e-9));
}

TEST(FirstTouch, OfAFallIsWhenTheParabolaSays) {
  Wall<2> floor;
  const double h = 0.5, height = 1;
  const double want = std::sqrt(2 * height / 9.81) / h;
  const Motion<2> fall = thrown({0, height + 0.2}, {5, 0}, h);
  const auto on_wall = first_touch(ball_shape(0.2), fall, floor, 0.0, 1e-10);
  const auto on_box = first_touch(ball_shape(0.2), fall, box_shape(20, 1), resting({0, -0.5}), 0.0, 1e-10);
  ASSERT_TRUE(on_wall && on_box);
  // the tolerance at 4.4 m/s
  EXPECT_NEAR(*on_wall, want, 1e-10);
  EXPECT_NEAR(*on_box, want, 1e-10);
  // at a target above: sooner
  EXPECT_NEAR(*first_touch(ball_shape(0.2), fall, floor, 0.5, 1e-10), want * std::sqrt(0.5), 1e-10);
  // thrown upward from it, it comes back; in less time it does not
  const Motion<2> up = thrown({0, 0.2}, {0, 2}, h);
  EXPECT_NEAR(*first_touch(ball_shape(0.2), up, floor, 0.0, 1e-10), 2 * 2 / 9.81 / h, 1e-9);
  EXPECT_FALSE(first_touch(ball_shape(0.2), thrown({0, 0.2}, {0, 2}, 0.4), floor, 0.0, 1e-10));
}

TEST(FirstTouch, TwoBallsMeetWhenTheQuadraticSays) {
  Dice dice(1);
  int met = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec<2> x(dice.within(-2, 2), dice.within(-2, 2)), v(dice.within(-50, 50), dice.within(-50, 50)),
        u(7, -3);
    if (x.norm() < 0.51) continue;
    const double h = 0.1, r = 0.5;
    const double a = v.squaredNorm(), b = x.dot(v), c = x.squaredNorm() - r * r, root = b * b - a * c;
    const double t = root > 0 && b < 0 ? (-b - std::sqrt(root)) / a : 1e9;
    const auto s = first_touch(ball_shape(0.3), straight(x, v + u, h), ball_shape(0.2),
                               straight({0, 0}, u, h), 0.0, 1e-11);
    ASSERT_EQ(s.has_value(), t <= h) << n;
    if (!s) continue;
    ++met;
    // the tolerance at the rate -root/r of the distance
    EXPECT_NEAR(*s * h, t, 1e-13 + 1e-11 * r / std::sqrt(root)) << n;
  }
  EXPECT_GT(met, 50);
}

// Nothing is missed: before the first touch no look sees them nearer; at it they are as near as promised.
TEST(FirstTouch, OfTurningShapesIsTheFirst) {
  Dice dice(2);
  int met = 0, began_near = 0;
  for (int n = 0; n < 1500; ++n) {
    const bool whole = n % 5 == 0;
    const Shape<2> a = whole ? compound_shape({dice.polygon(0.5), dice.polygon(0.5)}) : dice.simple(0.5);
    const Shape<2> b = dice.simple(0.5);
    if (a.kind == ShapeKind::point && b.kind == ShapeKind::point) continue;
    Motion<2> of_a = straight({dice.within(-1.2, 1.2), dice.within(-1.2, 1.2)},
                              {dice.within(-50, 50), dice.within(-50, 50)}, 0.05, dice.within(-4, 4),
                              dice.within(-60, 60));
    Motion<2> of_b =
        straight({dice.within(-1.2, 1.2), dice.within(-1.2, 1.2)}, {dice.within(-5, 5), dice.within(-5, 5)},
                 0.05, dice.within(-4, 4), dice.within(-60, 60));
    of_a.v0 += Vec<2>(dice.within(-9, 9), dice.within(-9, 9));
    of_a.w1[0] += dice.within(-20, 20);
    const double tolerance = 1e-7, target = dice.within(0, 0.05);
    const auto apart = [&](double s) { return separation(a, of_a.at(s), b, of_b.at(s)); };
    const double began = apart(0), goal = std::min(target, began - 2 * tolerance);
    if (whole && began <= target) continue;  // its parts began each for itself
    began_near += began <= target;
    const auto s = first_touch(a, of_a, b, of_b, target, tolerance);
    for (int i = 1; i <= 700; ++i) {
      const double look = i / 700.0;
      if (s && look >= *s) break;
      ASSERT_GT(apart(look), goal) << n << " " << look;
    }
    if (!s) continue;
    ++met;
    EXPECT_GT(*s, 0);
    EXPECT_LE(*s, 1);
    EXPECT_LE(apart(*s), goal + tolerance + 1e-14) << n;  // so it did not give up
    EXPECT_GE(apart(*s), goal - 1e-13) << n;
  }
  EXPECT_GT(met, 200);
  EXPECT_GT(began_near, 50);
}

TEST(FirstTouch, OfBodiesThatRestSlideOrLeaveIsNone) {
  const Shape<2> box = box_shape(0.2, 0.2), floor = box_shape(10, 1), ball = ball_shape(0.1);
  const double h = 1.0 / 60;
  for (const double gap : {0.0, 1e-12, -1e-12, 1e-9, -1e-7, 1e-7}) {
    const Motion<2> below = resting({0, -0.5});
    EXPECT_FALSE(first_touch(box, straight({0, 0.1 + gap}, {0, 0}, h), floor, below, 0.0, 1e-7));
    EXPECT_FALSE(first_touch(box, straight({0, 0.1 + gap}, {90, 0}, h), floor, below, 0.0, 1e-7));
    EXPECT_FALSE(first_touch(box, straight({0, 0.1 + gap}, {3, 1e-3}, h), floor, below, 0.0, 1e-7));
    EXPECT_FALSE(first_touch(ball, straight({0, 0.1 + gap}, {3, 1e-3}, h, 0, 500), floor, below, 0.0, 1e-7));
    EXPECT_FALSE(first_touch(ball, thrown({0, 0.1 + gap}, {3, 0.5}, h), floor, below, 0.0, 1e-7));
    // leaving with a turn that its own corner does not outrun
    EXPECT_FALSE(first_touch(box, straight({0, 0.1 + gap}, {0, 2}, h, 0, 10), floor, below, 0.0, 1e-7));
    // going on into it: at once
    const auto s = first_touch(ball, straight({0, 0.1 + gap}, {3, -100}, h), floor, below, 0.0, 1e-7);
    ASSERT_TRUE(s);
    EXPECT_LT(*s * h * 100, 4e-7);
  }
}

}  // namespace
}  // namespace obscura::sim
