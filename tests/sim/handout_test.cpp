// Collisions as the handout has them, §2.3 to §2.5, §3.5.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/reference.h"
#include "sim/rooms.h"

namespace obscura::sim {
namespace {

// so short a step that gravity and turning within it are rounding
constexpr int kInstant = 1000000000;

TEST(Impact, OfAParticleReversesTheNormalSpeed) {
  for (const double e : {0.0, 0.5, 1.0}) {
    World<2> world = room({0, 0});
    world.model.rate = {kInstant, 1};
    const Vec2 n = Vec2(3, 4) / 5, along(-n[1], n[0]);
    add_wall(world, {1, 2}, n);
    add_particle(world, Vec2(1, 2) + 0.7 * along - 1e-9 * n, 2 * along - 3 * n, 0.5, e);
    const auto now = stepped(world, 1);
    EXPECT_NEAR(now.v[0].dot(n), 3 * e, 1e-14);
    EXPECT_NEAR(now.v[0].dot(along), 2, 1e-14);
    EXPECT_NEAR((now.x[0] - Vec2(1, 2)).dot(n), 0, 1e-15) << "exactly on the wall";
    EXPECT_NEAR((now.x[0] - Vec2(1, 2)).dot(along), 0.7 + 2e-9, 1e-15) << "displaced along the normal only";
    ASSERT_EQ(now.touches.size(), 1u);
    EXPECT_NEAR(now.touches[0].impulse.dot(n), 0.5 * (1 + e) * 3, 1e-14);
    EXPECT_NEAR(now.touches[0].impulse.dot(along), 0, 1e-15);
    EXPECT_NEAR(now.ledger.impacts, -0.5 * 0.5 * 9 * (1 - e * e), 1e-14);
  }
}

TEST(Impact, OfABallIsAtItsRim) {
  World<2> world = room({0, 0});
  world.model.rate = {kInstant, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {2, 0.25}, {1, -3}, 1, 0.5, 0.25);
  const auto now = stepped(world, 1);
  EXPECT_NEAR(now.x[0].y(), 0.25, 1e-16);
  EXPECT_EQ(now.v[0], Vec2(1, 1.5));
  ASSERT_EQ(now.touches.size(), 1u);
  EXPECT_NEAR(now.touches[0].point.y(), 0, 1e-16);
}

TEST(Impact, OfACornerIsTheHandoutsImpulse) {
  for (const auto& [e, key] : {std::pair{1.0, "box_corner_impact_2d_e1,"},
                               {0.5, "box_corner_impact_2d_e05,"},
                               {0.0, "box_corner_impact_2d_e0,"}}) {
    const auto want = closed_form({key});  // I; rx; ry; vn; J; vx; vy; omega; vn_after; dE
    World<2> world = room({0, 0});
    world.model.rate = {kInstant, 1};
    add_wall(world, {0, 0}, {0, 1});
    // the lowest corner lies 1e-10 above the floor and comes through in the step
    const double angle = std::acos(-1) / 6 - 2.0 / kInstant;
    add_box(world, {1, 0.5}, 2, {5, 1e-10 - want[2]}, {1, -3}, angle, 2, e);
    EXPECT_NEAR(world.model.bodies[0].inertia[0], want[0], 1e-15);
    const auto now = stepped(world, 1);
    ASSERT_EQ(now.touches.size(), 1u);
    const Vec2 arm = now.touches[0].point - now.x[0];
    EXPECT_NEAR(arm.x(), want[1], 1e-12);
    EXPECT_NEAR(arm.y(), want[2], 1e-12);
    EXPECT_NEAR(now.touches[0].point.y(), 0, 1e-15);
    EXPECT_NEAR(now.touches[0].impulse.y(), want[4], 1e-12);
    EXPECT_EQ(now.touches[0].impulse.x(), 0);
    EXPECT_NEAR(now.v[0].x(), want[5], 1e-12);
    EXPECT_NEAR(now.v[0].y(), want[6], 1e-12);
    EXPECT_NEAR(now.spin[0][0], want[7], 1e-12);
    EXPECT_NEAR(now.v[0].y() + now.spin[0][0] * arm.x(), want[8], 1e-12);
    EXPECT_NEAR(now.ledger.impacts, want[9], 1e-12);
  }
}

TEST(Impact, OfAFlatDropGainsNoSpin) {
  const auto want = closed_form({"flat_drop_simultaneous"});
  for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
    World<2> world = room({0, 0});
    world.model.rate = {kInstant, 1};
    add_wall(world, {0, 0}, {0, 1});
    const double half = turn == 0 || turn == 1 ? 0.25 : 0.5;
    add_box(world, {1, 0.5}, 2, {5, half + 5e-10}, {0, -1}, turn * std::acos(-1), 0, 0.5);
    const auto now = stepped(world, 1);
    EXPECT_NEAR(now.v[0].y(), want[0], 1e-14);
    EXPECT_NEAR(now.spin[0][0], want[1], 1e-14);
    ASSERT_EQ(now.touches.size(), 2u);
    EXPECT_NEAR(now.touches[0].impulse.y(), 1.5, 1e-13) << "each of two corners: m (1 + e) v / 2";
    EXPECT_NEAR(now.touches[1].impulse.y(), 1.5, 1e-13);
  }
}

TEST(Impact, OfAFlatDropThroughWholeStepsGainsNoSpin) {
  World<2> world = room();
  world.model.rate = {600, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {1, 0.5}, 2, {5, 1}, {0.3, 0}, 0, 0, 0.5);
  const auto now = stepped(world, 6000);
  EXPECT_EQ(now.spin[0][0], 0);
  EXPECT_EQ(now.turn[0][0], 0);
}

TEST(Impact, OfTwoCornersLeavesNoCornerMovingIn) {
  // both corners touch, one faster: v_n+ >= -e v_n- at both, with equality where pushed
  World<2> world = room({0, 0});
  world.model.rate = {kInstant, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {1, 0.5}, 2, {5, 0.25 + 2e-10}, {0, -1}, -0.3e-9, 0.3,
          0.5);  // corners at -1.15 and -0.85 m/s
  const auto now = stepped(world, 1);
  const double left = now.v[0].y() - 0.5 * now.spin[0][0], right = now.v[0].y() + 0.5 * now.spin[0][0];
  EXPECT_NEAR(left, 0.5 * 1.15, 1e-9);
  EXPECT_NEAR(right, 0.5 * 0.85, 1e-9);
}

TEST(Impact, OfAWallWithItsOwnElasticityTakesTheRootOfTheProduct) {
  World<2> world = room({0, 0});
  world.model.rate = {kInstant, 1};
  add_wall(world, {0, 0}, {0, 1});
  world.model.walls[0].elasticity = 0.36;
  add_particle(world, {0, 0}, {0, -1}, 1, 0.25);
  EXPECT_NEAR(stepped(world, 1).v[0].y(), 0.3, 1e-15);
}

TEST(WrongSide, AndMovingInGetsNoImpulse) {
  World<2> world = room({0, 0});
  add_walls(world, 4, 3);
  add_particle(world, {1, -0.5}, {0, 1});
  add_box(world, {0.4, 0.2}, 1, {2, -0.5}, {0, 1}, 0.3);
  const auto now = stepped(world, 100);
  EXPECT_NEAR(now.x[0].y(), -0.4, 1e-14);
  EXPECT_NEAR(now.x[1].y(), -0.4, 1e-14);
  EXPECT_EQ(now.v[0], Vec2(0, 1));
  EXPECT_EQ(now.v[1], Vec2(0, 1));
  EXPECT_TRUE(now.touches.empty());
}

TEST(WrongSide, OnlyWhatMovesOutOfTheBoxIsPutBack) {
  // a box deep in the floor, its left corner moving in, its right one moving out: that one is put on the
  // floor
  World<2> world = room({0, 0});
  world.model.rate = {kInstant, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {1, 0.5}, 2, {5, 0.2}, {0, 0}, 0, -2);
  const auto now = stepped(world, 1);
  ASSERT_EQ(now.touches.size(), 1u);
  EXPECT_NEAR(now.touches[0].point.x(), 5.5, 1e-8);
  EXPECT_NEAR(now.touches[0].point.y(), 0, 1e-15);
}

TEST(RightSide, IsLeftAlone) {
  World<2> world = room({0, 0});
  add_walls(world, 4, 3);
  add_particle(world, {1, 0}, {1, 0});  // slides along the floor
  const auto now = stepped(world, 1000);
  EXPECT_EQ(now.v[0], Vec2(1, 0));
  EXPECT_EQ(now.ledger, Ledger{});
}

TEST(Corner, TurnsAParticleRound) {
  World<2> world = room({0, 0});
  world.model.rate = {10, 1};
  add_walls(world, 4, 3);
  add_particle(world, {0.05, 0.02}, {-1, -2}, 1, 0.5);
  const auto now = stepped(world, 1);
  EXPECT_EQ(now.x[0], Vec2(0, 0)) << "inside both";
  EXPECT_EQ(now.v[0], Vec2(0.5, 1));
  EXPECT_EQ(now.touches.size(), 2u);
}

TEST(Corner, TurnsABoxRound) {
  World<2> world = room({0, 0});
  world.model.rate = {10, 1};
  add_walls(world, 4, 3);
  add_box(world, {0.4, 0.2}, 1, {0.25, 0.12}, {-1, -2}, 0, 0, 0.5);
  const auto now = stepped(world, 1);
  // both corners of a side strike together, at either wall
  EXPECT_NEAR(now.x[0].x(), 0.2, 1e-15);
  EXPECT_NEAR(now.x[0].y(), 0.1, 1e-15);
  EXPECT_NEAR(now.v[0].x(), 0.5, 1e-14);
  EXPECT_NEAR(now.v[0].y(), 1, 1e-14);
  EXPECT_NEAR(now.spin[0][0], 0, 1e-14);
}

// a wedge of `angle` that opens upwards, its edge at the origin
World<2> wedge(double angle) {
  World<2> world = room();
  world.model.rate = {600, 1};
  add_wall(world, {0, 0}, {std::cos(angle / 2), std::sin(angle / 2)});
  add_wall(world, {0, 0}, {-std::cos(angle / 2), std::sin(angle / 2)});
  return world;
}

double deepest(const World<2>& world, const State<2>& state, int body) {
  double depth = 0;
  const auto at = body_motion(state, body);
  for (const auto& wall : world.model.walls) {
    const Shape<2>& shape = world.model.bodies[body].shape;
    const Box<2>* box = form<Box<2>>(shape);
    if (!box) depth = std::max(depth, -(at.x - wall.point).dot(wall.normal));
    for (int i = 0; box && i < 4; ++i) {
      depth = std::max(depth, -(at.x + at.arm(box->corner(i)) - wall.point).dot(wall.normal));
    }
  }
  return depth;
}

TEST(Wedge, HoweverNarrowEnds) {
  for (const double angle : {1.0, 0.1, 0.01, 1e-4}) {
    for (const double e : {0.0, 0.7, 1.0}) {
      World<2> world = wedge(angle);
      add_particle(world, {0.1 * angle, 1}, {0.3, -1}, 1, e);
      State<2> state = world.state;
      Stepper<2> stepper(world.model);
      stepper.begin(state);
      for (int i = 0; i < 1200; ++i) {
        ASSERT_FALSE(stepper.step(state));
        if (state.touches.empty()) continue;
        ASSERT_LT(deepest(world, state, 0), 1e-11) << angle << ' ' << e << ' ' << i;
      }
      EXPECT_TRUE(state.x[0].allFinite());
    }
  }
}

TEST(Wedge, EndsForABox) {
  for (const double angle : {1.0, 0.3, 0.05}) {
    for (const double e : {0.0, 1.0}) {
      World<2> world = wedge(angle);
      add_box(world, {0.2, 0.1}, 1, {0, 0.4 / angle}, {0.3, -1}, 0.4, 1, e);
      State<2> state = world.state;
      Stepper<2> stepper(world.model);
      stepper.begin(state);
      for (int i = 0; i < 1200; ++i) ASSERT_FALSE(stepper.step(state)) << angle << ' ' << e << ' ' << i;
      EXPECT_GT(state.x[0].y(), 0);
      EXPECT_LT(deepest(world, state, 0), 0.05);
    }
  }
}

TEST(Slit, NarrowerThanTheBoxEnds) {
  World<2> world = room();
  add_wall(world, {0, 0}, {1, 0}), add_wall(world, {0.1, 0}, {-1, 0}), add_wall(world, {0, 0}, {0, 1});
  add_box(world, {0.2, 0.1}, 1, {0.05, 0.3}, {0.3, -1}, 0.4, 1, 0.5);
  add_particle(world, {0, 0}, {0, 0});
  std::swap(world.model.bodies[0], world.model.bodies[1]);
  std::swap(world.state.x[0], world.state.x[1]);
  std::swap(world.state.v[0], world.state.v[1]);
  EXPECT_TRUE(stepped(world, 3000).x[1].allFinite());
}

TEST(Bounce, WithoutElasticityComesToRest) {
  World<2> world = room();
  add_walls(world, 4, 3);
  add_particle(world, {1, 1}, {1, 0}, 1, 0);
  add_box(world, {0.4, 0.2}, 1, {2, 1}, {0, 0}, 0.3, 0, 0);
  const auto now = stepped(world, 5000);
  EXPECT_NEAR(now.x[0].y(), 0, 1e-15);
  EXPECT_NEAR(now.v[0].y(), 0, 1e-15);
  EXPECT_LT(std::fabs(now.v[1].y()), 0.02);
  EXPECT_NEAR(now.x[1].y(), 0.1, 1e-3);
}

TEST(Bounce, OfAParticleConservesEnergyButForTheLedger) {
  for (const double e : {1.0, 0.7, 0.0}) {
    World<2> world = room();
    add_walls(world, 4, 3);
    for (int i = 0; i < 20; ++i)
      add_particle(world, {0.1 + 0.19 * i, 0.5 + 0.1 * i}, {3 - 0.4 * i, 0.7 * i - 5}, 1 + 0.1 * i, e,
                   0.01 * (i % 3));
    for (int i = 0; i < 8; ++i)
      add_box(world, {0.4, 0.1 + 0.05 * i}, 1 + i, {0.5 + 0.4 * i, 1.5}, {2.0 - i, 1}, 0.4 * i, 3 - i, e);
    const auto all = run(world);
    const double start = shown(*all, {0, 1}).energies.total();
    for (int t = 1; t <= 10; ++t) {
      const auto now = shown(*all, {t, 1}).energies;
      // rounding of a few hundred joules in ten thousand steps
      EXPECT_NEAR(now.total() - start, now.displacement + now.impacts, 1e-9);
      EXPECT_LE(now.impacts, 1e-11);
      EXPECT_LT(now.impacts, e < 1 ? -1 : 1e-10);
      EXPECT_GT(now.impacts, e < 1 ? -start - now.displacement : -1e-10);
    }
  }
}

TEST(Bounce, OfATiedBodyCountsItsSpringInTheLedger) {
  // RK4 at 1/4000 holds this spring's energy to 1e-9
  World<2> world = room();
  world.model.rate = {4000, 1};
  add_walls(world, 4, 3);
  add_particle(world, {1, 0.5}, {1, -2}, 1, 1);
  add_box(world, {0.4, 0.2}, 1, {2, 0.5}, {0, -1}, 0.3, 0, 1);
  add_spring(world, {0, {0, 0}}, {1, {0.2, 0.1}}, 40, 0.5);
  const auto all = run(world);
  const double start = shown(*all, {0, 1}).energies.total();
  const auto now = shown(*all, {5, 1}).energies;
  EXPECT_GT(std::fabs(now.displacement), 1e-4);
  EXPECT_NEAR(now.total() - start, now.displacement + now.impacts, 1e-8);
}

// the height after a bounce is off by the depth at which the step ended: O(h). One drop lands anywhere within
// its step; the mean over many drops shows the order
TEST(Bounce, HeightsConvergeWithTheFirstOrderOfTheStep) {
  const auto error = [](int rate, double e, int bounces) {
    const int many = 200;
    World<2> world = room();
    world.model.rate = {rate, 1};
    add_wall(world, {0, 0}, {0, 1});
    for (int i = 0; i < many; ++i) add_particle(world, {0, 1 + 0.002 * i}, {0, 0}, 1, e);
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    std::vector<int> seen(many);
    double sum = 0;
    int done = 0;
    while (done < many) {
      EXPECT_FALSE(stepper.step(state));
      for (const auto& touch : state.touches) {
        if (++seen[touch.body] != bounces) continue;
        const double apex = state.x[touch.body].y() + state.v[touch.body].squaredNorm() / (2 * 9.81);
        const double exact = (1 + 0.002 * touch.body) * std::pow(e, 2 * bounces);
        sum += std::fabs(apex / exact - 1), ++done;
      }
    }
    return sum / many;
  };
  for (const double e : {0.9, 0.5}) {
    for (const int bounces : {1, 3}) {
      const double coarse = error(250, e, bounces), fine = error(4000, e, bounces);
      EXPECT_NEAR(std::log2(coarse / fine) / 4, 1, 0.1) << e << ' ' << bounces;
      // a bounce gains the depth, v h / 2 in the mean: the third at e = 0.5 gains 1.4e-4 of 0.016 m from its
      // own alone
      EXPECT_LT(fine, 5e-3);
    }
  }
}

TEST(Bounce, HeightsAreThoseOfTheClosedForm) {
  for (const auto& [n, key] :
       {std::pair{1, "bounce n=1 "}, {2, "bounce n=2 "}, {3, "bounce n=3 "}, {5, "bounce n=5 "}}) {
    const double want = closed_form({key, "h=1 e=0.9"})[0];
    World<2> world = room();
    world.model.rate = {100000, 1};
    add_wall(world, {0, 0}, {0, 1});
    add_particle(world, {0, 1}, {0, 0}, 1, 0.9);
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int seen = 0; seen < n;) {
      ASSERT_FALSE(stepper.step(state));
      seen += int(state.touches.size());
    }
    const double apex = state.x[0].y() + state.v[0].squaredNorm() / (2 * 9.81);
    EXPECT_NEAR(apex, want, n * 4.5e-5);  // v h a bounce
  }
}

// what the handout promises, in rooms of random walls: afterwards nobody is on the wrong side and moves the
// wrong way
TEST(Bounce, LeavesNobodyOutsideAndMovingOut) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    World<2> world = room(Vec2(2 * unit(random) - 1, -9.81));
    world.model.rate = {trial % 2 ? 60 : 600, 1};
    const int walls = 3 + trial % 6;
    for (int i = 0; i < walls; ++i) {
      // around a middle of radius 1 to 2
      const double angle = 2 * std::acos(-1) * (i + 0.4 * unit(random)) / walls, far = 1 + unit(random);
      const Vec2 out(std::cos(angle), std::sin(angle));
      add_wall(world, far * out, -out);
      if (trial % 3 == 0) world.model.walls.back().elasticity = unit(random);
    }
    for (int i = 0; i < 5; ++i) {
      add_particle(world, Vec2(unit(random) - 0.5, unit(random) - 0.5),
                   Vec2(8 * unit(random) - 4, 8 * unit(random) - 4), 1, unit(random), i % 2 * 0.1);
    }
    for (int i = 0; i < 5; ++i) {
      add_box(world, Vec2(0.1 + 0.5 * unit(random), 0.1 + 0.5 * unit(random)), 1 + unit(random),
              Vec2(unit(random) - 0.5, unit(random) - 0.5), Vec2(8 * unit(random) - 4, 8 * unit(random) - 4),
              6 * unit(random), 20 * unit(random) - 10, unit(random));
    }
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 600; ++i) {
      ASSERT_FALSE(stepper.step(state));
      for (int body = 0; body < 10; ++body) {
        const auto at = body_motion(state, body);
        const Shape<2>& shape = world.model.bodies[body].shape;
        for (const auto& wall : world.model.walls) {
          for (int k = 0; k < (body < 5 ? 1 : 4); ++k) {
            const Vec2 arm =
                body < 5 ? Vec2(-*round_radius(shape) * wall.normal) : at.arm(form<Box<2>>(shape)->corner(k));
            const double distance = (at.x + arm - wall.point).dot(wall.normal);
            const double speed = at.velocity(arm).dot(wall.normal);
            ASSERT_FALSE(distance < -1e-12 && speed < -1e-10)
                << trial << ' ' << i << ' ' << body << ' ' << distance << ' ' << speed;
          }
        }
      }
    }
  }
}

TEST(Bounce, IsTheMirrorImageInAMirroredRoom) {
  // mirrored at x = 0, where no rounding differs: to the bit
  const auto make = [](double side) {
    World<2> world = room();
    const Vec2 flip(side, 1);
    add_wall(world, Vec2(0, 0).cwiseProduct(flip), Vec2(0.2, 1).cwiseProduct(flip));
    add_wall(world, Vec2(-1, 0).cwiseProduct(flip), Vec2(1, 0.1).cwiseProduct(flip));
    add_wall(world, Vec2(2, 0).cwiseProduct(flip), Vec2(-1, 0).cwiseProduct(flip));
    add_particle(world, Vec2(0.5, 2).cwiseProduct(flip), Vec2(3, 1).cwiseProduct(flip), 1, 0.9, 0.05);
    add_particle(world, Vec2(0.1, 2).cwiseProduct(flip), Vec2(2, 1).cwiseProduct(flip), 1, 0.8);
    add_spring(world, {0, {0, 0}}, {1, {0, 0}}, 30, 0.5, 0.1);
    return world;
  };
  const auto a = stepped(make(1), 5000), b = stepped(make(-1), 5000);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(a.x[i], b.x[i].cwiseProduct(Vec2(-1, 1)));
    EXPECT_EQ(a.v[i], b.v[i].cwiseProduct(Vec2(-1, 1)));
  }
}

TEST(Bounce, OfABoxIsTheMirrorImageInAMirroredRoom) {
  const auto make = [](double side) {
    World<2> world = room();
    const Vec2 flip(side, 1);
    add_wall(world, {0, 0}, Vec2(0.2, 1).cwiseProduct(flip));
    add_wall(world, Vec2(-1, 0).cwiseProduct(flip), Vec2(1, 0.1).cwiseProduct(flip));
    add_wall(world, Vec2(2, 0).cwiseProduct(flip), Vec2(-1, 0).cwiseProduct(flip));
    add_box(world, {0.4, 0.3}, 2, Vec2(0.5, 2).cwiseProduct(flip), Vec2(3, 1).cwiseProduct(flip), side * 0.3,
            side * 2, 0.8);
    return world;
  };
  // corners are numbered in the body's frame, so sums run in another order: rounding, grown by some twenty
  // impacts
  const auto a = stepped(make(1), 2000), b = stepped(make(-1), 2000);
  EXPECT_NEAR(a.x[0].x(), -b.x[0].x(), 1e-9);
  EXPECT_NEAR(a.x[0].y(), b.x[0].y(), 1e-9);
  EXPECT_NEAR(a.turn[0][0], -b.turn[0][0], 1e-9);
}

TEST(Touches, AreAllOfTheLastWholeStep) {
  // the script cuts the step in four; the box bounces in the first quarter, the particle in the last
  World<2> world = room({0, 0});
  world.model.rate = {10, 1};
  add_wall(world, {0, 0}, {0, 1});
  add_particle(world, {0, 0.9}, {0, -10});
  add_particle(world, {1, 0.1}, {0, -10});
  world.model.mice.push_back({{{{1, 40}, {5, 5}}, {{2, 40}, {5, 5}}, {{3, 40}, {5, 5}}}, 0, 0, 0});
  const auto now = stepped(world, 1);
  ASSERT_EQ(now.touches.size(), 2u);
  EXPECT_EQ(now.touches[0].body, 1);
  EXPECT_EQ(now.touches[1].body, 0);
}

TEST(Contacts, AreShownWithTheirGapAndImpulse) {
  World<2> world = room();
  add_walls(world, 4, 3);
  add_particle(world, {1, 0}, {0, -1}, 2, 0.5);
  const auto now = shown(*run(world), {1, 1000});
  ASSERT_EQ(now.contacts.size(), 1u);
  EXPECT_EQ(now.contacts[0].body, 0);
  EXPECT_EQ(now.contacts[0].wall, 0);
  EXPECT_EQ(now.contacts[0].normal, Vec3(0, 1, 0));
  EXPECT_NEAR(now.contacts[0].gap, 0, 1e-15);
  EXPECT_NEAR(now.contacts[0].impulse.y(), 2 * 1.5 * (1 + 0.00981), 1e-13);
}

}  // namespace
}  // namespace obscura::sim
