#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "draw/made.h"
#include "draw/page/layout.h"

namespace obscura::draw {
namespace {

constexpr double kDepth = 24, kLine = 3.2;  // at weight 1

Made slanted() {
  Made made = room(8, 4.5);
  made.wall({0, 2, 0}, {0.6, 1, 0});
  made.wall({8, 1.5, 0}, {-1, 1, 0});
  made.wall({6.5, 4.5, 0}, {-0.35, -1, 0});
  return made;
}

Made wedge() {
  Made made;
  made.cast.scale = 3;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.wall({0, 0, 0}, {0.5, -0.35, 0});
  made.wall({5, 0, 0}, {-1, -0.12, 0});
  made.extent = {{0, 0, 0}, {5, 3, 0}};
  return made;
}

Made ground() {
  Made made;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-1, 0, 0}, {1, 2, 0}};
  return made;
}

Made valley() {
  Made made;
  made.wall({0, 0, 0}, {1, 1, 0});
  made.wall({0, 0, 0}, {-1, 1, 0});
  made.extent = {{-2, 0, 0}, {2, 2.5, 0}};
  return made;
}

/// A fluid lies within the walls below its level, its surface from wall to wall; without walls to the page's
/// edges.
TEST(Still, AFluidFillsTheRoomUpToItsLevel) {
  Made open;
  open.extent = {{-2, 0, 0}, {2, 2, 0}};
  for (Made made : {room(8, 4.5), slanted(), wedge(), open}) {
    const bool walls = !made.cast.walls.empty();
    const std::size_t lines = made.picture().still->strokes.size();
    made.cast.surface = 1;
    const View view = made.depictor().view(0);
    const double level = view.page({0, 1, 0}).y();
    const Picture picture = made.picture();
    const List& still = *picture.still;
    ASSERT_FALSE(still.polygons.empty());
    const Polygon& fluid = still.polygons.front();
    EXPECT_EQ(fluid.fill, palette(Theme::paper).water);
    double low = 1e9, high = -1e9;
    for (int k = fluid.begin; k < fluid.end; ++k) {
      const Point& p = still.points[std::size_t(k)];
      EXPECT_GE(p.y(), level - 1e-9);
      if (std::abs(p.y() - level) < 1e-9) low = std::min(low, p.x()), high = std::max(high, p.x());
      for (const HalfPlane& wall : half_planes(made.cast, view))
        EXPECT_GE((p - wall.point).dot(wall.normal), -kLine / 2 - 1e-9);
    }
    ASSERT_EQ(still.strokes.size(), lines + 1);
    const Stroke& surface = still.strokes.front();
    const Point a = still.nodes[std::size_t(surface.begin)].at,
                b = still.nodes[std::size_t(surface.begin) + 1].at;
    EXPECT_NEAR(std::abs(a.x() - b.x()), high - low, 1e-9);
    EXPECT_NEAR(a.y(), level, 1e-9);
    EXPECT_TRUE(walls || high - low > 1000);
  }
}

// on paper the room has no ground of its own: every polygon that stands still is a line of hatching
TEST(Still, HatchingLiesOutsideTheWallsWithinItsBand) {
  for (const Made& made : {room(8, 4.5), slanted(), wedge(), ground(), valley()}) {
    const View view = made.depictor().view(0);
    const std::vector<HalfPlane> walls = half_planes(made.cast, view);
    const Picture picture = made.picture();
    ASSERT_GT(picture.still->polygons.size(), 50u);
    for (const Point& p : picture.still->points) {
      double least = 1e9;
      for (const HalfPlane& wall : walls) least = std::min(least, (p - wall.point).dot(wall.normal));
      // under the middle of the wall's line at most; at a corner a line 1.6 wide may touch with half its
      // width more
      EXPECT_LE(least, -kLine / 2 + 0.8 + 1e-9);
      EXPECT_GE(least, -kDepth - 1e-9);
    }
  }
}

TEST(Still, HatchingIsAt45DegreesFourteenApartAndAsWideAsItShould) {
  const Made made = room(8, 4.5);
  const Picture picture = made.picture();
  const Point v = Point(1, 1) / std::sqrt(2.0), origin = made.depictor().view(0).origin;
  int whole = 0;
  for (const Polygon& polygon : picture.still->polygons) {
    double low = 1e9, high = -1e9;
    for (int i = polygon.begin; i < polygon.end; ++i) {
      low = std::min(low, (picture.still->points[i] - origin).dot(v));
      high = std::max(high, (picture.still->points[i] - origin).dot(v));
    }
    EXPECT_LE(high - low, 1.6 + 1e-9);
    if (high - low < 1.6 - 1e-9) continue;  // cut by a corner of the band
    ++whole;
    const double step = (low + high) / 2 / (14 / std::sqrt(2.0));
    EXPECT_NEAR(step, std::round(step), 1e-9);
  }
  EXPECT_GT(whole, 300);
}

/// Whichever way walls lie, their hatching is at 45 degrees to each of them, as dense as along any other.
TEST(Still, HatchingIsAt45DegreesToEachWall) {
  for (const Made& made : {slanted(), wedge(), valley()}) {
    const std::vector<HalfPlane> walls = half_planes(made.cast, made.depictor().view(0));
    const Picture picture = made.picture();
    int looked = 0;
    for (const Polygon& polygon : picture.still->polygons) {
      Point middle(0, 0), longest(0, 0);
      for (int i = polygon.begin; i < polygon.end; ++i) {
        const Point &p = picture.still->points[std::size_t(i)],
                    &q = picture.still->points[std::size_t(i + 1 < polygon.end ? i + 1 : polygon.begin)];
        middle += p / (polygon.end - polygon.begin);
        if ((q - p).norm() > longest.norm()) longest = q - p;
      }
      if (longest.norm() < 12) continue;  // cut off at a corner
      ++looked;
      const auto deep = [&](const HalfPlane& wall) { return (middle - wall.point).dot(wall.normal); };
      const auto nearest = std::min_element(walls.begin(), walls.end(),
                                            [&](const auto& a, const auto& b) { return deep(a) < deep(b); });
      EXPECT_NEAR(std::abs(longest.normalized().dot(nearest->normal)), std::sqrt(0.5), 1e-6);
    }
    EXPECT_GT(looked, 50);
  }
}

TEST(Still, HatchingIsEverywhereAlongEveryWall) {
  for (const Made& made : {room(8, 4.5), slanted(), wedge(), ground(), valley()}) {
    const Picture picture = made.picture();
    const List& still = *picture.still;
    // walk the walls' line; a line of hatching begins within a step of each place (14 along an upright wall,
    // at most 9.9 / sin 20 along the most slanting)
    for (const Stroke& stroke : still.strokes) {
      if (still.nodes[stroke.begin].width < 3) continue;  // the rule below the caption
      for (int i = stroke.begin; i + 1 < stroke.end; ++i) {
        const Point a = still.nodes[i].at, b = still.nodes[i + 1].at;
        for (double s = 0; s <= 1; s += 0.01) {
          const Point p = a + s * (b - a);
          if (p.x() < 20 || p.x() > 1900 || p.y() < 20 || p.y() > 1060) continue;
          double nearest = 1e9;
          for (const Point& q : still.points) nearest = std::min(nearest, (q - p).norm());
          EXPECT_LT(nearest, 29) << p.transpose();
        }
      }
    }
  }
}

TEST(Still, WallsCloseWhereTheRoomDoes) {
  const Made made = slanted();
  const Picture picture = made.picture();
  ASSERT_EQ(picture.still->strokes.size(), 1u);
  EXPECT_TRUE(picture.still->strokes[0].closed);
  EXPECT_EQ(picture.still->nodes.size(), 7u) << "seven walls, seven corners";
  EXPECT_FALSE(valley().picture().still->strokes[0].closed);
  EXPECT_EQ(valley().picture().still->nodes.size() - 2, 3u)
      << "border, corner, border; and the rule's two ends";
}

TEST(Still, WallLineTouchesTheRoomFromOutside) {
  // so that a ball at rest touches the line and does not cover it
  const Made made = room(8, 4.5);
  const View view = made.depictor().view(0);
  const Picture picture = made.picture();
  double floor = 0;
  for (const Node& node : picture.still->nodes) floor = std::max(floor, node.at.y());
  EXPECT_NEAR(floor - kLine / 2, view.page({0, 0, 0}).y(), 1e-9);
}

TEST(Still, OpenGroundRunsToTheWindowsEdges) {
  const Picture picture = ground().picture();
  double left = 1e9, right = 0;
  for (const Node& node : picture.still->nodes)
    left = std::min(left, node.at.x()), right = std::max(right, node.at.x());
  EXPECT_LE(left, 0);
  EXPECT_GE(right, 1920);
}

TEST(Still, HatchingGoesWithTheWorld) {
  // the camera pans by a length that is no multiple of the hatching's step: the same lines, elsewhere
  // (no line meets a corner of this room, where either wall may cut it, out of sight under their lines)
  Made made = slanted();
  made.camera.keys = {{0, sim::Vec3(4, 2.25, 0), 12.0, {}, CameraKey::Ease::linear},
                      {1, sim::Vec3(4.1237, 2.25, 0), 12.0, {}, CameraKey::Ease::linear}};
  const Illustrator depictor = made.depictor();
  const auto before = depictor.depict(made.now, {}).still;
  made.now.time = 1;
  const auto after = depictor.depict(made.now, {}).still;
  const Point moved = depictor.view(1).origin - depictor.view(0).origin;
  ASSERT_EQ(before->points.size(), after->points.size());
  for (const Point& p : after->points) {
    double nearest = 1e9;
    for (const Point& q : before->points) nearest = std::min(nearest, (q + moved - p).norm());
    EXPECT_LT(nearest, 1e-6);
  }
}

TEST(Still, ScreenHasALighterRoomAndNoHatchingIsNone) {
  Made made = room(8, 4.5);
  made.look.hatching = false;
  EXPECT_TRUE(made.picture().still->polygons.empty());
  made.look.theme = Theme::screen;
  const Picture picture = made.picture();
  ASSERT_EQ(picture.still->polygons.size(), 1u);
  EXPECT_GT(picture.still->polygons[0].fill.r, picture.ground.r);
}

TEST(Still, WallsThatLeaveNoRoomDrawNothing) {
  Made made;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.wall({0, -1, 0}, {0, -1, 0});
  made.extent = {{-1, 0, 0}, {1, 1, 0}};
  EXPECT_TRUE(made.picture().still->polygons.empty());
  EXPECT_TRUE(made.picture().still->strokes.empty());
}

}  // namespace
}  // namespace obscura::draw
