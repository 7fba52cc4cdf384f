// Whole runs: energy in passive scenes, cut runs, order, rivals, who may touch whom.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/jointed.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

constexpr Collision kBothModes[] = {Collision::contact, Collision::event};

// anything, thrown into a room: points, balls, boxes, polygons, a compound
World<2> thrown(int seed, Collision collision) {
  Chance chance(std::uint64_t(seed) * 31 + 9);
  World<2> world = touching_room(collision);
  add_walls(world, 3, 3);
  const auto throw_v = [&] { return Vec2(chance.between(-3, 3), chance.between(-3, 3)); };
  add_particle(world, {0.3, 2.7}, throw_v(), 0.5, chance.between(0, 1));
  add_particle(world, {2.7, 2.7}, throw_v(), 0.5, chance.between(0, 1), 0.1);
  for (int i = 0; i < 6; ++i) {
    const Vec2 x(0.5 + 1.0 * (i % 3), 0.6 + 1.0 * (i / 3));
    const double e = chance.between(0, 1), angle = chance.between(-3, 3), spin = chance.between(-5, 5);
    if (i % 3 == 0) {
      add_ball(world, chance.between(0.1, 0.3), 1, x, throw_v(), spin, e);
    } else if (i % 3 == 1) {
      add_box(world, {chance.between(0.2, 0.6), chance.between(0.05, 0.4)}, chance.between(0.2, 4), x,
              throw_v(), angle, spin, e);
    } else {
      add_polygon(world, odd_polygon(chance, 3 + (seed + i) % 4, 0.3), 1.5, x, throw_v(), angle, spin, e);
    }
  }
  // a T of two boxes
  const int t = add_box(world, {0.5, 0.5}, 2, {1.5, 2.5}, throw_v(), chance.between(-3, 3), 1, 0.5);
  Shape<2>& shape = world.model.bodies[t].shape;
  shape = Compound<2>{{Box<2>{{0.25, 0.05}, {0, 0.11}}, Box<2>{{0.05, 0.2}, {0, -0.14}}}};
  shape = seated(shape, mass_properties(shape));
  world.model.bodies[t].inertia = inertia(shape, 2);
  rub(world, chance.between(0, 1));
  return world;
}

TEST(ContactRun, EnergyNeverRisesInRandomRooms) {
  // flight keeps gravity's energy to rounding, and contact is kept account of
  for (const int seed : {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 37}) {
    const World<2> world = thrown(seed, kBothModes[seed > 9 ? 0 : seed % 2]);
    expect_no_gain(world, 900, 1e-12, "seed " + std::to_string(seed), std::abs(energy(world, world.state)));
  }
}

// boxes hanging in a row from (0, 0), let go where the row is straight
World<2> chain(int links, double angle, Collision collision) {
  World<2> world = touching_room(collision);
  const Vec2 down(std::sin(angle), -std::cos(angle));
  for (int i = 0; i < links; ++i) {
    add_box(world, {0.06, 0.4}, 1, (0.4 * i + 0.2) * down, {0, 0}, angle, 0, 0.3);
    world.model.joints.push_back(pin({i, {0, 0.2}}, {i - 1, i ? Vec2(0, -0.2) : Vec2(0, 0)}));
  }
  rub(world, 0.4);
  return world;
}

TEST(ContactRun, AChainThatSwingsAgainstWallsNeverGains) {
  for (const auto collision : kBothModes) {
    World<2> world = chain(4, 0.9, collision);
    add_wall(world, {-0.5, 0}, {1, 0});
    // between impacts what hangs together is as exact as RK4 at a third of a step: 1e-8 a step of the whole
    expect_no_gain(world, 900, 1e-8, "chain", std::abs(energy(world, world.state)));
  }
}

TEST(ContactRun, ASwingingChainKeepsItsEnergyForAMinute) {
  World<2> world = chain(3, 0.6, Collision::contact);
  const double low = -kG * (0.2 + 0.6 + 1.0), had = energy(world, world.state) - low;
  const State<2> now = stepped(world, 36000);
  EXPECT_NEAR((energy(world, now) - low) / had, 1, 1e-6);
  EXPECT_NEAR((now.x[0] - 0.2 * Vec2(std::sin(now.turn[0][0]), -std::cos(now.turn[0][0]))).norm(), 0, 1e-12);
}

TEST(ContactRun, ARunCutInTwoIsTheRunInOne) {
  for (int seed = 0; seed < 6; ++seed) {
    const World<2> world = thrown(seed + 50, kBothModes[seed % 2]);
    const State<2> whole = stepped(world, 700);
    State<2> half = stepped(world, 313);
    Stepper<2> fresh(world.model);
    for (int i = 313; i < 700; ++i) ASSERT_FALSE(fresh.step(half));
    EXPECT_TRUE(whole == half) << seed;
  }
}

TEST(ContactRun, FlightBetweenEventsKeepsTheOrderOfRungeKutta) {
  // an elastic ball on a spring, bouncing off the floor; against sixteen times finer steps
  const auto at = [](int rate) {
    World<2> world = touching_room(Collision::event);
    world.model.rate = {rate, 1};
    add_wall(world, {0, 0}, {0, 1});
    add_particle(world, {0.4, 1}, {0.5, 0}, 1, 1, 0.1);
    add_spring(world, {0, {0, 0}}, {-1, {0, 1.2}}, 60, 0.3);
    return stepped(world, 2 * rate);
  };
  const State<2> exact = at(3200);
  const double coarse = (at(100).x[0] - exact.x[0]).norm(), fine = (at(200).x[0] - exact.x[0]).norm();
  EXPECT_LT(fine, 1e-4);
  EXPECT_GT(std::log2(coarse / fine), 3.5) << coarse << ' ' << fine;
}

World<2> pile(int kind, Solver solver) {
  World<2> world = touching_room();
  world.model.solver = solver;
  add_wall(world, {0, 0}, {0, 1});
  for (int i = 0, row = 0, k = 0; i < 10; ++i, ++k) {
    if (kind == 0) {
      add_box(world, {0.4, 0.2}, 1, {0.03 * (i % 3), 0.1 + 0.2 * i}, {0, 0}, 0, 0, 0);
      continue;
    }
    if (k == 4 - row) ++row, k = 0;
    add_box(world, {0.4, 0.2}, 1, {0.45 * k + 0.225 * row, 0.1 + 0.2 * row}, {0, 0}, 0, 0, 0);
  }
  rub(world, 0.5);
  return world;
}

TEST(ContactRun, TheTwoSolversAgreeOnPilesOfTen) {
  for (const int kind : {0, 1}) {
    const World<2> a = pile(kind, Solver::direct), b = pile(kind, Solver::iterative);
    const State<2> p = stepped(a, 600), q = stepped(b, 600);
    for (int i = 0; i < 10; ++i) {
      EXPECT_LT((p.x[i] - q.x[i]).norm(), 1e-4 * 0.4) << kind << ' ' << i;
      EXPECT_LT((carried(p, i) - carried(q, i)).norm(), 0.01 * kG) << kind << ' ' << i;
    }
    // what the floor carries is determined, and a stack's every interface
    double floor[2] = {0, 0}, between[2][10] = {};
    for (int s = 0; s < 2; ++s) {
      for (const auto& contact : (s ? q : p).contacts) {
        if (contact.key.b < 0) floor[s] += contact.force.y();
        if (contact.key.b == contact.key.a + 1) between[s][contact.key.a] -= contact.force.y();
      }
    }
    EXPECT_NEAR(floor[1] / floor[0], 1, 0.01);
    for (int i = 0; kind == 0 && i < 9; ++i) EXPECT_NEAR(between[1][i] / between[0][i], 1, 0.01) << i;
  }
}

TEST(ContactRun, TheSolversAgreeOnHowFarABlockSlides) {
  World<2> world = touching_room();
  world.model.solver = Solver::iterative;
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {0.6, 0.4}, 2, {0, 0.2}, {2, 0}, 0, 0, 0);
  rub(world, 0.4);
  const double d = 4 / (2 * 0.4 * kG);  // the claim: 0.01 %
  EXPECT_NEAR(stepped(world, 600).x[0].x(), d, 1e-4 * d);
}

TEST(ContactRun, GroupsThatAreToldNotToTouchPassThroughEachOther) {
  for (const bool ignore : {false, true}) {
    World<2> world = touching_room(Collision::contact, {0, 0});
    add_ball(world, 0.1, 1, {0, 0}, {1, 0});
    add_box(world, {0.2, 0.2}, 1, {0.5, 0}, {-1, 0});
    world.model.bodies[0].group = 1, world.model.bodies[1].group = 2;
    if (ignore) world.model.ignore = {{2, 1}};
    const State<2> now = stepped(world, 600);
    EXPECT_NEAR(now.x[0].x(), ignore ? 1 : 0.15 - 0.85, 1e-8);
    EXPECT_NEAR(now.v[0].x(), ignore ? 1 : -1, 1e-12);
  }
}

TEST(ContactRun, APointBouncesOffABoxAsOffAMirror) {
  for (const auto collision : kBothModes) {
    World<2> world = touching_room(collision, {0, 0});
    add_particle(world, {-1, 0}, {2, 0.3}, 0.1, 0.64);
    const double angle = 0.4;
    add_box(world, {0.8, 0.8}, 1, {0, 0}, {0, 0}, angle, 0, 1);
    world.model.bodies[1].fixed = true;
    const State<2> now = stepped(world, 600);
    // off the face that looks left: e of the pair is 0.8
    const Vec2 n(-std::cos(angle), -std::sin(angle)), v(2, 0.3);
    const Vec2 want = v - 1.8 * v.dot(n) * n;
    EXPECT_NEAR((now.v[0] - want).norm(), 0, 1e-12);
  }
}

TEST(ContactRun, PointsLieOnABoxAndWeighOnIt) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  for (int i = 0; i < 3; ++i) add_particle(world, {-0.3 + 0.25 * i, 0.9 + 0.2 * i}, {0, 0}, 0.5, 0.3);
  add_box(world, {1, 0.4}, 2, {0, 0.2}, {0, 0}, 0, 0, 0);
  rub(world, 0.5);
  const State<2> now = stepped(world, 1200);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(now.x[i].y(), 0.4, 1e-8) << i;
    EXPECT_NEAR(carried(now, i).y(), 0.5 * kG, 1e-9) << i;
    EXPECT_TRUE(now.frozen[i]) << i;
  }
  double floor = 0;
  for (const auto& contact : now.contacts) floor += contact.key.b < 0 ? contact.force.y() : 0;
  EXPECT_NEAR(floor, 3.5 * kG, 1e-9);
}

}  // namespace
}  // namespace obscura::sim
