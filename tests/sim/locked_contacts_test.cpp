// Contacts along whose normals joints leave nothing to move: which part of the load they bear is not
// determined, but neither they nor the joints bear more than all of it, and none pulls.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/jointed.h"
#include "sim/space_rooms.h"
#include "sim/touching.h"

namespace obscura::sim {
namespace {

// Steps, and tells the least part of the load, N, that the first joint or the floor bears, upwards, of all
// steps but the first: below zero one presses against the other.
template <int D>
double least_share(const World<D>& world, int steps) {
  State<D> state = world.state;
  Stepper<D> stepper(world.model);
  stepper.begin(state);
  double least = 1e300;
  for (int i = 0; i < steps; ++i) {
    EXPECT_FALSE(stepper.step(state)) << i;
    if (i == 0) continue;
    double floor = 0;
    for (const Contact<D>& contact : state.contacts) floor += contact.force[1];
    least = std::min({least, floor, state.joint_forces[0][1]});
  }
  return least;
}

// A triangle that falls over about its lowest corner, which a pin holds on the floor. By as much as rows of
// the middle of the step differ from those of its beginning the floor pushed against the pin in each step,
// and the more the longer.
TEST(LockedContacts, APinOnTheFloorAndTheFloorShareTheLoad) {
  for (const int rate : {240, 600, 2400}) {
    World<2> world = touching_room();
    world.model.solver = Solver::iterative, world.model.rate = {rate, 1};
    world.model.walls = {{{0, 0}, {0, 1}, 0, 0}};
    add_polygon(world, {{0, 0}, {0.3, 0.8}, {-0.3, 0.8}}, 1, {0, 0}, {0, 0}, 0.05, 0, 0);
    world.model.joints = {pin({0, form<Polygon>(world.model.bodies[0].shape)->vertices[0]}, {-1, {0, 0}})};
    EXPECT_GT(least_share(world, rate / 3), 1) << rate << ", N of 9.81";
  }
}

// A top on its tip: of 98 N the pivot pulled with 39 to 8500 N, and the floor pressed with as much more.
TEST(LockedContacts, APivotOnTheFloorAndTheFloorShareTheLoadOfATop) {
  for (const int rate : {240, 600, 2400}) {
    World<3> world = space();
    world.model.solver = Solver::iterative, world.model.collision = Collision::contact;
    world.model.rate = {rate, 1}, world.model.scale = 2;
    world.model.walls = {{{0, 0, 0}, {0, 1, 0}, 0, 0}};
    const double lean = 18 * std::numbers::pi / 180, height = 0.45;
    const Vec3 tip(0, -height, 0), axis(0, std::cos(lean), std::sin(lean));
    add_solid(world,
              hull_solid({tip, {0.3, 0.15, 0.3}, {-0.3, 0.15, 0.3}, {0.3, 0.15, -0.3}, {-0.3, 0.15, -0.3}}),
              10, height * axis, {0, 0, 0}, exponential(Vec3(lean, 0, 0)), 44 * axis, 0);
    Joint<3> pivot;
    pivot.a = {0, tip}, pivot.b = {-1, {0, 0, 0}};
    world.model.joints = {pivot};
    EXPECT_GT(least_share(world, rate / 4), 10) << rate << ", N of 98.1";
  }
}

// A crate that is welded to the room and stands on the floor, and another on it, which moves: both corners
// below bear the same, the weld not less, together the weight of both.
TEST(LockedContacts, AWeldAndTheFloorShareWhatStandsOnThem) {
  World<2> world = touching_room();
  world.model.solver = Solver::iterative;
  world.model.walls = {{{0, 0}, {0, 1}, 0, 0.5}};
  add_box(world, {1, 1}, 2, {0, 0.5}, {0, 0}, 0, 0, 0),
      add_box(world, {0.5, 0.5}, 1, {0, 1.25}, {0, 0}, 0, 0, 0);
  rub(world, 0.5);
  Joint<2> weld = pin({0, {0, 0}}, {-1, {0, 0.5}});
  weld.kind = JointKind::weld;
  world.model.joints = {weld};
  // so that nothing sleeps
  world.state.v[1] = {0.5, 0};
  const State<2> now = stepped(world, 20);
  double floor = 0;
  std::vector<double> corners;
  for (const Contact<2>& contact : now.contacts)
    if (contact.key.b < 0 && contact.gap < 0.1)
      corners.push_back(contact.force[1]), floor += contact.force[1];
  ASSERT_EQ(corners.size(), 2u);
  EXPECT_NEAR(corners[0] + corners[1] + now.joint_forces[0][1], 3 * 9.81, 1e-6);
  EXPECT_GT(std::min(corners[0], corners[1]), 1);
  EXPECT_GT(now.joint_forces[0][1], 1);
}

}  // namespace
}  // namespace obscura::sim
