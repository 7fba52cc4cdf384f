#include "draw/space/sight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

const Rect kFullPage{0, 0, 1920, 1080};

CameraProjection front(Camera::Projection projection = Camera::Projection::orthographic) {
  Camera camera = side();
  camera.elevation = 0;
  camera.projection = projection;
  return lens_at(camera, {Vec3::Zero(), 9.6}, kFullPage, 0);
}

TEST(HiddenLines, ABoxHidesWhatLiesBehindItAndNoMore) {
  const CameraProjection lens = front();
  HiddenLines sight(lens);
  sight.add(box({1, 1, 1}), 0);
  sight.finish();
  HiddenLines::Parts parts;
  sight.seen({-2, 0, -3}, {2, 0, -3}, -1, -1, parts);
  ASSERT_EQ(parts.size(), 2u);
  // the box is a quarter to three quarters of the way; a line counts as hidden 0.4 of 200 page units inside
  EXPECT_NEAR(parts[0].second, 0.25, 0.001);
  EXPECT_NEAR(parts[1].first, 0.75, 0.001);
  sight.seen({-2, 0, 3}, {2, 0, 3}, -1, -1, parts);
  ASSERT_EQ(parts.size(), 1u) << "before it";
  sight.seen({-2, 0, -3}, {2, 0, -3}, 0, -1, parts);
  ASSERT_EQ(parts.size(), 1u) << "its own";
}

TEST(HiddenLines, BodiesThatTouchDoNotHideEachOthersEdges) {
  const CameraProjection lens = front();
  HiddenLines sight(lens);
  // stands on the ground at y = 0; an edge in its upper face, and one that sank into it by a hair
  sight.add(box({1, 1, 1}), 0);
  sight.finish();
  HiddenLines::Parts parts;
  for (double sunk : {0.0, 0.0005}) {
    sight.seen({-0.5, 1 - sunk, 1 - sunk}, {0.5, 1 - sunk, 1 - sunk}, -1, -1, parts);
    EXPECT_EQ(parts.size(), 1u);
  }
}

TEST(HiddenLines, AgreesWithRaysThroughRandomBoxes) {
  std::mt19937 random(7);
  const auto number = [&](double from, double to) {
    return from + (to - from) * double(random()) / 4294967295.0;
  };
  for (auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    const CameraProjection lens = front(projection);
    int hidden = 0;
    for (int trial = 0; trial < 300; ++trial) {
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)).normalized();
      const Vec3 half(number(0.3, 1), number(0.3, 1), number(0.3, 1)),
          at(number(-2, 2), number(-1, 1), number(-2, 2));
      HiddenLines sight(lens);
      sight.add(box(half).placed(turn.toRotationMatrix(), at), 0);
      sight.finish();
      const Vec3 place(number(-3, 3), number(-2, 2), number(-4, 4));
      // the place seen along the ray, in the box's frame: by slabs
      const Vec3 o = turn.conjugate() * (place - at), d = turn.conjugate() * lens.sight(place);
      double low = 0, high = lens.perspective() ? (lens.eye() - place).norm() : 1e9, clear = 1e9;
      for (int i = 0; i < 3; ++i) {
        const double a = (-half[i] - o[i]) / d[i], b = (half[i] - o[i]) / d[i];
        low = std::max(low, std::min(a, b)), high = std::min(high, std::max(a, b));
        clear = std::min(clear, std::abs(std::abs(o[i]) - half[i]));
      }
      // within a few millimetres of an edge either answer will do: sight has a margin of half a page unit
      if (std::abs(high - low) < 0.02 || clear < 0.01) continue;
      EXPECT_EQ(sight.seen(place, -1), high < low) << trial;
      hidden += high > low;
    }
    EXPECT_GT(hidden, 10);
  }
}

TEST(HiddenLines, ABallHidesADiscAndARodAStrip) {
  const CameraProjection lens = front();
  HiddenLines sight(lens);
  sight.add_disc(contour(lens, {0, 0, 0}, 1, 64), {0, 0, 0}, 1, 0);
  sight.add_rod({3, -1, 0}, {3, 1, 0}, 0.1, 0.1, 1);
  sight.finish();
  EXPECT_FALSE(sight.seen({0.69, 0.69, -0.5}, -1));
  EXPECT_TRUE(sight.seen({0.73, 0.73, -0.5}, -1));
  EXPECT_TRUE(sight.seen({0.69, 0.69, 0.5}, -1));
  EXPECT_FALSE(sight.seen({3.05, 0, -1}, -1));
  EXPECT_TRUE(sight.seen({3.15, 0, -1}, -1));
}

/// What reaches into a round body is hidden from its surface on, not from its middle on.
TEST(HiddenLines, ALineEndsWhereItEntersARoundBody) {
  for (const auto projection : {Camera::Projection::orthographic, Camera::Projection::perspective}) {
    const CameraProjection lens = front(projection);
    HiddenLines sight(lens);
    sight.add_disc(contour(lens, {0, 0, 0}, 1, 64), {0, 0, 0}, 1, 0);
    sight.add_rod({3, -1, 0}, {3, 1, 0}, 0.3, 0.3, 1);
    sight.finish();
    // to the depth of the planes that stand for its front: 1 - cos 22.5 degrees of the radius
    EXPECT_FALSE(sight.seen({0, 0, 0.9}, -1));
    EXPECT_FALSE(sight.seen({0.3, -0.2, 0.8}, -1));
    EXPECT_FALSE(sight.seen({0.7, 0.2, 0.5}, -1));
    EXPECT_TRUE(sight.seen({0, 0, 1.02}, -1));
    EXPECT_TRUE(sight.seen({0.5, 0.5, 0.75}, -1));
    EXPECT_TRUE(sight.seen({0.75, -0.6, 0.32}, -1));
    EXPECT_FALSE(sight.seen({3, 0, 0.25}, -1));
    EXPECT_TRUE(sight.seen({3, 0, 0.32}, -1));
  }
}

/// Boxes of one body that lie in each other show the outline of both together: an edge on the other's front
/// is a seam. Of two bodies both edges are shown.
TEST(HiddenLines, ABodyOfSeveralFormsHasNoSeams) {
  const CameraProjection lens = front();
  const Polyhedron bar = box({2, 0.2, 0.1}), post = box({0.2, 2, 0.1});
  for (const bool one : {true, false}) {
    HiddenLines sight(lens);
    sight.add(bar, 0, one ? 7 : 1);
    sight.add(post, 1, one ? 7 : 2);
    sight.finish();
    // the bar's upper front edge, across the post
    HiddenLines::Parts parts;
    sight.seen({-2, 0.2, 0.1}, {2, 0.2, 0.1}, 0, -1, parts);
    EXPECT_EQ(parts.size(), one ? 2u : 1u);
  }
}

TEST(HiddenLines, AWallCutsTheRoomFromSpace) {
  Polyhedron room = box({10, 10, 10});
  room = cut(room, {0, 0, 0}, {0, 1, 0}, 0);
  room = cut(room, {1, 0, 0}, {-1, 0, 0}, 1);
  EXPECT_EQ(room.faces.size(), 6u);
  EXPECT_EQ(room.edges.size(), 12u);
  for (const Polyhedron::Edge& e : room.edges) EXPECT_GE(e.right, 0) << "closed";
  for (const Polyhedron::Face& f : room.faces) {
    EXPECT_EQ(f.side == 0, f.normal.y() < -0.5) << "outwards: down";
  }
  room = cut(room, {0, 0, 0}, Vec3(1, 1, 1).normalized(), 2);
  EXPECT_EQ(room.vertices.size() + room.faces.size(), room.edges.size() + 2) << "Euler";
}

}  // namespace
}  // namespace obscura::draw
