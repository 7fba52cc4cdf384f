// A polygon of many edges is drawn in bands of rows, each with the edges that cross it.

#include "gl/bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace
}  // namespace obscura::gl
