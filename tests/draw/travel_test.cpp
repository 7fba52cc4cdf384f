#include <gtest/gtest.h>

#include <cmath>

#include "draw/made.h"
#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

TEST(Travel, NothingMovesInAStillRoom) {
  Made made = room(8, 4.5);
  made.body(sim::ShapeKind::box, {4, 2, 0}, 0.5);
  EXPECT_EQ(made.depictor().travel(made.now, 0.01), 0);
}

TEST(Travel, ABodyGoesItsVelocityAndItsCornersTurn) {
  Made made = room(8, 4.5);
  const int box = made.body(sim::ShapeKind::box, {4, 2, 0}, 0.5);
  const double scale = made.depictor().view(0).scale;
  made.now.bodies[std::size_t(box)].velocity = {3, 4, 0};
  EXPECT_NEAR(made.depictor().travel(made.now, 0.01), 0.05 * scale, 1e-9);
  made.now.bodies[std::size_t(box)].spin = {0, 0, 2};
  // its corners are sqrt(1/2) m away
  EXPECT_NEAR(made.depictor().travel(made.now, 0.01), (0.05 + 0.02 * std::sqrt(0.5)) * scale, 1e-9);
}

TEST(Travel, WhatIsOutOfSightDoesNotCount) {
  Made made = room(8, 4.5);
  const int ball = made.body(sim::ShapeKind::ball, {80, 2, 0}, 0.5);
  made.now.bodies[std::size_t(ball)].velocity = {100, 0, 0};
  EXPECT_EQ(made.depictor().travel(made.now, 0.01), 0);
}

TEST(Travel, ACameraThatFollowsMovesTheRoomAndNotTheBody) {
  Made made = room(8, 4.5);
  const int ball = made.body(sim::ShapeKind::ball, {4, 2, 0}, 0.5);
  made.now.bodies[std::size_t(ball)].velocity = {2, 0, 0};
  made.camera.follow = {ball};
  const Illustrator depictor = made.depictor();
  EXPECT_NEAR(depictor.travel(made.now, 0.01), 0.02 * depictor.view(0).scale, 1e-9);
}

TEST(Travel, AnOrbitMovesWhatStandsStill) {
  Made made = room(8, 4.5);
  made.cast.dimension = 3;
  made.body(sim::ShapeKind::ball, {4, 2, 0}, 0.5);
  made.camera = slant();
  EXPECT_EQ(made.depictor().travel(made.now, 0.01), 0);
  made.camera.orbit = 1;
  EXPECT_GT(made.depictor().travel(made.now, 0.01), 1);
}

}  // namespace
}  // namespace obscura::draw
