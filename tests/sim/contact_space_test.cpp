// What touches in space: closed forms, and the plane's own results.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/solids.h"
#include "sim/solve/contact_solver.h"
#include "sim/space_rooms.h"
#include "sim/touching.h"
#include "sim/units.h"

namespace obscura::sim {
namespace {

World<3> floor_room(Vec3 gravity = {0, -kG, 0}) {
  World<3> world = space(gravity);
  world.model.rate = {600, 1};
  world.model.collision = Collision::contact;
  world.model.scale = 4;
  add_wall(world, {0, 0, 0}, {0, 1, 0});
  return world;
}

int add_box(World<3>& world, Vec3 size, Vec3 x, Vec3 v = Vec3::Zero(), Vec3 turn = Vec3::Zero(),
            double elasticity = 0) {
  return add_solid(world, brick(size), size.prod() * 1000, x, v, exponential(turn), Vec3::Zero(), elasticity);
}

void rub(World<3>& world, double mu) {
  for (Body<3>& body : world.model.bodies) body.friction = mu;
}

bool all_frozen(const State<3>& state) {
  return std::all_of(state.frozen.begin(), state.frozen.end(), [](char frozen) { return frozen != 0; });
}

// the plane's result and space's after so many steps
void expect_same(const World<2>& flat, const World<3>& deep, int steps, double tolerance) {
  const State<2> want = stepped(flat, steps);
  const State<3> is = stepped(deep, steps);
  for (std::size_t i = 0; i < want.x.size(); ++i) {
    EXPECT_NEAR((is.x[i].head<2>() - want.x[i]).norm(), 0, tolerance) << i;
    EXPECT_NEAR((is.v[i].head<2>() - want.v[i]).norm(), 0, tolerance * 10) << i;
    EXPECT_NEAR(is.x[i][2], 0, tolerance) << i;
    const Rotation<2> turn = rotation<2>(want.turn[i]);
    EXPECT_NEAR((rotation<3>(is.turn[i]).topLeftCorner<2, 2>() - turn).norm(), 0, tolerance) << i;
    EXPECT_NEAR((is.spin[i] - Vec3(0, 0, want.spin[i][0])).norm(), 0, tolerance * 10) << i;
  }
}

TEST(SpaceContact, ADroppedBoxRestsAndFreezes) {
  for (const Vec3& turn : {Vec3(0, 0, 0), Vec3(0, 0.7, 0), Vec3(0.4, 0.2, -0.3)}) {
    World<3> world = floor_room();
    add_box(world, {0.4, 0.2, 0.6}, {0, 0.6, 0}, {0.3, 0, -0.1}, turn, 0.2);
    rub(world, 0.5);
    State<3> state = world.state;
    Stepper<3> stepper(world.model);
    stepper.begin(state);
    int steps = 0;
    while (!all_frozen(state) && steps < 3000) {
      ASSERT_FALSE(stepper.step(state));
      ASSERT_GT(state.x[0][1], 0.09);
      ++steps;
    }
    EXPECT_LT(steps, 3000);
    // a face lies flat
    double flattest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      flattest = std::max(flattest, std::abs(rotation<3>(state.turn[0]).col(axis)[1]));
    }
    EXPECT_NEAR(flattest, 1, 1e-12);
    const State<3> before = state;
    for (int i = 0; i < 60; ++i) stepper.step(state);
    EXPECT_EQ(state.x, before.x);
    EXPECT_EQ(state.turn, before.turn);
    EXPECT_EQ(state.v[0], Vec3::Zero());
  }
}

TEST(SpaceContact, ABoxStopsAfterVSquaredOverTwoMuGInEveryDirection) {
  const double mu = 0.3, v = 1;
  for (int i = 0; i < 12; ++i) {
    const double angle = (30 * i + 7) * std::numbers::pi / 180;
    const Vec3 way(std::cos(angle), 0, std::sin(angle));
    World<3> world = floor_room();
    add_box(world, {0.4, 0.1, 0.4}, {0, 0.05, 0}, v * way);
    rub(world, mu);
    const State<3> now = stepped(world, 400);
    EXPECT_NEAR((now.x[0] - Vec3(0, 0.05, 0) - v * v / (2 * mu * kG) * way).norm(), 0, 1e-9) << i;
    EXPECT_EQ(now.v[0], Vec3::Zero()) << i;
  }
}

TEST(SpaceContact, ABoxHoldsOnASlopeUpToAtanMu) {
  const double mu = 0.4, steep = std::atan(mu), hair = 0.01 * std::numbers::pi / 180;
  for (const double side : {-1.0, 1.0}) {
    for (const double heading : {0.0, 0.5, 2.2}) {
      const double slope = steep + side * hair;
      World<3> world = floor_room(kG * Vec3(std::sin(slope) * std::cos(heading), -std::cos(slope),
                                            std::sin(slope) * std::sin(heading)));
      add_box(world, {0.4, 0.1, 0.4}, {0, 0.05, 0});
      rub(world, mu);
      const State<3> now = stepped(world, 600);
      const double a = kG * (std::sin(slope) - mu * std::cos(slope));
      const Vec3 want =
          side > 0 ? Vec3(0.5 * a * Vec3(std::cos(heading), 0, std::sin(heading))) : Vec3(0, 0, 0);
      EXPECT_NEAR((now.x[0] - Vec3(0, 0.05, 0) - want).norm(), 0, 1e-10) << side << " " << heading;
      EXPECT_EQ(all_frozen(now), side < 0);
    }
  }
}

TEST(SpaceContact, ABallThatSlidesRollsAtFiveSevenths) {
  World<3> world = floor_room();
  const Vec3 way = Vec3(2, 0, 1).normalized();
  add_solid(world, ball_shape<3>(0.2), 3, {0, 0.2, 0}, way);
  rub(world, 0.3);
  const State<3> now = stepped(world, 600);
  EXPECT_NEAR((now.v[0] - 5.0 / 7 * way).norm(), 0, 1e-10);
  EXPECT_NEAR((now.spin[0] - Vec3(0, 1, 0).cross(5.0 / 7 / 0.2 * way)).norm(), 0, 1e-9);
  // it slid for 2 v / (7 mu g), over 12 v^2 / (49 mu g)
  const double slid = 12 / (49 * 0.3 * kG), t = 2 / (7 * 0.3 * kG);
  EXPECT_NEAR((now.x[0] - Vec3(0, 0.2, 0) - (slid + 5.0 / 7 * (1 - t)) * way).norm(), 0, 1e-9);
}

TEST(SpaceContact, ElasticBallsTradeTheirSpeedAlongTheirCentres) {
  World<3> world = space(Vec3::Zero());
  world.model.collision = Collision::contact, world.model.rate = {600, 1};
  const Vec3 n = Vec3(3, -2, 6) / 7;
  add_solid(world, ball_shape<3>(0.1), 1, {0, 0, 0}, {1, 0.5, 2});
  add_solid(world, ball_shape<3>(0.1), 1, 0.2 * n + 0.1 * Vec3(1, 0.5, 2));
  const State<3> now = stepped(world, 120);
  const double along = Vec3(1, 0.5, 2).dot(n);
  EXPECT_NEAR((now.v[1] - along * n).norm(), 0, 1e-8);
  EXPECT_NEAR((now.v[0] + now.v[1] - Vec3(1, 0.5, 2)).norm(), 0, 1e-13);
  EXPECT_NEAR(now.v[0].squaredNorm() + now.v[1].squaredNorm(), 5.25, 1e-12);
}

TEST(SpaceContact, AStackOfFiveStandsAndFreezes) {
  World<3> world = floor_room();
  for (int i = 0; i < 5; ++i) {
    add_box(world, {0.4, 0.2, 0.4}, {0.03 * (i % 2), 0.1 + 0.2 * i, -0.02 * i}, Vec3::Zero(),
            {0, 0.3 * i, 0});
  }
  rub(world, 0.5);
  const State<3> now = stepped(world, 300);
  EXPECT_TRUE(all_frozen(now));
  for (int i = 0; i < 5; ++i) EXPECT_NEAR((now.x[i] - world.state.x[i]).norm(), 0, 1e-9) << i;
  // the floor carries all of it
  double carried = 0;
  for (const Contact<3>& contact : now.contacts) {
    if (contact.key.b < 0) carried += contact.force[1];
  }
  EXPECT_NEAR(carried, 5 * 32 * kG, 1e-7);
}

TEST(SpaceContact, APlanarBoxMovesAsInThePlane) {
  // flight, an impact with friction, sliding, rest
  World<2> flat = touching_room();
  flat.model.walls.push_back({{0, 0}, {0, 1}, {}, {}});
  add_box(flat, {0.4, 0.2}, 2, {0, 0.5}, {0.8, 0}, 0.4, 1.5, 0.3);
  rub(flat, 0.4);
  const World<3> deep = extruded(flat, 0.5);
  for (const int steps : {30, 200, 600, 1200}) expect_same(flat, deep, steps, 1e-9);
}

TEST(SpaceContact, PlanarBoxesPushEachOtherAsInThePlane) {
  World<2> flat = touching_room();
  flat.model.walls.push_back({{0, 0}, {0, 1}, {}, {}});
  add_box(flat, {0.4, 0.2}, 2, {0, 0.1}, {2, 0}, 0, 0, 0.5);
  add_box(flat, {0.2, 0.3}, 1, {0.6, 0.15}, {0, 0}, 0, 0, 0.5);
  rub(flat, 0.3);
  const World<3> deep = extruded(flat, 0.5);
  for (const int steps : {60, 300, 600}) expect_same(flat, deep, steps, 1e-9);
}

TEST(SpaceContact, PlanarPendulumsOfHingesAndBallJointsSwingAsInThePlane) {
  World<2> flat = touching_room();
  add_box(flat, {0.02, 1}, 1, {0.5, 0}, {0, 0}, std::numbers::pi / 2);
  add_box(flat, {0.02, 1}, 1, {1.5, 0}, {0, 0}, std::numbers::pi / 2);
  for (const auto& [a, b] : {std::pair<End<2>, End<2>>{{0, {0, 0.5}}, {-1, {0, 0}}},
                             std::pair<End<2>, End<2>>{{1, {0, 0.5}}, {0, {0, -0.5}}}}) {
    Joint<2> joint;
    joint.a = a, joint.b = b;
    flat.model.joints.push_back(joint);
  }
  World<3> deep = extruded(flat, 0.1);
  for (Joint<3>& joint : deep.model.joints) joint.turn.setZero();
  expect_same(flat, deep, 1800, 1e-9);
  for (Joint<3>& joint : deep.model.joints) joint.kind = JointKind::pin;
  expect_same(flat, deep, 1800, 1e-9);
}

}  // namespace
}  // namespace obscura::sim
