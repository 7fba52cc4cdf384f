// Which linkages no step can move: those whose joints leave them motions to the first order alone.

#include "sim/motion/infinitesimal_motion.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "sim/jointed.h"
#include "sim/space_rooms.h"

namespace obscura::sim {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kRight = std::numbers::pi / 2;

World<2> empty_plane() { return touching_room(Collision::contact, {0, -9.81}); }

// bars from point to point on pins, on pins of the room at both ends
void add_chain(World<2>& world, const std::vector<Vec2>& points) {
  End<2> last{-1, points[0]};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec2 half((points[i] - points[i - 1]).norm() / 2, 0);
    const int bar = add_bar(world, points[i - 1], points[i]);
    world.model.joints.push_back(pin({bar, Vec2(-half)}, last));
    last = {bar, half};
  }
  world.model.joints.push_back(pin(last, {-1, points.back()}));
}

// of `links` links, turned by an angle; it sags by so much, m
World<2> chain(int links, double angle, double sag) {
  World<2> world = empty_plane();
  std::vector<Vec2> points;
  for (int i = 0; i <= links; ++i) {
    const double along = 0.3 * i, across = -sag * std::sin(std::numbers::pi * i / links);
    points.emplace_back(along * std::cos(angle) - across * std::sin(angle),
                        along * std::sin(angle) + across * std::cos(angle));
  }
  add_chain(world, points);
  return world;
}

template <int D>
std::vector<Trouble> found_in(const World<D>& world) {
  return infinitesimal_motions(world.model, world.state);
}

TEST(InfinitesimalMotions, AChainThatIsStraightBetweenWallsHasThemAndOneThatSagsHasNot) {
  for (const int links : {2, 3, 6, 20}) {
    for (const double angle : {0.0, 0.3, kRight, 2.5}) {
      const auto straight = found_in(chain(links, angle, 0));
      ASSERT_THAT(straight, SizeIs(1)) << links << " links at " << angle;
      EXPECT_THAT(straight[0].likely, HasSubstr(std::to_string(links - 1) + " other"));
      EXPECT_THAT(found_in(chain(links, angle, 0.01)), IsEmpty()) << links << " links at " << angle;
    }
  }
  EXPECT_THAT(found_in(chain(1, 0, 0)), IsEmpty());  // a beam
}

// hinges with parallel axes hold each other in balance at all times, and yet turn
TEST(InfinitesimalMotions, InSpaceToo) {
  for (const double angle : {0.0, 0.7}) {
    World<3> straight = extruded(chain(4, angle, 0), 0.1), sags = extruded(chain(4, angle, 0.01), 0.1);
    EXPECT_THAT(found_in(straight), SizeIs(1)) << angle;
    EXPECT_THAT(found_in(sags), IsEmpty()) << angle;
    for (World<3>* world : {&straight, &sags})
      for (Joint<3>& joint : world->model.joints) joint.kind = JointKind::pin;
    EXPECT_THAT(found_in(straight), SizeIs(1)) << angle;
    EXPECT_THAT(found_in(sags), IsEmpty()) << angle;
  }
}

TEST(InfinitesimalMotions, WhatHangsOnAStraightChainMovesAndTheChainDoesNot) {
  World<2> world = empty_plane();
  add_chain(world, {{0, 0}, {1, 0}, {2, 0}});
  const int hangs = add_bar(world, {1, 0}, {1, -1});
  world.model.joints.push_back(pin({hangs, {-0.5, 0}}, {0, {0.5, 0}}));
  const auto found = found_in(world);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].likely, HasSubstr("1 other hold"));
}

// its first order leaves a plane of motions, of which two lines go on: as a parallelogram and crossed
TEST(InfinitesimalMotions, AParallelogramThatLiesFlatGoesOn) {
  World<2> world = empty_plane();
  const int a = add_bar(world, {0, 0}, {1, 0}), b = add_bar(world, {1, 0}, {3, 0}),
            c = add_bar(world, {3, 0}, {2, 0});
  world.model.joints = {pin({a, {-0.5, 0}}, {-1, {0, 0}}), pin({a, {0.5, 0}}, {b, {-1, 0}}),
                        pin({b, {1, 0}}, {c, {-0.5, 0}}), pin({c, {0.5, 0}}, {-1, {2, 0}})};
  EXPECT_THAT(found_in(world), IsEmpty());
}

// two rods hold a ball: straight they are a chain, and in line with a third, on one side, a pendulum
TEST(InfinitesimalMotions, OfRods) {
  World<2> world = empty_plane();
  add_box(world, {0.2, 0.2}, 1, {0, 0});
  world.model.joints = {rod({0, {0, 0}}, {-1, {-1, 0}}, 1), rod({0, {0, 0}}, {-1, {1, 0}}, 1)};
  EXPECT_THAT(found_in(world), SizeIs(1));
  world.model.joints[1] = rod({0, {0, 0}}, {-1, {-1, 0}}, 1);  // the same twice
  EXPECT_THAT(found_in(world), IsEmpty());
  world.model.joints[1] = rod({0, {0, 0}}, {-1, {-2, 0}}, 2);  // circles that touch from within
  EXPECT_THAT(found_in(world), SizeIs(1));
  world.model.joints[1] = rod({0, {0, 0}}, {-1, {0, 1}}, 1);  // held
  EXPECT_THAT(found_in(world), IsEmpty());
}

}  // namespace
}  // namespace obscura::sim
