#include "gl/shade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace obscura::gl {
namespace {

using draw::Point;

TEST(Shade, CoversThePixelsWhoseCentresLieInThePolygonEitherWayAround) {
  std::array<Point, 5> corners;
  for (int i = 0; i < 5; ++i)
    corners[std::size_t(i)] = {20.3 + 15.1 * std::cos(0.2 + i * 1.2566),
                               13.8 + 11.7 * std::sin(0.2 + i * 1.2566)};
  for (int way = 0; way < 2; ++way) {
    Shade shade(40, 20);  // the polygon reaches over its edges
    shade.add(corners, ~0u);
    shade.count({0, 0, 40, 20});
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) {
        double least = 1e9;
        for (std::size_t i = 0; i < 5; ++i) {
          const Point along = corners[(i + 1) % 5] - corners[i], to = Point(x + 0.5, y + 0.5) - corners[i];
          least = std::min(least, (way ? -1 : 1) * (along.x() * to.y() - along.y() * to.x()));
        }
        if (std::abs(least) < 1e-3) continue;
        EXPECT_EQ(shade.dark()[std::size_t(40 * y + x)], least > 0 ? 255 : 0) << x << " " << y;
      }
    }
    std::reverse(corners.begin(), corners.end());
  }
}

TEST(Shade, ShadowsOfOneRayUniteAndThoseOfSeveralAddUp) {
  const std::array<Point, 4> left{Point(0, 0), {10, 0}, {10, 8}, {0, 8}};
  const std::array<Point, 4> right{Point(5, 0), {15, 0}, {15, 8}, {5, 8}};
  Shade shade(16, 8);
  shade.add(left, 1), shade.add(right, 1), shade.add(right, 0xFFFE0000);
  shade.count({0, 0, 16, 8});
  EXPECT_EQ(shade.dark()[2], std::round(255 * 1 / 32.0));
  EXPECT_EQ(shade.dark()[7], std::round(255 * 16 / 32.0));
  EXPECT_EQ(shade.dark()[15], 0);
  shade.clear({4, 0, 8, 8});
  shade.count({0, 0, 16, 8});
  EXPECT_EQ(shade.dark()[7], 0);
  EXPECT_EQ(shade.dark()[13], std::round(255 * 16 / 32.0)) << "of another part";
}

TEST(Shade, WhatIsNoNumberOrFarAwayIsCutAtThePicture) {
  Shade shade(8, 8);
  const double far = 1e30;
  shade.add(std::array<Point, 3>{Point(-far, 4), {far, 4}, {4, far}}, ~0u);
  shade.add(std::array<Point, 3>{Point(std::nan(""), 4), {1, std::nan("")}, {4, 2}}, 1);
  shade.count({0, 0, 8, 8});
  EXPECT_EQ(shade.dark()[8 * 6 + 3], 255);
  EXPECT_EQ(shade.dark()[8 * 1 + 3], 0);
}

}  // namespace
}  // namespace obscura::gl
