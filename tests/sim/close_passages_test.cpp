// The pieces of a step that passes something closely.

#include "sim/force/close_passages.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

namespace obscura::sim {
namespace {

using Pieces = std::vector<std::pair<double, double>>;

// of a step of 1 s from 0 s, by what `ratio` tells at the time at hand
template <class Ratio>
Pieces pieces(Integrator integrator, LimitMet& met, Ratio&& ratio) {
  Pieces all;
  double now = 0;
  step_by_passages(
      integrator, 0, 1, 7, met, [&](double at) { return ratio(at); },
      [&](double from, double length) { all.emplace_back(from, length), now = from + length; });
  return all;
}

TEST(ClosePassages, AStepThatIsShortIsTakenWhole) {
  LimitMet met;
  EXPECT_EQ(pieces(Integrator::rk4, met, [](double) { return 0.09; }), (Pieces{{0, 1}}));
  EXPECT_EQ(met, LimitMet());
}

TEST(ClosePassages, PiecesAreShortWhereThePassageIsAndEndWithTheStep) {
  LimitMet met;
  const auto ratio = [](double t) { return 1 / (std::fabs(t - 0.3) + 1e-4); };
  const Pieces all = pieces(Integrator::rk4, met, ratio);
  double end = 0;
  for (const auto& [from, length] : all) {
    EXPECT_EQ(from, end);
    EXPECT_LE(length * ratio(from), ratio(from) > PassageLimits::kFar ? PassageLimits::kPiece : 1);
    end = from + length;
  }
  EXPECT_EQ(end, 1);
  EXPECT_GT(all.size(), 100u);
  EXPECT_LT(all.size(), 1000u);
  EXPECT_EQ(met, LimitMet());
}

TEST(ClosePassages, WhatIsTooCloseIsToldAndEnds) {
  LimitMet met;
  const Pieces all =
      pieces(Integrator::rk4, met, [](double) { return std::numeric_limits<double>::infinity(); });
  EXPECT_LE(int(all.size()),
            PassageLimits::kMost + (1 << PassageLimits::kFewHalvings) + PassageLimits::kHalvings);
  EXPECT_EQ(all.back().first + all.back().second, 1);
  EXPECT_EQ(met, (LimitMet{1, 7, 7}));
}

TEST(ClosePassages, OtherSchemesGoWholeAndTellWhatTheyMiss) {
  LimitMet met;
  EXPECT_EQ(pieces(Integrator::euler, met, [](double) { return 0.2; }), (Pieces{{0, 1}}));
  EXPECT_EQ(met, LimitMet());
  EXPECT_EQ(pieces(Integrator::semi_implicit, met, [](double) { return 1.1; }), (Pieces{{0, 1}}));
  EXPECT_EQ(met.steps, 1);
}

}  // namespace
}  // namespace obscura::sim
