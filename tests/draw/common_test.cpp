// What many half planes have in common, all at once against one cut after the other.

#include "draw/picture/common.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace obscura::draw {
namespace {

double area(const std::vector<Point>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum / 2;
}

// half planes about an ellipse of corners at these angles, moved in
std::vector<HalfPlane> about(const std::vector<double>& angles, double in) {
  std::vector<HalfPlane> halves;
  const auto corner = [&](std::size_t i) {
    const double angle = angles[i % angles.size()];
    return Point(300 + 200 * std::cos(angle), 250 + 100 * std::sin(angle));
  };
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const Point along = (corner(i + 1) - corner(i)).normalized();
    halves.push_back(moved({corner(i), {-along.y(), along.x()}}, in));
  }
  return halves;
}

TEST(WithinAll, IsWhatIsLeftOfCuts) {
  std::mt19937_64 dice(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<double> angles;
    const int n = 5 + int(dice() % 300);
    // some of them next to each other, so that their edges are gone when they are moved in
    for (int i = 0; i < n; ++i)
      angles.push_back(2 * std::numbers::pi * (i + 0.9 * double(dice() >> 11) * 0x1p-53) / n);
    for (const double in : {0.0, 1.0, 20.0, 60.0, 150.0, -3.0}) {
      const std::vector<HalfPlane> halves = about(angles, in);
      Convex cuts = border({-1000, -1000, 3000, 3000});
      for (const HalfPlane& half : halves)
        if (!cuts.empty()) cuts = cut(cuts, half);
      const std::vector<Point> common = within_all(halves);
      if (cuts.empty()) {
        EXPECT_TRUE(common.empty()) << n << " " << in;
        continue;
      }
      ASSERT_NEAR(area(common), area(cuts.outline()), 1e-6 * area(cuts.outline())) << n << " " << in;
      for (const Point& p : common)
        for (const HalfPlane& half : halves)
          ASSERT_GE((p - half.point).dot(half.normal), -1e-6) << n << " " << in;
    }
  }
}

TEST(WithinAll, TakesEdgesOfOneDirectionForOne) {
  // a square whose sides are of many edges each
  std::vector<HalfPlane> halves;
  for (int side = 0; side < 4; ++side)
    for (int i = 0; i < 30; ++i) {
      const Point out[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}}, along(-out[side].y(), out[side].x());
      halves.push_back(moved({10 * out[side] + (i / 3.0 - 5) * along, -out[side]}, i == 7 ? 1 : 0.5));
    }
  const std::vector<Point> common = within_all(halves);
  EXPECT_NEAR(std::abs(area(common)), 18 * 18, 1e-9);
}

}  // namespace
}  // namespace obscura::draw
