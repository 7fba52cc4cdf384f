// Impacts: between two, through a cradle, and what they keep.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "sim/reference.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

constexpr Collision kModes[] = {Collision::contact, Collision::event};

TEST(ContactImpacts, TwoBallsPartAsTheClosedFormsSay) {
  const auto want = closed_form({"two_body_collision_1d"});
  for (const auto collision : kModes) {
    World<2> world = touching_room(collision, {0, 0});
    add_particle(world, {0, 0}, {3, 0}, 2, 0.5, 0.1);
    add_particle(world, {1, 0}, {-1, 0}, 1, 0.5, 0.1);
    const State<2> now = stepped(world, 300);
    EXPECT_NEAR(now.v[0].x(), want[0], 1e-13);
    EXPECT_NEAR(now.v[1].x(), want[1], 1e-13);
    // they met after 0.8 m at 4 m/s
    EXPECT_NEAR(now.x[0].x(), 0.6 + 0.3 * want[0], 1e-8);
  }
  for (const double m : {0.01, 1.0, 7.0, 1000.0}) {
    World<2> world = touching_room(Collision::event, {0, 0});
    add_ball(world, 0.1, 1, {0, 0}, {2, 0});
    add_ball(world, 0.2, m, {1, 0});
    const State<2> now = stepped(world, 600);
    EXPECT_NEAR(now.v[0].x(), 2 * (1 - m) / (1 + m), 1e-12);
    EXPECT_NEAR(now.v[1].x(), 4 / (1 + m), 1e-12);
    EXPECT_NEAR(now.x[1].x(), 1 + 4 / (1 + m) * (1 - 0.35), 1e-10);
  }
}

// five touching balls, the first `moving` of which come at 1 m/s from `away`
World<2> cradle(Impacts law, int moving, double away, Collision collision) {
  World<2> world = touching_room(collision, {0, 0});
  world.model.impacts = law;
  for (int i = 0; i < 5; ++i) {
    add_particle(world, {0.2 * i - (i < moving ? away : 0), 0}, {i < moving ? 1.0 : 0.0, 0}, 1, 1, 0.1);
  }
  return world;
}

TEST(ContactImpacts, ACradleObeysTheLawThatIsChosen) {
  const auto one = closed_form({"newton_cradle_sequential"}),
             two = closed_form({"newton_cradle_2balls_sequential"}),
             all = closed_form({"newton_cradle_simultaneous_newton"});
  for (const auto collision : kModes) {
    for (const double away : {0.0, 0.3}) {
      const State<2> a = stepped(cradle(Impacts::sequential, 1, away, collision), 400),
                     b = stepped(cradle(Impacts::sequential, 2, away, collision), 400),
                     c = stepped(cradle(Impacts::simultaneous, 1, away, collision), 400);
      for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(a.v[i].x(), one[i], 1e-12) << i << " away " << away;
        EXPECT_NEAR(b.v[i].x(), two[i], 1e-12) << i << " away " << away;
        EXPECT_NEAR(c.v[i].x(), all[i], 1e-12) << i << " away " << away;
      }
    }
  }
}

// three equal balls, the first at 1 m/s: v_n' = -e v_n at both touches of one instant and the momentum give
// v1 = (1 - 2e) / 3, v2 = v3 = (1 + e) / 3
TEST(ContactImpacts, OfThreeTouchingBallsBothTouchesAreSolvedAtOnce) {
  for (const auto collision : kModes) {
    for (const double e : {0.0, 0.3, 1.0}) {
      World<2> world = touching_room(collision, {0, 0});
      for (int i = 0; i < 3; ++i) add_particle(world, {0.2 * i, 0}, {i == 0 ? 1.0 : 0.0, 0}, 1, e, 0.1);
      const State<2> now = stepped(world, 10);
      EXPECT_NEAR(now.v[0].x(), (1 - 2 * e) / 3, 1e-12) << e;
      EXPECT_NEAR(now.v[1].x(), (1 + e) / 3, 1e-12) << e;
      EXPECT_NEAR(now.v[2].x(), (1 + e) / 3, 1e-12) << e;
      double energy = 0;
      for (const auto& v : now.v) energy += 0.5 * v.squaredNorm();
      EXPECT_LE(energy, 0.5 + 1e-12) << e;
    }
  }
}

TEST(ContactImpacts, ABoxLandsOnItsCornerAsTheClosedFormSays) {
  for (const auto& [name, e] : {std::pair{"box_corner_impact_2d_e1", 1.0},
                                {"box_corner_impact_2d_e05", 0.5},
                                {"box_corner_impact_2d_e0", 0.0}}) {
    const auto want = closed_form({name + std::string(",")});
    World<2> world = touching_room(Collision::event, {0, 0});
    add_wall(world, {0, 0}, {0, 1});
    add_box(world, {1, 0.5}, 2, {0, -want[2]}, {1, -3}, std::acos(-1) / 6, 2, e);
    const State<2> now = stepped(world, 1);
    EXPECT_NEAR(now.v[0].x(), want[5], 1e-12) << name;
    if (e > 0) {  // else it goes on turning about its corner
      EXPECT_NEAR(now.v[0].y(), want[6], 1e-12) << name;
      EXPECT_NEAR(now.spin[0][0], want[7], 1e-12) << name;
    }
    ASSERT_GE(now.contacts.size(), 1u);
    EXPECT_NEAR(now.contacts[0].impulse.y(), want[4], 1e-12) << name;
  }
}

// two of any shapes that hit each other somewhere
World<2> meeting(int seed, Collision collision) {
  Chance chance(std::uint64_t(seed) * 977 + 5);
  World<2> world = touching_room(collision, {0, 0});
  const double e = seed % 3 == 0 ? 1 : chance.between(0.1, 1);
  for (int side = 0; side < 2; ++side) {
    const Vec2 x(side ? 1.5 : 0, chance.between(-0.3, 0.3)),
        v(side ? chance.between(-3, 0) : chance.between(1, 3), chance.between(-0.2, 0.2));
    const double mass = chance.between(0.2, 5), angle = chance.between(-3, 3), spin = chance.between(-4, 4);
    switch ((seed / (side ? 3 : 1)) % 3) {
      case 0:
        add_ball(world, chance.between(0.1, 0.4), mass, x, v, spin, e);
        break;
      case 1:
        add_box(world, {chance.between(0.2, 0.9), chance.between(0.1, 0.6)}, mass, x, v, angle, spin, e);
        break;
      default:
        add_polygon(world, odd_polygon(chance, 3 + seed % 4, chance.between(0.2, 0.4)), mass, x, v, angle,
                    spin, e);
    }
  }
  rub(world, seed % 4 == 0 ? 0 : chance.between(0.05, 1));
  return world;
}

TEST(ContactImpacts, IsolatedImpactsKeepMomentumAndAngularMomentum) {
  // to rounding, as long as nothing rests on the other; energy falls, and without friction and at e = 1 it
  // stays
  int met = 0;
  for (const auto collision : kModes) {
    for (int seed = 0; seed < 120; ++seed) {
      const World<2> world = meeting(seed, collision);
      State<2> state = world.state;
      Stepper<2> stepper(world.model);
      stepper.begin(state);
      bool struck = false, rested = false;
      for (int i = 0; i < 600; ++i) {
        ASSERT_FALSE(stepper.step(state));
        for (const auto& contact : state.contacts) {
          struck = struck || contact.impulse.norm() > 0;
          rested = rested || contact.force.norm() > 0;
        }
      }
      const double had = energy(world, world.state), has = energy(world, state);
      EXPECT_LE(has, had * (1 + 1e-12)) << seed;
      if (rested) continue;
      met += struck;
      const Eigen::Vector3d before = momenta(world, world.state), after = momenta(world, state);
      EXPECT_NEAR((after - before).norm(), 0, 1e-12 * std::max(1.0, before.norm())) << seed;
      if (seed % 12 == 0) {
        EXPECT_NEAR(has, had, 1e-12 * had) << seed;
      }
    }
  }
  EXPECT_GT(met, 120);
}

TEST(ContactImpacts, RodsThatStrikeTheFloorWithFrictionNeverGainEnergy) {
  // Newton's law with friction alone gains in one of two hundred of these, by up to 18 %
  for (int seed = 0; seed < 400; ++seed) {
    Chance chance(std::uint64_t(seed) + 4242);
    World<2> world = touching_room(kModes[seed % 2], {0, 0});
    add_wall(world, {0, 0}, {0, 1});
    const double angle = chance.between(-1.5, 1.5);
    add_box(world, {1, 0.02}, 1, {0, 0.5 * std::abs(std::sin(angle)) + 0.011},
            {chance.between(-5, 5), chance.between(-3, -0.1)}, angle, chance.between(-10, 10),
            chance.between(0, 1));
    rub(world, chance.between(0, 1.2));
    ASSERT_NO_FATAL_FAILURE(expect_no_gain(world, 60, 1e-11, "seed " + std::to_string(seed)));
  }
}

TEST(ContactImpacts, BouncesDecayToRestAtTheRightTimeWithoutEvents) {
  // what is slower than rest, g h at most, bounces no more: 2 h/(1-e) too early at most
  for (const double e : {0.5, 0.8, 0.9}) {
    World<2> world = touching_room();
    add_wall(world, {0, 0}, {0, 1});
    add_particle(world, {0, 1.1}, {0, 0}, 1, e, 0.1);
    const double end = std::sqrt(2 / kG) * (1 + e) / (1 - e);
    const int slack = int(2 / (1 - e)) + 1;
    const State<2> before = stepped(world, int(600 * end) - slack),
                   after = stepped(world, int(600 * end) + 2);
    EXPECT_TRUE(before.v[0].y() != 0 || before.x[0].y() > 0.1 + 1e-8) << e;
    EXPECT_EQ(after.v[0].y(), 0) << e;
    EXPECT_NEAR(after.x[0].y(), 0.1, 1e-8) << e;
  }
}

TEST(ContactImpacts, AFastSmallBallNeverPassesThinBoxes) {
  // a cell of two thin fixed boxes; at 1e4 m/s a step is eight hundred of their thicknesses
  for (const auto collision : kModes) {
    World<2> world = touching_room(collision);
    add_walls(world, 8, 4);
    add_particle(world, {4, 2}, {1e4, 3141}, 0.01, 1, 0.02);
    add_box(world, {0.02, 4}, 1, {3, 2});
    add_box(world, {0.02, 4}, 1, {5, 2});
    world.model.bodies[1].fixed = world.model.bodies[2].fixed = true;
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 12; ++i) {
      ASSERT_FALSE(stepper.step(state));
      ASSERT_GE(state.x[0].x(), 3.03 - 1e-8);
      ASSERT_LE(state.x[0].x(), 4.97 + 1e-8);
      ASSERT_GE(state.x[0].y(), 0.02 - 1e-8);
      ASSERT_LE(state.x[0].y(), 3.98 + 1e-8);
    }
    EXPECT_NEAR(energy(world, state) / energy(world, world.state), 1, 1e-12);
  }
}

TEST(ContactImpacts, ElasticBallsAmongEachOtherKeepTheirEnergy) {
  for (const Vec2& gravity : {Vec2(0, 0), Vec2(0, -kG)}) {
    World<2> world = touching_room(Collision::event, gravity);
    add_walls(world, 2, 2);
    for (int i = 0; i < 6; ++i) {
      add_ball(world, 0.1 + 0.02 * i, 1 + i, {0.4 + 0.6 * (i % 3), 0.6 + 0.8 * (i / 3)},
               {1.5 - i, 0.7 * i - 2});
    }
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    int impacts = 0;
    for (int i = 0; i < 3000; ++i) {
      ASSERT_FALSE(stepper.step(state));
      for (const auto& contact : state.contacts) impacts += contact.impulse.norm() > 0;
    }
    EXPECT_GT(impacts, 100);
    // rounding of a hundred solves and five seconds of steps
    EXPECT_NEAR(energy(world, state) / energy(world, world.state), 1, 1e-12) << gravity.y();
  }
}

}  // namespace
}  // namespace obscura::sim
