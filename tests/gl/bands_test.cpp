// A polygon of many edges is drawn in bands of rows, each with the edges that cross it.

#include "gl/bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace obscura::gl {
namespace {

std::vector<Edge> regular(int n, float radius, float cx, float cy) {
  const auto corner = [&](int i) {
    const double angle = 2 * std::numbers::pi * (i % n) / n;
    return std::pair(cx + radius * float(std::cos(angle)), cy + radius * float(std::sin(angle)));
  };
  std::vector<Edge> edges;
  for (int i = 0; i < n; ++i) {
    const auto [px, py] = corner(i);
    const auto [qx, qy] = corner(i + 1);
    edges.push_back({px, py, qx, qy});
  }
  return edges;
}

bool same(const Edge& a, const Edge& b) {
  return a.px == b.px && a.py == b.py && a.qx == b.qx && a.qy == b.qy;
}

TEST(Bands, OfFewEdgesAreOne) {
  std::vector<Edge> list(3);
  const auto bands = banded(regular(64, 100, 0, 0), -100.5f, 100.5f, list);
  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0].first, 3);
  EXPECT_EQ(bands[0].count, 64);
  EXPECT_EQ(list.size(), 67u);
}

TEST(Bands, CoverAllRowsAndHaveTheEdgesThatCrossThemInTheirOrder) {
  for (const int n : {65, 300, 5000}) {
    const std::vector<Edge> edges = regular(n, 90.3f, 120.2f, 77.7f);
    const float y0 = 77.7f - 90.3f - 0.5f, y1 = 77.7f + 90.3f + 0.5f;
    std::vector<Edge> list;
    const auto bands = banded(edges, y0, y1, list);
    ASSERT_GT(bands.size(), 1u);
    EXPECT_EQ(bands.front().y0, y0);
    EXPECT_EQ(bands.back().y1, y1);
    for (std::size_t k = 0; k < bands.size(); ++k) {
      if (k > 0) {
        EXPECT_EQ(bands[k].y0, bands[k - 1].y1);
        EXPECT_EQ(bands[k].y0, std::floor(bands[k].y0)) << "a pixel is of one band";
      }
      int at = bands[k].first;
      const int end = at + bands[k].count;
      for (const Edge& edge : edges) {
        const bool there = at < end && same(list[std::size_t(at)], edge);
        at += there;
        const bool crosses =
            std::max(edge.py, edge.qy) > std::floor(bands[k].y0) && std::min(edge.py, edge.qy) < bands[k].y1;
        EXPECT_TRUE(there || !crosses) << n << " " << k;
      }
      EXPECT_EQ(at, end);
    }
  }
}

TEST(Bands, OfTwiceTheEdgesAreTwiceTheWork) {
  // edges that the pixels of one column add up
  const auto work = [](int n) {
    std::vector<Edge> list;
    double sum = 0;
    for (const Band& band : banded(regular(n, 500, 600, 540), 39.5f, 1040.5f, list))
      sum += double(band.count) * (band.y1 - band.y0);
    return sum;
  };
  EXPECT_LE(work(20'000), 2.5 * work(10'000));
  EXPECT_LE(work(20'000), 100'000);
  EXPECT_LE(work(1000), 40'000);
}

/// Against a look at the corners and the middle of each pixel.
TEST(Bands, ColumnsAreWhollyInAConvexPolygonOrMeetIt) {
  std::mt19937 any(7);
  const auto number = [&](float low, float high) {
    return low + (high - low) * float(any() % 100003) / 100003.0f;
  };
  for (int k = 0; k < 200; ++k) {
    // corners on an ellipse in order
    const int n = 3 + k % 2;
    std::vector<float> angles;
    for (int i = 0; i < n; ++i) angles.push_back(number(0, 6.28f));
    std::sort(angles.begin(), angles.end());
    const float rx = number(20, 90), ry = number(20, 90);
    std::vector<std::pair<float, float>> at;
    for (const float angle : angles) at.emplace_back(100 + rx * std::cos(angle), 90 + ry * std::sin(angle));
    if (k == 0) at = {{0, 0}, {90, 0}, {0, 64}};
    if (k == 1) at = {{10, 16}, {80, 16}, {80, 80}, {10, 80}};
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < at.size(); ++i) {
      const auto [px, py] = at[i];
      const auto [qx, qy] = at[(i + 1) % at.size()];
      edges.push_back({px, py, qx, qy});
    }
    if (!convex(edges)) continue;
    const auto inside = [&](double x, double y, double by) {
      bool left = true, right = true;
      for (const Edge& e : edges) {
        const double length = std::hypot(e.qx - e.px, e.qy - e.py);
        const double side = ((e.qx - e.px) * (y - e.py) - (e.qy - e.py) * (x - e.px)) / (length + 1e-9);
        left = left && side <= by, right = right && side >= -by;
      }
      return left || right;
    };
    int full = 0;
    for (int row = 0; row < 192; row += 16) {
      const Columns found = columns(edges, row, row + 16);
      full += found.full1 - found.full0;
      for (int x = 0; x < 200; ++x)
        for (int y = row; y < row + 16; ++y) {
          const bool corners = inside(x, y, 1e-3) && inside(x + 1, y, 1e-3) && inside(x, y + 1, 1e-3) &&
                               inside(x + 1, y + 1, 1e-3);
          if (x >= found.full0 && x < found.full1) {
            ASSERT_TRUE(corners) << k << ": " << x << ", " << y;
          }
          if (inside(x + 0.5, y + 0.5, 0)) {
            ASSERT_TRUE(x >= found.part0 && x < found.part1) << k << ": " << x << ", " << y;
          }
        }
    }
    if (k < 2) {
      EXPECT_GT(full, 100) << "most of it is found";
    }
  }
}

TEST(Bands, ABowTieAndAnArrowsHeadAreNotConvex) {
  const auto closed = [](const std::vector<std::pair<float, float>>& at) {
    std::vector<Edge> edges;
    for (std::size_t i = 0; i < at.size(); ++i)
      edges.push_back(
          {at[i].first, at[i].second, at[(i + 1) % at.size()].first, at[(i + 1) % at.size()].second});
    return edges;
  };
  EXPECT_TRUE(convex(closed({{0, 0}, {4, 0}, {4, 3}, {0, 3}})));
  EXPECT_TRUE(convex(closed({{0, 0}, {0, 3}, {4, 3}, {4, 0}})));
  EXPECT_TRUE(convex(closed({{0, 0}, {2, 0}, {4, 0}, {0, 3}})));
  EXPECT_FALSE(convex(closed({{0, 0}, {4, 3}, {4, 0}, {0, 3}})));
  EXPECT_FALSE(convex(closed({{0, 0}, {4, 1}, {0, 2}, {1, 1}})));
  EXPECT_FALSE(convex(closed({{0, 0}, {4, 1}, {8, 2}})));
}

}  // namespace
}  // namespace obscura::gl
