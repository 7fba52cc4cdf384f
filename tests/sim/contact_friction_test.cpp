// Friction against closed forms: stopping, slopes, rolling.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reference.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

TEST(ContactFriction, StopDistanceHoldsForEveryMuSpeedAndRate) {
  // d = v^2/(2 mu g), from the slowest speed of the claim, 50 mu g h, up; the claim is 1e-4. The moment of
  // stopping is located in both modes, so that what is left is closing tolerance: 1e-9 of 4 m
  for (const int rate : {240, 600, 1000}) {
    for (const double mu : {0.05, 0.2, 0.45, 1.0}) {
      for (const double times : {50.0, 77.7}) {
        for (const auto collision : {Collision::contact, Collision::event}) {
          World<2> world = touching_room(collision);
          world.model.rate = {rate, 1};
          add_wall(world, {0, 0}, {0, 1});
          const double v = times * mu * kG / rate, d = v * v / (2 * mu * kG);
          add_box(world, {0.6, 0.4}, 2, {0, 0.2}, {v, 0});
          rub(world, mu);
          const State<2> now = stepped(world, int(times) + 3);
          EXPECT_NEAR(now.x[0].x(), d, collision == Collision::event ? 1e-9 * d : 1e-7 * d)
              << mu << " at " << v << " m/s, " << rate << " a second";
          EXPECT_LT(now.v[0].norm(), 1e-11);
        }
      }
    }
  }
}

TEST(ContactFriction, AParticleStopsAsABoxDoes) {
  const auto want = closed_form({"slide_stop", "mu=0.3"});
  for (const auto collision : {Collision::contact, Collision::event}) {
    for (const double radius : {0.0, 0.1}) {
      World<2> world = touching_room(collision);
      add_wall(world, {0, 0}, {0, 1});
      add_particle(world, {0, radius}, {5, 0}, 0.3, 0, radius);
      rub(world, 0.3);
      // the closed form's digits and the closing tolerance are finer than this
      EXPECT_NEAR(stepped(world, 1025).x[0].x(), want[0], 1e-9);
      EXPECT_GT(stepped(world, int(600 * want[1]) - 1).v[0].x(), 0);
      EXPECT_NEAR(stepped(world, int(600 * want[1]) + 1).v[0].x(), 0, 1e-12);
    }
  }
}

TEST(ContactFriction, EverySlopeHoldsAHundredthOfADegreeBelowItsAngle) {
  // a tall box stands only while it does not tip, width/height > tan(angle); the tall one here all but does
  const double degree = std::acos(-1) / 180;
  for (const int rate : {240, 600, 1000}) {
    for (const double mu : {0.1, 0.4, 1.0}) {
      for (const Vec2& size : {Vec2(0.6 * (mu + 0.01), 0.6), Vec2(2, 0.05), Vec2(0.5, 0.4)}) {
        for (const double off : {-0.01, 0.01}) {
          World<2> world = touching_room();
          world.model.rate = {rate, 1};
          const double angle = std::atan(mu) + off * degree;
          const Vec2 n(-std::sin(angle), std::cos(angle));
          add_wall(world, {0, 0}, n);
          add_box(world, size, 2, 0.5 * size.y() * n, {0, 0}, angle);
          rub(world, mu);
          const State<2> now = stepped(world, rate);
          const double a = off < 0 ? 0 : kG * (std::sin(angle) - mu * std::cos(angle));
          // a fall of half a metre errs by rounding; the closing tolerance is 4e-9
          EXPECT_NEAR((now.x[0] - 0.5 * size.y() * n).norm(), 0.5 * a, 5e-9)
              << mu << ' ' << off << ' ' << size.transpose() << ' ' << rate;
          EXPECT_NEAR(now.v[0].norm(), a, 1e-9);
          if (off < 0) {
            EXPECT_TRUE(now.frozen[0]) << mu << ' ' << size.transpose();
          }
          if (off > 0) {
            EXPECT_FALSE(now.frozen[0]);
          }
        }
      }
    }
  }
}

TEST(ContactFriction, ABlockSlidesDownAsTheClosedFormSays) {
  const auto want = closed_form({"slope_slide"});
  World<2> world = touching_room();
  const double angle = std::acos(-1) / 6;
  const Vec2 n(-std::sin(angle), std::cos(angle));
  add_wall(world, {0, 0}, n);
  add_box(world, {0.6, 0.4}, 2, 0.2 * n, {0, 0}, angle);
  rub(world, 0.3);
  const State<2> now = stepped(world, 600);
  EXPECT_NEAR(now.v[0].norm(), want[0], 1e-9);
  EXPECT_NEAR((now.x[0] - 0.2 * n).norm(), want[1], 1e-9);
}

TEST(ContactFriction, ATallBoxTipsOnASlopeThatWouldHoldIt) {
  const double angle = 0.35;
  for (const double ratio : {0.98, 1.02}) {  // of tan(angle): below it tips, above it stands
    World<2> world = touching_room();
    const Vec2 n(-std::sin(angle), std::cos(angle));
    add_wall(world, {0, 0}, n);
    const Vec2 size(0.5 * ratio * std::tan(angle), 0.5);
    add_box(world, size, 2, 0.5 * size.y() * n, {0, 0}, angle);
    rub(world, 0.8);
    const State<2> now = stepped(world, 600);
    if (ratio > 1) {
      EXPECT_NEAR(now.turn[0][0], angle, 1e-9);
    }
    if (ratio < 1) {
      EXPECT_GT(std::abs(now.turn[0][0] - angle), 0.1);
    }
  }
}

TEST(ContactFriction, ADiscRollsFromTheRightMomentOn) {
  // v = v0 - mu g t, r w = 2 mu g t until they meet at v0/(3 mu g); there v = 2/3 v0
  const auto want = closed_form({"slip_to_roll_disc"});
  for (const auto collision : {Collision::contact, Collision::event}) {
    for (const double radius : {0.05, 0.5}) {
      World<2> world = touching_room(collision);
      add_wall(world, {0, 0}, {0, 1});
      add_ball(world, radius, 3, {0, radius}, {6, 0});
      rub(world, 0.2);
      const State<2> now = stepped(world, 900);
      const double slid = 6 * want[0] - 0.5 * 0.2 * kG * want[0] * want[0];
      EXPECT_NEAR(now.v[0].x(), want[1], 1e-9);
      EXPECT_NEAR(now.spin[0][0] * radius, -want[1], 1e-9);
      EXPECT_NEAR(now.x[0].x(), slid + want[1] * (1.5 - want[0]), 1e-8);
    }
  }
}

TEST(ContactFriction, ADiscWithBackspinComesBack) {
  // angular momentum about the floor is kept: 3/2 m r v = m r v0 + 1/2 m r^2 w0, w0 against the roll
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  add_ball(world, 0.25, 3, {0, 0.25}, {1, 0}, 24);
  rub(world, 0.3);
  const State<2> now = stepped(world, 900);
  EXPECT_NEAR(now.v[0].x(), (2 * 1 - 0.25 * 24) / 3, 1e-9);
  EXPECT_NEAR(now.spin[0][0], -now.v[0].x() / 0.25, 1e-9);
}

TEST(ContactFriction, ADiscRollsDownASlopeAtTwoThirdsOfItsPull) {
  // sticks while tan(angle) <= 3 mu, a = 2/3 g sin; else slides, a = g (sin - mu cos)
  const double angle = 0.6;
  for (const double mu : {0.2, 0.3}) {
    World<2> world = touching_room();
    const Vec2 n(-std::sin(angle), std::cos(angle));
    add_wall(world, {0, 0}, n);
    add_ball(world, 0.2, 1, 0.2 * n);
    rub(world, mu);
    const State<2> now = stepped(world, 600);
    const double a = mu * 3 < std::tan(angle) ? kG * (std::sin(angle) - mu * std::cos(angle))
                                              : 2 * kG * std::sin(angle) / 3;
    EXPECT_NEAR((now.x[0] - 0.2 * n).norm(), 0.5 * a, 5e-9) << mu;
    EXPECT_NEAR(now.v[0].norm(), a, 1e-9) << mu;
  }
}

TEST(ContactFriction, ABoxOnABoxIsDraggedAlong) {
  // above slides on below, which the floor does not hold: both end with the common momentum
  for (const auto collision : {Collision::contact, Collision::event}) {
    World<2> world = touching_room(collision);
    add_wall(world, {0, 0}, {0, 1});
    add_box(world, {3, 0.2}, 3, {0, 0.1});
    add_box(world, {0.2, 0.2}, 1, {-0.8, 0.3}, {2, 0});
    rub(world, 0.4);
    world.model.walls[0].friction = 0;
    const State<2> now = stepped(world, 600);
    EXPECT_NEAR(now.v[0].x(), 0.5, 1e-11);
    EXPECT_NEAR(now.v[1].x(), 0.5, 1e-11);
    // the way slid: mu m g s = 1/2 m_red v^2
    EXPECT_NEAR(now.x[1].x() - now.x[0].x(), -0.8 + 0.5 * 0.75 * 4 / (0.4 * kG), 1e-9);
  }
}

// drawn by a spring whose end moves at speed u, it stays until k u t = mu m g; then, tau later,
//   x = u tau - u/w sin(w tau)
TEST(ContactFriction, WhatAHandDrawsSlipsAtItsTime) {
  const double k = 20, mu = 0.5, u = 0.5, w = std::sqrt(k);
  const auto error = [&](int rate) {
    World<2> world = touching_room(Collision::event);
    world.model.rate = {rate, 1};
    add_wall(world, {0, 0}, {0, 1});
    add_particle(world, {0, 0}, {0, 0}, 1, 0);
    rub(world, mu);
    world.model.mice.push_back({{{{0, 1}, {0, 0}}, {{2, 1}, {2 * u, 0}}}, 0, k, 0});
    const auto all = run(world);
    const double tau = 1.2 - mu * kG / (k * u);
    return shown(*all, {6, 5}).bodies[0].position.x() - (u * tau - u / w * std::sin(w * tau));
  };
  // Runge-Kutta's own error, (w h)^4 / 120 u tau
  EXPECT_NEAR(error(100), 0, 1.3e-8);
  EXPECT_NEAR(error(600), 0, 1e-11);
}

}  // namespace
}  // namespace obscura::sim
