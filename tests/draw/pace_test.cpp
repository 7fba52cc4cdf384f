#include "draw/picture/pace.h"

#include <gtest/gtest.h>

#include <cmath>

#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using Ease = CameraKey::Ease;
using sim::rational;
using sim::Rational;
using sim::value;

TEST(Pace, OfItsOwnSpeedLeavesEveryTimeAsItIs) {
  const Pace plain;
  EXPECT_TRUE(plain.plain());
  EXPECT_TRUE(Pace(rational(1)).plain());
  const Rational odd = rational(1'234'567'890'123, 999'999'999'989);
  EXPECT_EQ(plain.world(odd), odd);
  EXPECT_EQ(plain.film(odd), odd);
}

TEST(Pace, AnEvenSpeedIsExact) {
  const Pace half(rational(1, 2));
  EXPECT_EQ(half.world(rational(1001, 30000)), rational(1001, 60000));
  EXPECT_EQ(half.film(rational(10)), rational(20));
  const Pace third(rational(1, 3));
  EXPECT_EQ(third.world(rational(1, 60)), rational(1, 180));
  EXPECT_EQ(third.film(rational(10)), rational(30));
}

TEST(Pace, WhatIsTooFineIsTheNearestMicrosecond) {
  // 1001/30000 * 0.001 has a denominator of thirty million
  EXPECT_EQ(Pace(rational(1, 1000)).world(rational(1001, 30000)), rational(33, 1'000'000));
}

TEST(Pace, FromTwoToThreeSecondsAtATenthTakesTenSeconds) {
  const Pace pace({{rational(0), rational(1)},
                   {rational(2), rational(1, 10), Ease::hold},
                   {rational(3), rational(1), Ease::hold}});
  EXPECT_EQ(pace.world(rational(2)), rational(2));
  EXPECT_EQ(pace.world(rational(7)), rational(5, 2));
  EXPECT_EQ(pace.world(rational(12)), rational(3));
  EXPECT_EQ(pace.world(rational(14)), rational(5));
  EXPECT_EQ(pace.film(rational(5)), rational(14));
}

TEST(Pace, BeforeTheFirstKeyAndAfterTheLastTheirSpeedsHold) {
  const Pace pace({{rational(1), rational(1, 2)}, {rational(2), rational(2)}});
  EXPECT_EQ(pace.world(rational(1)), rational(1, 2));
  EXPECT_EQ(pace.film(rational(1)), rational(2));
  const Rational end = pace.film(rational(2));
  EXPECT_EQ(pace.world(end + rational(3)), rational(8));
}

// the speed, read off as a difference, against that of the ease itself
TEST(Pace, OnTheWayTheSpeedFollowsItsEase) {
  for (const Ease ease : {Ease::linear, Ease::in, Ease::out, Ease::in_out}) {
    const Pace pace({{rational(0), rational(1)}, {rational(1), rational(1, 5), ease}});
    const double T = value(pace.film(rational(1)));
    for (int i = 1; i < 20; ++i) {
      const double u = i / 20.0, h = 2e-3;
      const auto world = [&](double f) {
        return value(pace.world(*sim::from_double(std::round(f * 1e6) / 1e6)));
      };
      const double speed = (world(u * T + h) - world(u * T - h)) / (2 * h);
      // half a microsecond at both ends, and at both film times, over 4 ms; the curvature is below
      EXPECT_NEAR(speed, 1 + (0.2 - 1) * eased(ease, u), 5e-4) << int(ease) << " " << u;
    }
  }
}

TEST(Pace, TimeNeverGoesBackAndKeysAreWhereTheySay) {
  const Pace pace({{rational(1, 2), rational(1)},
                   {rational(7, 10), rational(1, 100), Ease::in_out},
                   {rational(8, 10), rational(1, 100), Ease::linear},
                   {rational(9, 10), rational(3), Ease::in}});
  Rational before;
  for (int n = 1; n < 3000; ++n) {
    const Rational now = pace.world(rational(n, 60));
    EXPECT_LT(before, now) << n;
    before = now;
  }
  for (const Rational key : {rational(1, 2), rational(7, 10), rational(8, 10), rational(9, 10)}) {
    // the film's time of a key is rounded: the run's is off by half a microsecond times the speed at most
    EXPECT_NEAR(value(pace.world(pace.film(key))), value(key), 2e-6);
  }
}

TEST(Pace, TheFilmsTimeIsTheWayBack) {
  const Pace pace({{rational(0), rational(2)}, {rational(1), rational(1, 4), Ease::in_out}});
  for (int n = 1; n < 100; ++n) {
    const Rational there = pace.film(rational(n, 50));
    EXPECT_NEAR(value(pace.world(there)), n / 50.0, 3e-6) << n;
  }
}

}  // namespace
}  // namespace obscura::draw
