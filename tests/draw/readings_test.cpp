// What arrows and live values of a run show, and what of it is rounding's.

#include "draw/page/readings.h"

#include <gtest/gtest.h>

#include "draw/compose/annotate.h"
#include "made.h"

namespace obscura::draw {
namespace {

Made with_a_ball(double mass, double size) {
  Made made = room(4 * size, 3 * size);
  made.cast.gravity = {0, -9.81, 0};
  made.body(sim::ShapeKind::ball, {size, size, 0}, 0.2 * size);
  made.cast.bodies[0].mass = mass;
  return made;
}

TEST(Readings, WhatIsNegligibleFollowsTheScene) {
  const Made usual = with_a_ball(2, 1), light = with_a_ball(1e-15, 1), tiny = with_a_ball(1, 1e-6);
  for (const char* unit : {"m", "m/s", "m/s²", "kg m/s", "N s", "N", "J", "N m", "rad/s", "°"})
    EXPECT_EQ(negligible(unit, usual.cast, 0), 1e-9) << unit;
  EXPECT_DOUBLE_EQ(negligible("N", light.cast, 0), 1e-24 * 9.81);
  EXPECT_DOUBLE_EQ(negligible("J", light.cast, 0), 1e-24 * 9.81 * 3);
  EXPECT_EQ(negligible("m", light.cast, 0), 1e-9);
  EXPECT_DOUBLE_EQ(negligible("m", tiny.cast, 0), 3e-15);
  EXPECT_DOUBLE_EQ(negligible("m/s", tiny.cast, 0), 1e-9 * std::sqrt(3e-6 * 9.81));
  // without one named, the heaviest's
  Made both = usual;
  both.body(sim::ShapeKind::ball, {2, 1, 0}, 0.2);
  both.cast.bodies[1].mass = 1e-15;
  EXPECT_EQ(negligible("N", both.cast), 1e-9);
  EXPECT_DOUBLE_EQ(negligible("N", both.cast, 1), 1e-24 * 9.81);
}

TEST(Readings, AnArrowOfALightBodyIsAsLongAsThatOfAHeavyOne) {
  const auto length_of = [](double mass) {
    const Made made = with_a_ball(mass, 1);
    Marks marks;
    marks.vectors.push_back({.quantity = Quantity::weight, .body = 0, .label = {}});
    const std::vector<sim::Snapshot> moments{made.now};
    return scales(marks, made.cast, moments, {0, 0, 400, 300}, 100).force * mass * 9.81;
  };
  EXPECT_NEAR(length_of(1e-15), length_of(1), 1e-12);
  EXPECT_NEAR(length_of(1), 0.34 * 300 / 100, 1e-12);
  // what rounding leaves is none
  const Made made = with_a_ball(1, 1);
  Marks marks;
  marks.vectors.push_back({.quantity = Quantity::momentum, .body = 0, .label = {}});
  std::vector<sim::Snapshot> moments{made.now};
  moments[0].bodies[0].velocity = {1e-14, 0, 0};
  EXPECT_EQ(scales(marks, made.cast, moments, {0, 0, 400, 300}, 100).momentum, 0);
}

// an arrow that is shown only later is as long as its later values are large
TEST(Readings, ArrowsAreScaledByWhatIsShown) {
  const Made made = with_a_ball(1, 1);
  Marks marks;
  marks.vectors.push_back({.quantity = Quantity::momentum, .body = 0, .label = {}});
  std::vector<sim::Snapshot> moments{made.now, made.now};
  moments[0].bodies[0].velocity = {10, 0, 0};
  moments[1].bodies[0].velocity = {2, 0, 0}, moments[1].time = 2;
  const auto scale = [&] { return scales(marks, made.cast, moments, {0, 0, 400, 300}, 100).momentum; };
  EXPECT_NEAR(scale() * 10, 0.34 * 300 / 100, 1e-12);
  marks.vectors[0].shown.start = Cue{1};
  EXPECT_NEAR(scale() * 2, 0.34 * 300 / 100, 1e-12);
  // while the film stands still there
  marks.vectors[0].shown = {Cue{2, true, 2.5}, Cue{2, true, 3.5}};
  EXPECT_NEAR(scale() * 2, 0.34 * 300 / 100, 1e-12);
}

}  // namespace
}  // namespace obscura::draw
