// Bodies that touch, rest and slide: collision = "contact" and "event".

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

TEST(Contact, ABlockStopsAfterVSquaredOverTwoMuG) {
  for (const double mu : {0.1, 0.3, 0.5, 0.9}) {
    for (const auto collision : {Collision::contact, Collision::event}) {
      World<2> world = touching_room(collision);
      add_wall(world, {0, 0}, {0, 1});
      add_box(world, {0.6, 0.4}, 2, {0, 0.2}, {2, 0});
      rub(world, mu);
      const State<2> now = stepped(world, 1800);
      EXPECT_NEAR(now.x[0].x(), 4 / (2 * mu * kG), 1e-9) << mu;
      EXPECT_NEAR(now.x[0].y(), 0.2, 1e-9);
      EXPECT_LT(now.v[0].norm(), 1e-11);
    }
  }
}

TEST(Contact, ASlopeHoldsBelowItsAngleOfFrictionAndNotAbove) {
  const double mu = 0.4, critical = std::atan(mu), degree = std::acos(-1) / 180;
  for (const double off : {-0.01, 0.01}) {
    World<2> world = touching_room();
    const double angle = critical + off * degree;
    const Vec2 n(-std::sin(angle), std::cos(angle));
    add_wall(world, {0, 0}, n);
    add_box(world, {0.6, 0.4}, 2, 0.2 * n, {0, 0}, angle);
    rub(world, mu);
    const State<2> now = stepped(world, 600);
    const double a = off < 0 ? 0 : kG * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_NEAR((now.x[0] - 0.2 * n).norm(), 0.5 * a, 1e-9) << off;
    EXPECT_NEAR(now.v[0].norm(), a, 1e-9) << off;
  }
}

TEST(Contact, ADiscComesToRollAtTwoThirdsOfItsSpeed) {
  for (const auto collision : {Collision::contact, Collision::event}) {
    World<2> world = touching_room(collision);
    add_wall(world, {0, 0}, {0, 1});
    add_ball(world, 0.25, 3, {0, 0.25}, {3, 0});
    rub(world, 0.2);
    const State<2> now = stepped(world, 1200);
    EXPECT_NEAR(now.v[0].x(), 2, 1e-10);
    EXPECT_NEAR(now.spin[0][0], -8, 1e-9);
    EXPECT_NEAR(now.x[0].y(), 0.25, 1e-9);
  }
}

TEST(Contact, ABoxDroppedFlatRestsWithoutABitOfMotion) {
  World<2> world = touching_room();
  add_walls(world, 8, 4);
  add_box(world, {0.6, 0.4}, 2, {4, 1}, {0, 0}, 0, 0, 0.3);
  rub(world, 0.5);
  const State<2> early = stepped(world, 1200), late = stepped(world, 6000);
  EXPECT_EQ(early.x[0], late.x[0]);
  EXPECT_EQ(early.turn[0], late.turn[0]);
  EXPECT_EQ(late.v[0], Vec2(0, 0));
  EXPECT_NEAR(late.x[0].y(), 0.2, 1e-9);
  ASSERT_EQ(late.contacts.size(), 2u);
  for (const auto& contact : late.contacts) EXPECT_NEAR(contact.force.y(), kG, 1e-9);
}

TEST(Contact, AStackCarriesTheWeightAbove) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  constexpr int kBoxes = 10;
  for (int i = 0; i < kBoxes; ++i) add_box(world, {0.5, 0.25}, 1 + i % 3, {0.02 * (i % 2), 0.125 + 0.25 * i});
  rub(world, 0.5);
  const State<2> now = stepped(world, 300);
  for (int i = 0; i < kBoxes; ++i) {
    double above = 0, carried = 0;
    for (int k = i; k < kBoxes; ++k) above += world.model.bodies[k].mass * kG;
    for (const auto& contact : now.contacts) {
      if (contact.key.a == i - 1 && contact.key.b == i) carried -= contact.force.y();
      if (i == 0 && contact.key.b < 0) carried += contact.force.y();
    }
    EXPECT_NEAR(carried, above, 1e-9 * above) << i;
    EXPECT_NEAR(now.x[i].y(), 0.125 + 0.25 * i, 1e-8) << i;
  }
}

TEST(Contact, ABeamObeysTheLeverRule) {
  World<2> world = touching_room();
  add_box(world, {0.2, 0.2}, 1, {0, 0.1});
  add_box(world, {0.2, 0.2}, 1, {3, 0.1});
  add_box(world, {4, 0.1}, 6, {1.3, 0.25});
  world.model.bodies[0].fixed = world.model.bodies[1].fixed = true;
  const State<2> now = stepped(world, 10);
  // supports act at the four edges of their tops; their moments about the two midpoints are determined
  double left = 0, right = 0, moment = 0;
  for (const auto& contact : now.contacts) {
    (contact.key.a == 0 ? left : right) -= contact.force.y();
    moment -= (contact.point.x() - 1.3) * contact.force.y();
  }
  EXPECT_NEAR(left + right, 6 * kG, 1e-9);
  EXPECT_NEAR(moment, 0, 1e-9);
}

TEST(Event, AnElasticBallKeepsItsEnergyOverAHundredBounces) {
  World<2> world = touching_room(Collision::event);
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {0, 1}, {0.3, 0}, 0.7, 1, 0.1);
  const double before = energy(world, world.state);
  const State<2> now = stepped(world, 600 * 86);  // a bounce takes 0.8565 s
  EXPECT_NEAR(energy(world, now) / before, 1, 1e-12);
}

TEST(Event, BouncesDecayToRestAtTheRightTime) {
  // t = sqrt(2 h/g) (1 + e)/(1 - e)
  World<2> world = touching_room(Collision::event);
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {0, 1.1}, {0, 0}, 1, 0.9, 0.1);
  const double end = std::sqrt(2 / kG) * 1.9 / 0.1;
  const State<2> before = stepped(world, int(600 * (end - 0.01))),
                 after = stepped(world, int(600 * (end + 0.01)));
  EXPECT_GT(before.v[0].norm(), 1e-3);
  EXPECT_EQ(after.v[0].y(), 0);
  EXPECT_NEAR(after.x[0].y(), 0.1, 1e-11);
}

TEST(Contact, ASmallFastBallStaysInTheRoom) {
  for (const auto collision : {Collision::contact, Collision::event}) {
    World<2> world = touching_room(collision);
    add_walls(world, 8, 4);
    add_particle(world, {4, 2}, {1e4, 3141}, 0.01, 1, 0.02);
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 60; ++i) {
      ASSERT_FALSE(stepper.step(state));
      ASSERT_GE(state.x[0].x(), 0.02 - 1e-8);
      ASSERT_LE(state.x[0].x(), 8 - 0.02 + 1e-8);
      ASSERT_GE(state.x[0].y(), 0.02 - 1e-8);
      ASSERT_LE(state.x[0].y(), 4 - 0.02 + 1e-8);
    }
    EXPECT_NEAR(energy(world, state) / energy(world, world.state), 1, 1e-12);
  }
}

TEST(Contact, TwoBallsExchangeMomentum) {
  World<2> world = touching_room(Collision::event, {0, 0});
  add_ball(world, 0.1, 1, {0, 0}, {2, 0});
  add_ball(world, 0.2, 3, {1, 0.05}, {-1, 0});
  const State<2> now = stepped(world, 600);
  const Vec2 p = 1 * Vec2(2, 0) + 3 * Vec2(-1, 0);
  EXPECT_NEAR((now.v[0] + 3 * now.v[1] - p).norm(), 0, 1e-13);
  EXPECT_NEAR(energy(world, now), energy(world, world.state), 1e-13);
}

TEST(Contact, ACradlePassesItsBallOn) {
  World<2> world = touching_room(Collision::contact, {0, 0});
  world.model.impacts = Impacts::sequential;
  for (int i = 0; i < 5; ++i) add_particle(world, {0.2 * i, 0}, {0, 0}, 1, 1, 0.1);
  world.state.x[0].x() = -0.5, world.state.v[0].x() = 1;
  const State<2> now = stepped(world, 600);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(now.v[i].x(), 0, 1e-12) << i;
  EXPECT_NEAR(now.v[4].x(), 1, 1e-12);
}

TEST(Contact, APyramidStands) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  constexpr int kBase = 6;
  for (int row = 0; row < kBase; ++row) {
    for (int i = 0; i < kBase - row; ++i)
      add_box(world, {0.4, 0.2}, 1, {0.45 * i + 0.225 * row, 0.1 + 0.2 * row});
  }
  rub(world, 0.5);
  const State<2> now = stepped(world, 600);
  for (std::size_t i = 0; i < now.x.size(); ++i) {
    EXPECT_NEAR((now.x[i] - world.state.x[i]).norm(), 0, 1e-8) << i;
    EXPECT_TRUE(now.frozen[i]) << i;
  }
}

TEST(Contact, EnergyNeverRisesAmongTumblingBoxes) {
  for (int seed = 0; seed < 4; ++seed) {
    World<2> world = touching_room(seed % 2 ? Collision::event : Collision::contact);
    add_walls(world, 4, 4);
    for (int i = 0; i < 8; ++i) {
      add_box(world, {0.5, 0.3}, 1 + i, {0.6 + 0.8 * (i % 4), 0.6 + 0.8 * (i / 4)},
              {1.0 * (i % 3), -1.0 * seed}, 0.4 * i + seed, 3 - i, 0.6);
    }
    rub(world, 0.4);
    ASSERT_NO_FATAL_FAILURE(expect_no_gain(world, 1200, 1e-12, "seed " + std::to_string(seed)));
  }
}

}  // namespace
}  // namespace obscura::sim
