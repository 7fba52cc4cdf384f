#include "draw/picture/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kDegree = std::numbers::pi / 180;
const Rect kPage{0, 0, 1920, 1080};

TEST(CameraProjection, AnOrthographicSideViewIsTheFrontElevation) {
  Camera camera = side();
  camera.elevation = 0;
  camera.projection = Camera::Projection::orthographic;
  const CameraProjection lens = lens_at(camera, {{1, 2, 3}, 8}, kPage, 0);
  // 1920 page units for 8 m: 240 a metre, the target in the middle, whatever the depth
  EXPECT_NEAR((lens.page({1, 2, 3}) - Point(960, 540)).norm(), 0, 1e-9);
  EXPECT_NEAR((lens.page({2, 2.5, -7}) - Point(1200, 420)).norm(), 0, 1e-9);
}

TEST(CameraProjection, APerspectiveSideViewDividesByTheDepth) {
  Camera camera = side();
  camera.elevation = 0;
  camera.field = 2 * std::atan(0.5);
  // at the target 4 m across under an angle of 1 in 1: the eye is 4 m away
  const CameraProjection lens = lens_at(camera, {Vec3::Zero(), 4}, kPage, 0);
  EXPECT_NEAR((lens.eye() - Vec3(0, 0, 4)).norm(), 0, 1e-12);
  // 2 m before the target, half as far from the eye: twice as large, 960 page units a metre
  EXPECT_NEAR((lens.page({0.5, -0.25, 2}) - Point(960 + 480, 540 + 240)).norm(), 0, 1e-9);
  // 4 m behind, twice as far: half as large
  EXPECT_NEAR((lens.page({1, 1, -4}) - Point(960 + 240, 540 - 240)).norm(), 0, 1e-9);
}

TEST(CameraProjection, SlantTurnsAboutTheVerticalAndThenLooksDown) {
  Camera camera;
  camera.azimuth = 90 * kDegree, camera.elevation = 30 * kDegree;
  camera.projection = Camera::Projection::orthographic;
  const CameraProjection lens = lens_at(camera, {Vec3::Zero(), 19.2}, kPage, 0);
  // from +x: -z is to the right; a height shows by its cosine, what is nearer lies lower by its sine
  EXPECT_NEAR((lens.page({0, 0, -1}) - Point(1060, 540)).norm(), 0, 1e-9);
  EXPECT_NEAR((lens.page({0, 1, 0}) - Point(960, 540 - 100 * std::cos(30 * kDegree))).norm(), 0, 1e-9);
  EXPECT_NEAR((lens.page({1, 0, 0}) - Point(960, 540 + 100 * std::sin(30 * kDegree))).norm(), 0, 1e-9);
}

TEST(CameraProjection, HomogeneousPlacesAndRaysAgreeWithThePage) {
  for (auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    Camera camera = slant();
    camera.projection = projection;
    const CameraProjection lens = lens_at(camera, {{0.3, 1, -0.2}, 5}, {100, 50, 900, 700}, 0);
    const Vec3 place(0.7, -0.4, 1.1);
    const Eigen::Vector4d h = lens.homogeneous(place);
    EXPECT_NEAR((lens.page(place) - Point(h.x() / h.w(), h.y() / h.w())).norm(), 0, 1e-9);
    Vec3 from;
    const Vec3 along = lens.ray(lens.page(place), from);
    EXPECT_NEAR(along.cross(place - from).norm(), 0, 1e-12);
    EXPECT_GT(lens.seen(place + 0.1 * lens.sight(place)).z(), lens.seen(place).z());
  }
}

TEST(SpaceCamera, FitsWhatItIsGivenInTheWindowAndNotMuchSmaller) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 3.0 : -3.0, i & 2 ? 2.0 : 0.0, i & 4 ? 1.0 : -1.0});
  const Rect window{200, 100, 800, 900};
  for (Camera camera : {side(), slant()}) {
    const CameraProjection lens = lens_at(camera, aim(camera, corners, window), window, 0);
    double reach = 0;
    for (const Vec3& c : corners) {
      const Point p = lens.page(c);
      EXPECT_FALSE(outside(window, p, 0));
      reach = std::max(reach, std::abs(p.x() - 600) / 400);
    }
    EXPECT_GT(reach, 0.8) << "the longer side fills the window";
  }
}

TEST(SpaceCamera, OrbitsAtItsRateAndFollows) {
  Camera camera = side();
  camera.orbit = 90 * kDegree;
  const CameraProjection later = lens_at(camera, {Vec3::Zero(), 4}, kPage, 1);
  EXPECT_NEAR((later.right - Vec3(0, 0, -1)).norm(), 0, 1e-12) << "a quarter turn: from +x";
  const CameraProjection followed = lens_at(camera, {Vec3::Zero(), 4}, kPage, 0, Vec3(5, 1, 2));
  EXPECT_NEAR((followed.page({5, 1, 2}) - Point(960, 540)).norm(), 0, 1e-9);
}

TEST(SpaceCamera, KeysHoldAtTheirTimesAndEaseBetween) {
  Camera camera = slant();
  CameraKey first, second;
  first.time = 1, first.azimuth = 0, first.width = 4;
  second.time = 3, second.azimuth = 180 * kDegree, second.width = 9, second.center = Vec3(1, 0, 0);
  camera.keys = {first, second};
  const Aim fitted{Vec3::Zero(), 6};
  EXPECT_NEAR((lens_at(camera, fitted, kPage, 0).right - Vec3(1, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR(lens_at(camera, fitted, kPage, 1).scale, 1920.0 / 4, 1e-9);
  // half of an even move: half the turn, and the mean width of a zoom at an even rate
  const CameraProjection half = lens_at(camera, fitted, kPage, 2);
  EXPECT_NEAR((half.right - Vec3(0, 0, -1)).norm(), 0, 1e-12);
  EXPECT_NEAR(half.scale, 1920.0 / 6, 1e-9);
  EXPECT_NEAR((lens_at(camera, fitted, kPage, 7).target - Vec3(1, 0, 0)).norm(), 0, 1e-12);
}

TEST(SpaceCamera, AnEyeIsWhereAKeyPutsIt) {
  Camera camera;
  CameraKey key;
  key.center = Vec3(0, 1, 0), key.eye = Vec3(3, 5, 4);
  camera.keys = {key};
  const CameraProjection lens = lens_at(camera, {Vec3::Zero(), 6}, kPage, 0);
  EXPECT_NEAR((lens.eye() - Vec3(3, 5, 4)).norm(), 0, 1e-9);
}

}  // namespace
}  // namespace obscura::draw
