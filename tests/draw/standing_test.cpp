// What makes bodies in space stand: darkness where they touch the ground, outlines heavier than creases, no
// seams in what is one, and a piece of ceiling over what hangs.

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "draw/picture/solids.h"
#include "draw/space/camera.h"
#include "draw/space/light.h"
#include "draw/space/sight.h"
#include "made.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

/// A box of 0.4 m in space, its centre so high over the ground.
Made standing(double high) {
  Made made;
  made.cast.dimension = 3;
  made.cast.scale = 2;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.extent = {{-1, 0, -1}, {1, 2, 1}};
  made.look.caption = false;
  made.body(sim::ShapeKind::box, {0, high, 0}, 0.2);
  made.cast.bodies[0].half = {0.2, 0.2, 0.2};
  made.camera = slant();
  return made;
}

/// How far a point lies outside a convex outline, page units; not above 0: within.
double outside_of(const Solids& solids, const Solids::Shade& shade, const Point& p) {
  double far = -1e300, side = 0;
  const int n = shade.end - shade.begin;
  const auto at = [&](int k) { return solids.points[std::size_t(shade.begin + (k + n) % n)]; };
  for (int k = 1; k + 1 < n; ++k) {
    const Point a = at(k) - at(0), b = at(k + 1) - at(0);
    side += a.x() * b.y() - a.y() * b.x();
  }
  for (int k = 0; k < n; ++k) {
    const Point way = at(k + 1) - at(k), d = p - at(k);
    far = std::max(far, -std::copysign(1.0, side) * (way.x() * d.y() - way.y() * d.x()) / way.norm());
  }
  return far;
}

/// A line that goes behind a body is cut 0.4 page units within its outline (sight.cpp), its round end
/// included: else it would be a speck in the face there.
TEST(Standing, ALineThatGoesBehindDoesNotReachIntoTheFace) {
  Made made = standing(0.2);
  made.body(sim::ShapeKind::box, {0, 0.4, -0.6}, 0.1);
  made.cast.bodies[1].half = {0.1, 0.3, 0.2};
  for (const int i : {0, 1}) made.look.bodies[std::size_t(i)].color = color(i ? "blue" : "orange");
  made.camera = side();
  made.camera.elevation = 0, made.camera.projection = Camera::Projection::orthographic;
  const Picture picture = made.picture();
  const Color behind = edge(*color("blue"), made.look.theme);
  const double top = made.depictor().lens(made.now).page({0, 0.4, 0.2}).y();
  int cut = 0;
  for (const Stroke& stroke : picture.moving.strokes) {
    const Node& first = picture.moving.nodes[std::size_t(stroke.begin)];
    if (first.color != behind || stroke.closed) continue;
    for (int i = stroke.begin; i < stroke.end; ++i) {
      const Node& node = picture.moving.nodes[std::size_t(i)];
      EXPECT_LT(node.at.y() + node.width / 2, top + 0.41);
      cut += node.at.y() > top - 3;
    }
  }
  EXPECT_GE(cut, 1) << "the line at its side";
}

/// Ring i reaches to 0.28 m (1.4 of half the thickness) times ((i + 1) / 32)^1.6 from the foot, each around
/// the one before: nothing is noise.
TEST(Standing, TheGroundIsDarkerTheNearerItIsToWhatStandsOnIt) {
  const Made made = standing(0.2);
  const Illustrator artist = made.depictor();
  const Picture picture = made.picture();
  const Solids& solids = *picture.solids.at(0);
  ASSERT_EQ(solids.touches.size(), std::size_t(kRays));
  const CameraProjection lens = artist.lens(made.now);
  for (std::size_t i = 0; i < solids.touches.size(); ++i) {
    const double reach = 0.28 * std::pow(double(i + 1) / kRays, 1.6);
    const double metre = lens.scale_at({0.2, 0, 0});
    // straight out of the middle of a side
    EXPECT_NEAR(outside_of(solids, solids.touches[i], lens.page({0.2 + reach, 0, 0})), 0, 0.01 * metre) << i;
    EXPECT_LT(outside_of(solids, solids.touches[i], lens.page({0.2, 0, 0.2})), 0) << i;
    EXPECT_EQ(solids.touches[i].rays, 1u << i);
  }
}

TEST(Standing, WhatFliesDarkensNothing) {
  EXPECT_FALSE(standing(0.3).picture().solids.at(0)->touches.empty());
  EXPECT_TRUE(standing(0.5).picture().solids.at(0)->touches.empty());
}

/// A body's foot is darker than the same body's foot in the air, its top is as light.
TEST(Standing, ABodyIsDarkerWhereItTouchesTheGround) {
  const auto least = [](const Made& made) {
    int dark = 255;
    for (const Solids::Vertex& v : made.picture().solids.at(0)->vertices) dark = std::min(dark, int(v.lit.r));
    return dark;
  };
  EXPECT_LT(least(standing(0.2)), 0.85 * least(standing(3)));
}

/// Both widths are those of lines: outlines 1.3, creases 0.75 of one.
TEST(Standing, OutlinesAreHeavierThanCreases) {
  const Picture picture = standing(0.2).picture();
  std::map<long, int> widths;
  for (const Stroke& stroke : picture.moving.strokes)
    ++widths[std::lround(1000 * picture.moving.nodes[std::size_t(stroke.begin)].width)];
  ASSERT_EQ(widths.size(), 2u);
  EXPECT_NEAR(double(widths.rbegin()->first) / double(widths.begin()->first), 1.3 / 0.75, 0.01);
  EXPECT_EQ(widths.begin()->second, 3) << "three faces meet in three creases";
  EXPECT_EQ(widths.rbegin()->second, 6);
}

/// Two parts that lie against each other with flush fronts: the edge between them is no edge of theirs, also
/// where it is the very rim of both. A crease between faces at an angle stays.
TEST(Standing, PartsThatLieAgainstEachOtherHaveNoSeam) {
  Camera camera = side();
  camera.elevation = 0, camera.projection = Camera::Projection::orthographic;
  const CameraProjection lens = lens_at(camera, {Vec3::Zero(), 9.6}, {0, 0, 1920, 1080}, 0);
  HiddenLines sight(lens);
  // a beam over a post, their fronts at z = 0.5
  sight.add(box({2, 0.5, 0.5}).placed(Eigen::Matrix3d::Identity(), {0, 0.5, 0}), 0, 3);
  sight.add(box({0.5, 1, 0.5}).placed(Eigen::Matrix3d::Identity(), {0, -1, 0}), 1, 3);
  sight.finish();
  HiddenLines::Parts parts;
  const Vec3 front = Vec3::UnitZ(), aslant = Vec3(0, -1, 1).normalized();
  const std::array<Vec3, 1> flush{front}, other{aslant};
  sight.seen({-2, 0, 0.5}, {2, 0, 0.5}, 0, -1, parts, flush);
  ASSERT_EQ(parts.size(), 2u) << "beside the post";
  EXPECT_NEAR(parts[0].second, 0.375, 0.005);
  EXPECT_NEAR(parts[1].first, 0.625, 0.005);
  sight.seen({-0.5, 0, 0.5}, {0.5, 0, 0.5}, 1, -1, parts, flush);
  EXPECT_TRUE(parts.empty()) << "the post's own rim";
  sight.seen({-2, 0, 0.5}, {2, 0, 0.5}, 0, -1, parts, other);
  EXPECT_EQ(parts.size(), 1u) << "no face goes on there";
}

/// The rim of an end that lies against another part, where both have the same outline: seen from the left and
/// above, a post's end under a beam has an edge along the far side. It left a notch in the outline.
TEST(Standing, AnEndThatIsCoveredHasNoRim) {
  Camera camera = side();
  camera.azimuth = -10, camera.elevation = 8, camera.projection = Camera::Projection::orthographic;
  const CameraProjection lens = lens_at(camera, {Vec3::Zero(), 9.6}, {0, 0, 1920, 1080}, 0);
  for (const bool one : {true, false}) {
    HiddenLines sight(lens);
    sight.add(box({2, 0.5, 0.02}).placed(Eigen::Matrix3d::Identity(), {0, 0.5, 0}), 0, one ? 3 : 0);
    sight.add(box({0.5, 1, 0.02}).placed(Eigen::Matrix3d::Identity(), {1.5, -1, 0}), 1, one ? 3 : 1);
    sight.finish();
    HiddenLines::Parts parts;
    const std::array<Vec3, 1> end{Vec3::UnitY()};
    sight.seen({2, 0, 0.02}, {2, 0, -0.02}, 1, -1, parts, end);
    EXPECT_EQ(parts.empty(), one);
  }
}

/// A ball on a rope hangs from a plate; on a rod that stands on the ground it does not, nor seen from above,
/// where the plate would hide it.
TEST(Standing, WhatHangsHangsFromSomething) {
  const auto corners = [](const Vec3& anchor, double elevation) {
    Made made;
    made.cast.dimension = 3, made.cast.scale = 3;
    made.cast.gravity = {0, -9.81, 0};
    made.wall({0, 0, 0}, {0, 1, 0});
    made.extent = {{-1.5, 0, -1.5}, {1.5, 3, 1.5}};
    made.look.caption = false;
    made.camera = slant();
    if (elevation > 0) made.camera.elevation = elevation;
    made.body(sim::ShapeKind::ball, {0, 1, 0}, 0.2);
    sim::SceneInfo::Joint rope;
    rope.kind = sim::JointKind::rope, rope.a = 0, rope.b = -1, rope.length = (anchor - Vec3(0, 1, 0)).norm();
    made.cast.joints.push_back(rope);
    made.now.joints.push_back({{0, 1, 0}, anchor});
    const Picture picture = made.picture();
    return std::pair(picture.solids.at(0)->vertices.size(), picture.moving.strokes.size());
  };
  const auto hung = corners({0, 2.5, 0}, 0), stood = corners({0, 0, 0}, 0);
  // the three faces of the plate that are seen, of four corners each
  EXPECT_GE(hung.second, stood.second + 6);
  EXPECT_EQ(corners({0, 2.5, 0}, 1.5).first, corners({0, 0, 0}, 1.5).first);
}

}  // namespace
}  // namespace obscura::draw
