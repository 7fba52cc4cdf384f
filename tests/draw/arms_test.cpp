// Bodies that a joint holds at a place outside of them have a line to it.

#include "draw/picture/arms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace obscura::draw {
namespace {

using sim::Vec3;

TEST(Arms, APlaceIsAsFarAsItIsFromTheForm) {
  sim::SceneInfo::Body body;
  body.kind = sim::ShapeKind::ball, body.radius = 0.5;
  EXPECT_NEAR(beyond(body, {0, 2, 0}), 1.5, 1e-12);
  EXPECT_EQ(beyond(body, {0.3, 0, 0}), 0);
  body.kind = sim::ShapeKind::box, body.half = {1, 0.5, 0};
  EXPECT_NEAR(beyond(body, {2, 1.5, 0}), std::sqrt(2), 1e-12);
  EXPECT_EQ(beyond(body, {1, 0.5, 0}), 0);
  body.kind = sim::ShapeKind::polygon, body.vertices = {{0, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  EXPECT_NEAR(beyond(body, {0, -3, 0}), 2, 1e-12);
  EXPECT_EQ(beyond(body, {0, 0.9, 0}), 0);
}

TEST(Arms, OnlyJointsOutsideOfTheirBodiesHaveThem) {
  sim::SceneInfo cast;
  sim::Snapshot now;
  cast.bodies.resize(1), now.bodies.resize(1);
  cast.bodies[0].kind = sim::ShapeKind::ball, cast.bodies[0].radius = 0.2;
  cast.joints.resize(1), now.joints.resize(1);
  cast.joints[0].a = 0, cast.joints[0].kind = sim::JointKind::hinge;
  now.bodies[0].position = {1, 1, 0};
  now.joints[0].a = now.joints[0].b = {1.1, 1, 0};
  EXPECT_TRUE(arms(cast, now, 0.05).empty());
  now.joints[0].a = now.joints[0].b = {2, 1, 0};
  ASSERT_EQ(arms(cast, now, 0.05).size(), 1u);
  EXPECT_EQ(arms(cast, now, 0.05)[0].to, Vec3(2, 1, 0));
  // a rod has its own line; what is broken holds nothing
  cast.joints[0].kind = sim::JointKind::rod;
  EXPECT_TRUE(arms(cast, now, 0.05).empty());
  cast.joints[0].kind = sim::JointKind::pin, now.joints[0].broken = true;
  EXPECT_TRUE(arms(cast, now, 0.05).empty());
}

}  // namespace
}  // namespace obscura::draw
