// What stands, stands without a bit of motion, and wakes when it has a reason to.

#include <gtest/gtest.h>

#include <cmath>

#include "sim/reference.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

State<2> on(const World<2>& world, State<2> state, int steps) {
  Stepper<2> stepper(world.model);
  for (int i = 0; i < steps; ++i) {
    if (auto trouble = stepper.step(state)) throw *trouble;
  }
  return state;
}

World<2> stack(int count, double size = 0.3) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  for (int i = 0; i < count; ++i) add_box(world, {size, size}, 1, {0, size * (i + 0.5)}, {0, 0}, 0, 0, 0);
  rub(world, 0.5);
  return world;
}

void expect_same_places(const State<2>& a, const State<2>& b) {
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.turn, b.turn);
}

TEST(ContactRest, AStackOfTenDoesNotMoveByABitInAMinute) {
  const World<2> world = stack(10);
  const State<2> early = stepped(world, 600);
  expect_same_places(early, on(world, early, 59 * 600));
}

TEST(ContactRest, EachInterfaceOfAStackCarriesTheWeightAbove) {
  for (const int n : {10, 20}) {
    const auto want = closed_form({"stack_contact_force", "n=" + std::to_string(n)});
    const World<2> world = stack(n, 0.15);
    const State<2> now = stepped(world, 5);
    for (int i = 0; i < n; ++i) {
      double force = 0;
      for (const auto& contact : now.contacts) {
        if (i == 0 && contact.key.b < 0) force += contact.force.y();
        if (i > 0 && contact.key.a == i - 1 && contact.key.b == i) force -= contact.force.y();
      }
      EXPECT_NEAR(force, want[0] * (n - i) / n, 1e-9 * want[0]) << i << " of " << n;
    }
  }
}

TEST(ContactRest, AHouseOfCardsStandsWithoutABitOfMotion) {
  // the shipped one: two leaning cards a bay, three bays, then two, then one
  const std::vector<Vec2> right = {{-0.222694266586674, 0},
                                   {-0.201410711137156, 0},
                                   {0, 0.553371380885632},
                                   {0, 0.582609424887263},
                                   {-0.0106417777247591, 0.582609424887263}};
  const std::vector<Vec2> left = {{0.0106417777247591, 0.582609424887263},
                                  {0, 0.582609424887263},
                                  {0, 0.553371380885632},
                                  {0.201410711137156, 0},
                                  {0.222694266586674, 0}};
  const double bay = 0.457388533173347, storey = 0.602609424887263;
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  for (int floor = 0; floor < 3; ++floor) {
    for (int i = 0; i < 3 - floor; ++i) {
      const Vec2 x(1.54261146682665 + bay * (i + 0.5 * floor), storey * floor);
      add_polygon(world, right, 0.04, x, {0, 0}, 0, 0, 0);
      add_polygon(world, left, 0.04, x, {0, 0}, 0, 0, 0);
      if (i + 1 < 3 - floor)
        add_box(world, {0.456588533173347, 0.02}, 0.03, x + Vec2(bay / 2, storey - 0.01), {0, 0}, 0, 0, 0);
    }
  }
  rub(world, 0.6);
  const State<2> early = stepped(world, 3000), late = on(world, early, 3000);
  expect_same_places(early, late);
  for (std::size_t i = 0; i < late.x.size(); ++i) {
    EXPECT_LT((late.x[i] - world.state.x[i]).norm(), 1e-4) << i;
    EXPECT_TRUE(late.frozen[i]) << i;
  }
}

TEST(ContactRest, AnArchOfVoussoirsStandsWithoutABitOfMotion) {
  // each stone is a wedge of 180/11 degrees; corners by turning, so that neighbours share them to rounding
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  const double step = std::acos(-1) / 11;
  for (int i = 0; i < 11; ++i) {
    const Vec2 one(std::cos(step * i), std::sin(step * i)),
        two(std::cos(step * (i + 1)), std::sin(step * (i + 1)));
    add_polygon(world, {1.65 * one, 2.25 * one, 2.25 * two, 1.65 * two}, 7, {0, 0}, {0, 0}, 0, 0, 0);
  }
  rub(world, 0.7);
  const State<2> early = stepped(world, 3000), late = on(world, early, 3000);
  expect_same_places(early, late);
  for (std::size_t i = 0; i < late.x.size(); ++i) EXPECT_LT((late.x[i] - world.state.x[i]).norm(), 1e-6) << i;
  EXPECT_LT(outside_cone(world, late), 1e-10);
  for (int i = 0; i < 11; ++i) EXPECT_NEAR((carried(late, i) - Vec2(0, 7 * kG)).norm(), 0, 1e-8) << i;
}

TEST(ContactRest, AnArchThatIsTooThinFalls) {
  // a semicircle stands only while its thickness is over 0.1075 of its radius
  for (const double thick : {0.08, 0.13}) {
    World<2> world = touching_room();
    add_wall(world, {0, 0}, {0, 1});
    const double step = std::acos(-1) / 11, in = 1.5 * (1 - thick / 2), out = 1.5 * (1 + thick / 2);
    for (int i = 0; i < 11; ++i) {
      const Vec2 one(std::cos(step * i), std::sin(step * i)),
          two(std::cos(step * (i + 1)), std::sin(step * (i + 1)));
      add_polygon(world, {in * one, out * one, out * two, in * two}, 7, {0, 0}, {0, 0}, 0, 0, 0);
    }
    rub(world, 0.9);
    const State<2> now = stepped(world, 600);
    const double sunk = world.state.x[5].y() - now.x[5].y();
    if (thick < 0.1) {
      EXPECT_GT(sunk, 0.01);
    } else {
      EXPECT_LT(sunk, 1e-6);
    }
  }
}

TEST(ContactRest, AHundredfoldWeightStandsOnTopAndBelow) {
  for (const bool heavy_above : {true, false}) {
    World<2> world = touching_room();
    add_wall(world, {0, 0}, {0, 1});
    add_box(world, {0.5, 0.3}, heavy_above ? 1 : 100, {0, 0.15}, {0, 0}, 0, 0, 0);
    add_box(world, {0.5, 0.3}, heavy_above ? 100 : 1, {0.1, 0.45}, {0, 0}, 0, 0, 0);
    rub(world, 0.5);
    const State<2> now = stepped(world, 600);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR((now.x[i] - world.state.x[i]).norm(), 0, 1e-9);
      EXPECT_TRUE(now.frozen[i]);
      EXPECT_NEAR((carried(now, i) - Vec2(0, kG * world.model.bodies[i].mass)).norm(), 0, 1e-7);
    }
  }
}

TEST(ContactRest, AHeavyBoxFallsOnALightOneAndRests) {
  for (const bool heavy_above : {true, false}) {
    World<2> world = touching_room();
    add_wall(world, {0, 0}, {0, 1});
    add_box(world, {0.5, 0.3}, heavy_above ? 1 : 100, {0, 0.25}, {0, 0}, 0, 0, 0.2);
    add_box(world, {0.5, 0.3}, heavy_above ? 100 : 1, {0.05, 0.9}, {0, 0}, 0, 0, 0.2);
    rub(world, 0.5);
    const State<2> now = stepped(world, 1200);
    EXPECT_TRUE(now.frozen[0] && now.frozen[1]);
    EXPECT_NEAR(now.x[0].y(), 0.15, 3e-7);  // 1e-6 of a size
    EXPECT_NEAR(now.x[1].y(), 0.45, 3e-7);
  }
}

TEST(ContactRest, DominoesFallOneAfterTheOther) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  constexpr int kStones = 8;
  for (int i = 0; i < kStones; ++i) add_box(world, {0.08, 0.6}, 1, {0.3 * i, 0.3}, {0, 0}, 0, 0, 0.1);
  rub(world, 0.5);
  world.state.spin[0][0] = -2, world.state.v[0] = {0.6, 0.08};  // about its lower right corner
  State<2> state = world.state;
  Stepper<2> stepper(world.model);
  stepper.begin(state);
  std::vector<int> fell(kStones, -1);
  for (int i = 0; i < 1800; ++i) {
    ASSERT_FALSE(stepper.step(state));
    for (int k = 0; k < kStones; ++k) {
      if (fell[k] < 0 && state.turn[k][0] < -0.3) fell[k] = i;
    }
  }
  for (int k = 0; k < kStones; ++k) {
    EXPECT_GE(fell[k], 0) << k;
    if (k > 0) {
      EXPECT_GT(fell[k], fell[k - 1]) << k;
    }
  }
}

TEST(ContactRest, ABeamOnTwoSupportsObeysTheLeverRule) {
  // on two corners of fixed diamonds the forces are determined
  for (const double at : {0.3, 1.0, 1.3}) {
    World<2> world = touching_room();
    const double half = 0.2, reach = half * std::sqrt(2), turn = std::acos(-1) / 4;
    add_box(world, {2 * half, 2 * half}, 1, {0, 1 - reach}, {0, 0}, turn);
    add_box(world, {2 * half, 2 * half}, 1, {1.5, 1 - reach}, {0, 0}, turn);
    add_box(world, {4, 0.1}, 6, {at, 1.05}, {0, 0}, 0, 0, 0);
    world.model.bodies[0].fixed = world.model.bodies[1].fixed = true;
    rub(world, 0.5);
    const State<2> now = stepped(world, 10);
    double force[2] = {0, 0};
    for (const auto& contact : now.contacts) force[contact.key.a] -= contact.force.y();
    EXPECT_NEAR(force[0], 6 * kG * (1.5 - at) / 1.5, 1e-9) << at;
    EXPECT_NEAR(force[1], 6 * kG * at / 1.5, 1e-9) << at;
  }
}

// a heap of whatever, dropped
World<2> heap(int seed, int count) {
  Chance chance(std::uint64_t(seed) + 77);
  World<2> world = touching_room();
  add_walls(world, 2.4, 6);
  for (int i = 0; i < count; ++i) {
    const Vec2 x(0.4 + 0.8 * (i % 3) + chance.between(-0.05, 0.05), 0.5 + 0.7 * (i / 3));
    const double e = chance.between(0, 0.3), angle = chance.between(-3, 3);
    if (i % 4 == 0) {
      add_ball(world, chance.between(0.1, 0.25), 1, x, {0, 0}, 0, e);
    } else if (i % 4 == 1) {
      add_polygon(world, odd_polygon(chance, 3 + i % 5, 0.28), 1.5, x, {0, 0}, angle, 0, e);
    } else {
      // one after another: compilers differ in which argument they take first
      const double mass = chance.between(0.5, 3);
      add_box(world, {chance.between(0.2, 0.5), chance.between(0.15, 0.35)}, mass, x, {0, 0}, angle, 0, e);
    }
  }
  rub(world, 0.5);
  return world;
}

TEST(ContactRest, ForcesInRandomHeapsObeyTheConeAtEveryInstant) {
  for (int seed = 0; seed < 4; ++seed) {
    const World<2> world = heap(seed, 9);
    State<2> state = world.state;
    Stepper<2> stepper(world.model);
    stepper.begin(state);
    for (int i = 0; i < 1200; ++i) {
      ASSERT_FALSE(stepper.step(state));
      ASSERT_LT(outside_cone(world, state), 1e-10) << seed << " at step " << i;
    }
  }
}

TEST(ContactRest, HeapsComeToRestAndLieInEachOtherByAMillionthAtMost) {
  // 3: two islands that touch and bear nothing come to rest one after the other
  for (const int seed : {0, 2, 3}) {
    const World<2> world = heap(seed, 9);
    const State<2> now = stepped(world, 4200);
    EXPECT_LT(deepest(now), 3e-7) << seed;
    for (int i = 0; i < 9; ++i) {
      EXPECT_TRUE(now.frozen[i]) << seed << ' ' << i << ' ' << now.v[i].norm();
      EXPECT_NEAR((carried(now, i) - Vec2(0, kG * world.model.bodies[i].mass)).norm(), 0, 1e-7) << seed;
    }
    expect_same_places(now, on(world, now, 600));
  }
}

TEST(ContactRest, AThrownBallWakesAStack) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  for (int i = 0; i < 3; ++i) add_box(world, {0.3, 0.3}, 1, {0, 0.15 + 0.3 * i}, {0, 0}, 0, 0, 0);
  // it takes a second to get there, and comes down again to where it was
  add_ball(world, 0.1, 2, {-4.25, 0.75}, {4, 0.5 * kG}, 0, 0);
  rub(world, 0.4);
  const State<2> before = stepped(world, 480);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(before.frozen[i]) << i;
  const State<2> after = on(world, before, 180);
  EXPECT_FALSE(after.frozen[2]);
  EXPECT_GT(after.x[2].x(), 0.02);
}

TEST(ContactRest, AMousePullsASupportAwayAndWhatStoodOnItFalls) {
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {0.3, 0.3}, 1, {0, 0.15}, {0, 0}, 0, 0, 0);
  add_box(world, {0.3, 0.3}, 0.2, {0, 0.45}, {0, 0}, 0, 0, 0);
  rub(world, 0.1);
  world.model.mice.push_back({{{{1, 1}, {0.15, 0.1}}, {{6, 5}, {2, 0.1}}}, 0, 400, 2});
  const State<2> before = stepped(world, 590);
  EXPECT_TRUE(before.frozen[0] && before.frozen[1]);
  const State<2> after = stepped(world, 1200);
  EXPECT_GT(after.x[0].x(), 1);
  EXPECT_LT(after.x[1].y(), 0.4);
}

TEST(ContactRest, ASpringPullsWhatRestedUntilSomethingElseLetGo) {
  // a body at rest on the floor, tied to one that is thrown up: it stays until the spring lifts it
  World<2> world = touching_room();
  add_wall(world, {0, 0}, {0, 1});
  add_box(world, {0.3, 0.3}, 1, {0, 0.15}, {0, 0}, 0, 0, 0);
  add_box(world, {0.2, 0.2}, 4, {0, 0.5}, {0, 8}, 0, 0, 0);
  add_spring(world, {0, {0, 0}}, {1, {0, 0}}, 60, 0.35);
  rub(world, 0.5);
  const State<2> now = stepped(world, 360);
  EXPECT_GT(now.x[0].y(), 0.3);
}

}  // namespace
}  // namespace obscura::sim
