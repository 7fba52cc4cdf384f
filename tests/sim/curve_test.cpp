// Curves: their places, directions and lengths against closed forms.

#include "sim/shape/curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace obscura::sim {
namespace {

constexpr double kCurvePi = std::numbers::pi;

template <int D>
Curve<D> of_formula(const std::vector<std::string>& texts, double from, double to, bool closed = false) {
  const auto formula = curve_formula<D>(texts, {});
  auto pieces = curve_pieces<D>(std::get<Program>(formula), from, to);
  if (const auto* wrong = std::get_if<std::string>(&pieces)) ADD_FAILURE() << *wrong;
  return Curve<D>(std::get<0>(std::move(pieces)), closed);
}

// A circle as a formula of s: length, curvature and the nearest place of any point, to rounding.
TEST(CurveOfFormulas, ACircleIsOneToRounding) {
  const Curve<2> circle = of_formula<2>({"2*cos(s)", "2*sin(s)"}, 0, 2 * kCurvePi, true);
  EXPECT_NEAR(circle.length(), 4 * kCurvePi, 1e-11);
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.0628 * i + 0.01, far = 1.2 + 0.02 * i;
    const Vec<2> p(far * std::cos(angle), far * std::sin(angle));
    const auto foot = circle.nearest(p);
    EXPECT_NEAR(foot.at.x[0], 2 * std::cos(angle), 1e-12);
    EXPECT_NEAR(foot.at.x[1], 2 * std::sin(angle), 1e-12);
    // a sixth of the rounding is lost with each derivative: pieces are about 0.1 rad long
    EXPECT_NEAR(foot.at.tangent.dot(p), 0, 1e-11);
    EXPECT_NEAR((foot.at.curvature + foot.at.x / 4).norm(), 0, 1e-8);
    EXPECT_NEAR(circle.along(foot.piece, foot.u), 2 * angle, 1e-11);
  }
}

// One arc of a cycloid is eight times its radius long.
TEST(CurveOfFormulas, ACycloidHasItsLength) {
  const Curve<2> cycloid = of_formula<2>({"s - sin(s)", "cos(s) - 1"}, 0.01, kCurvePi);
  EXPECT_NEAR(cycloid.length(), 4 * std::cos(0.005), 1e-10);
}

TEST(CurveOfFormulas, WhatHasNoDirectionIsRefused) {
  const auto cusp = curve_formula<2>({"s - sin(s)", "cos(s) - 1"}, {});
  const auto pieces = curve_pieces<2>(std::get<Program>(cusp), 0, kCurvePi);
  ASSERT_TRUE(std::holds_alternative<std::string>(pieces));
  EXPECT_NE(std::get<std::string>(pieces).find("no direction at s = 0"), std::string::npos);
  const auto corner = curve_formula<2>({"s", "abs(s - 0.3)"}, {});
  const auto bent = curve_pieces<2>(std::get<Program>(corner), 0, 1);
  ASSERT_TRUE(std::holds_alternative<std::string>(bent));
  EXPECT_NE(std::get<std::string>(bent).find("not smooth near"), std::string::npos);
}

// Arcs and lines: an arc through three places, and one that goes on as a line does, are circles.
TEST(CurvePath, ArcsAreCircles) {
  CurvePath<2> path({0, 0});
  path.line({2, 0});
  ASSERT_TRUE(path.arc({3, 1}));  // a quarter of a circle about [2, 1]
  EXPECT_NEAR(path.kink(), 0, 1e-15);
  ASSERT_TRUE(path.arc({2, 2}, {1, 1}));  // half of it
  EXPECT_NEAR(path.kink(), 0, 1e-15);
  const Curve<2> curve(path.pieces(), false);
  EXPECT_NEAR(curve.length(), 2 + 1.5 * kCurvePi, 1e-14);
  const auto foot = curve.nearest({2, 1.7});
  EXPECT_NEAR((foot.at.x - Vec<2>(2, 2)).norm(), 0, 1e-15);
  EXPECT_NEAR((foot.at.curvature - Vec<2>(0, -1)).norm(), 0, 1e-14);
  EXPECT_NEAR((foot.at.tangent - Vec<2>(-1, 0)).norm(), 0, 1e-14);
  EXPECT_EQ(curve.piece(foot.piece).run, 2);
  EXPECT_FALSE(path.closing_kink());
}

// A cubic spline passes its places with a continuous direction and curvature, and a straight one is straight.
TEST(CurvePath, SplinesAreSmooth) {
  CurvePath<2> path({0, 0});
  path.spline({{1, 0.5}, {2, -0.5}, {3.5, 0.2}}, Vec<2>(1, 0));
  const Curve<2> curve(path.pieces(), false);
  for (int i = 1; i < curve.size(); ++i) {
    const auto before = curve.at(i - 1, 1), after = curve.at(i, 0);
    EXPECT_NEAR((before.x - after.x).norm(), 0, 1e-14);
    EXPECT_NEAR((before.tangent - after.tangent).norm(), 0, 1e-13);
    EXPECT_NEAR((before.curvature - after.curvature).norm(), 0, 1e-11);
  }
  EXPECT_NEAR((curve.at(curve.size() - 1, 1).tangent - Vec<2>(1, 0)).norm(), 0, 1e-14);

  CurvePath<2> ring({1, 0});
  ring.loop({{0, 1}, {-1, 0}, {0, -1}});
  const Curve<2> closed(ring.pieces(), true);
  const auto last = closed.at(closed.size() - 1, 1), first = closed.at(0, 0);
  EXPECT_NEAR((last.tangent - first.tangent).norm(), 0, 1e-13);
  EXPECT_NEAR((last.curvature - first.curvature).norm(), 0, 1e-12);
  // by symmetry it goes straight up there
  EXPECT_NEAR((first.tangent - Vec<2>(0, 1)).norm(), 0, 1e-13);
}

// The nearest place by feet() and by trying many places agree.
TEST(Curve, FeetAreTheNearestPlaces) {
  const Curve<3> helix = of_formula<3>({"cos(s)", "0.2*s", "sin(s)"}, 0, 12);
  for (int i = 0; i < 40; ++i) {
    const Vec<3> p(1.3 * std::cos(0.3 * i), 0.06 * i, 1.1 * std::sin(0.29 * i));
    double least = 1e300;
    for (int piece = 0; piece < helix.size(); ++piece)
      for (int k = 0; k <= 200; ++k) least = std::min(least, (helix.at(piece, k / 200.0).x - p).norm());
    EXPECT_NEAR((helix.nearest(p).at.x - p).norm(), least, 1e-5);
    std::vector<Curve<3>::Foot> feet;
    helix.feet(p, least + 0.1, feet);
    double nearest = 1e300;
    for (const auto& foot : feet) {
      nearest = std::min(nearest, (foot.at.x - p).norm());
      EXPECT_NEAR(foot.at.tangent.dot(p - foot.at.x), 0, 1e-12);
    }
    if (helix.nearest(p).along > 0.01 && helix.nearest(p).along < helix.length() - 0.01) {
      EXPECT_LE(nearest, least + 1e-12);
    }
  }
}

// A loop meets itself where it begins: both places are found, half a loop is between the two parts.
TEST(Curve, CrossingsAreFound) {
  CurvePath<2> path({-3, 0});
  path.line({0, 0});
  path.arc({1, 1}, {0, 2}), path.arc({-1, 1}, {0, 0});
  path.line({3, 0});
  const Curve<2> loop(path.pieces(), false);
  ASSERT_EQ(loop.crossings().size(), 1u);
  EXPECT_NEAR(loop.crossings()[0].first, 3, 1e-9);
  EXPECT_NEAR(loop.crossings()[0].second, 3 + 2 * kCurvePi, 1e-9);
  EXPECT_TRUE(loop.conflict(2.9, 3.1 + 2 * kCurvePi));
  EXPECT_TRUE(loop.conflict(3.1 + 2 * kCurvePi, 2.9));
  EXPECT_FALSE(loop.conflict(2.9, 3.1));
  const Curve<2> eight = of_formula<2>({"sin(s)", "sin(2*s)"}, 0, 2 * kCurvePi, true);
  ASSERT_EQ(eight.crossings().size(), 1u);
  EXPECT_NEAR(eight.apart(eight.crossings()[0].first, eight.crossings()[0].second), eight.length() / 2, 1e-6);
  EXPECT_TRUE(of_formula<2>({"cos(s)", "sin(s)"}, 0, 2 * kCurvePi, true).crossings().empty());
  EXPECT_TRUE(of_formula<2>({"s", "sin(s)"}, 0, 20).crossings().empty());
}

}  // namespace
}  // namespace obscura::sim
