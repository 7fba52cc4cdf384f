#include "draw/picture/formula.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/page/placing.h"
#include "draw/page/plot.h"
#include "draw/picture/latex.h"
#include "draw/picture/type.h"

namespace obscura::draw {
namespace {

using testing::ElementsAre;

std::vector<std::pair<std::string, Face>> set(const std::string& text) {
  std::vector<std::pair<std::string, Face>> spans;
  for (const Span& span : formula(text, 100, {}).spans) spans.emplace_back(span.text, span.face);
  return spans;
}

TEST(Formula, LettersAreItalicDigitsAndWordsUprightVectorsBold) {
  using enum Face;
  EXPECT_THAT(set("2x"), ElementsAre(std::pair("2", math), std::pair("x", math_italic)));
  EXPECT_THAT(set("*J* = Jn"), ElementsAre(std::pair("J", math_bold_italic), std::pair(" = ", math),
                                           std::pair("Jn", math_italic)));
  EXPECT_THAT(set("sin\\theta"), ElementsAre(std::pair("sin", math), std::pair("θ", math_italic)));
  EXPECT_THAT(set("\\Delta v"), ElementsAre(std::pair("Δ ", math), std::pair("v", math_italic)));
  EXPECT_THAT(set("-\"ab\""), ElementsAre(std::pair("−ab", math)));
}

TEST(Formula, ScriptsAreSmallerBelowAndAboveAndEndWithTheirArgument) {
  const Formula it = formula("v_{ij}^2 /m", 100, {});
  ASSERT_EQ(it.spans.size(), 5u);
  EXPECT_EQ(it.spans[1].text, "ij");
  EXPECT_EQ(it.spans[2].text, "2");
  EXPECT_LT(it.spans[1].rise, 0);
  EXPECT_GT(it.spans[2].rise, 0);
  EXPECT_LT(it.spans[1].size, 100);
  EXPECT_EQ(it.spans[3].text, " /");
  EXPECT_EQ(it.spans[3].rise, 0);
  EXPECT_EQ(it.spans[3].size, 100);
}

TEST(Formula, AnAccentLiesOverItsLetter) {
  const Formula it = formula("x\\bar{v}", 100, {}), x = formula("x", 100, {});
  ASSERT_EQ(it.overs.size(), 1u);
  EXPECT_GT(it.overs[0].from, x.width);
  EXPECT_LE(it.overs[0].to, it.width + 4);  // an italic leans over its own width a little
}

/// From the lowest to the highest of all that is set, by the parts' own boxes.
std::pair<double, double> extent_of(const Formula& it) {
  double low = -it.descent, high = it.ascent;
  for (std::size_t i = 0; i < it.parts.size(); ++i) {
    const auto [below, above] = extent_of(it.parts[i]);
    low = std::min(low, below - it.places[i].y()), high = std::max(high, above - it.places[i].y());
  }
  return {low, high};
}

TEST(Formula, AFractionsBarLiesBetweenItsParts) {
  const Formula it = formula("x \\frac{a+b}{2} y", 100, {});
  ASSERT_EQ(it.parts.size(), 2u);
  ASSERT_EQ(it.lines.size(), 1u);
  const double bar = it.lines[0].points[0].y();
  // the numerator ends above it, the denominator begins below
  EXPECT_LT(it.places[0].y() + it.parts[0].descent, bar);
  EXPECT_GT(it.places[1].y() - it.parts[1].ascent, bar);
  // both are over the middle of the bar
  const double middle = (it.lines[0].points[0].x() + it.lines[0].points[1].x()) / 2;
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(it.places[std::size_t(k)].x() + it.parts[std::size_t(k)].width / 2, middle, 1);
  // and what follows comes after them
  EXPECT_GT(it.width, it.lines[0].points[1].x() + formula("y", 100, {}).width);
  const auto [low, high] = extent_of(it);
  EXPECT_NEAR(low, -it.descent, 1e-9);
  EXPECT_NEAR(high, it.ascent, 1e-9);
  // alone too, and within each other
  EXPECT_GT(formula("\\frac{1}{2}", 100, {}).width, 30);
  EXPECT_GT(formula("\\frac{1}{1+\\frac{1}{2}}", 100, {}).descent, it.descent);
}

TEST(Formula, ARootCoversWhatIsUnderIt) {
  const Formula it = formula("\\sqrt{2gh}", 100, {}), under = formula("2gh", 100, {});
  ASSERT_EQ(it.lines.size(), 1u);
  ASSERT_EQ(it.parts.size(), 1u);
  const auto& sign = it.lines[0].points;
  EXPECT_GT(sign.back().x(), it.places[0].x() + under.width);
  EXPECT_LT(sign.back().y(), it.places[0].y() - under.ascent);
  EXPECT_GE(it.width, sign.back().x());
  EXPECT_GE(it.ascent, -sign.back().y());
}

TEST(Formula, LimitsStandBelowAndAboveASumAndBesideAnIntegral) {
  const Formula sum = formula("\\sum_{i=1}^n i", 100, {});
  ASSERT_EQ(sum.parts.size(), 3u);
  EXPECT_GT(sum.places[1].y(), 20);
  EXPECT_LT(sum.places[2].y(), -60);
  EXPECT_GT(sum.descent, 40);
  EXPECT_TRUE(formula("\\int_a^b f", 100, {}).parts.empty());
}

TEST(Formula, BetweenDollarsItIsAsInLatex) {
  using enum Face;
  // spaces mean nothing, letters are letters, words outside are words
  const std::vector<std::pair<std::string, Face>> expected{{"energy ", math}, {"mgh", math_italic}};
  EXPECT_EQ(set("energy $m g h$"), expected);
  EXPECT_GT(formula("$a=b$", 100, {}).width, formula("a=b", 100, {}).width + 40);
  EXPECT_EQ(set("$\\text{at rest}$")[0].first, "at rest");
  EXPECT_EQ(set("$\\sin\\theta$")[0].second, math);
}

TEST(Formula, AnUnknownCommandIsToldWithItsColumn) {
  EXPECT_FALSE(mistake("\\frac{\\omega^2}{\\sqrt[3]{2}} \\hat n \\, \\text{a}"));
  EXPECT_FALSE(mistake("\"a \\b\""));
  const auto found = mistake("v = \\omgea r");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->column, 5u);
  EXPECT_EQ(found->what, "unknown command '\\omgea'; did you mean '\\omega'?");
  EXPECT_TRUE(mistake("a $b"));
}

TEST(Formula, WhatIsNotClosedOrNotKnownStaysReadable) {
  for (const char* text : {"v_", "v_{", "v^", "v\\", "*v", "\"v", "\\bar v", "\\bar{v", "v{}}"}) {
    std::string read;
    for (const auto& [words, face] : set(text)) read += words;
    EXPECT_THAT(read, testing::HasSubstr("v")) << text;
  }
  EXPECT_EQ(set("\\nosuchname")[0].first, "\\nosuchname");
  for (const char* text : {"^", "\\", "\\bar", "\\bar{"}) EXPECT_GE(formula(text, 100, {}).width, 0) << text;
}

TEST(Formula, AValueHasThreeDigitsAndItsUnit) {
  EXPECT_EQ(with_value("v = {}", 2.34567, "m/s"), "v = 2.35\" m/s\"");
  EXPECT_EQ(with_value("v", 2, "m/s"), "v");
  // degrees stand at their number
  EXPECT_EQ(with_value("\\alpha = {}", 30, "°"), "\\alpha = 30\"°\"");
  // what is almost one is shown as one is: as wide
  EXPECT_EQ(live("{}", 0.99999999, 0.99999999, 0.99999999, "m", 24, {}).width,
            live("{}", 1, 1, 1, "m", 24, {}).width);
  EXPECT_NE(live("{}", 0.994, 0.994, 0.994, "m", 24, {}).width, live("{}", 1, 1, 1, "m", 24, {}).width);
  EXPECT_EQ(as_vector("v_center"), "*v*_center");
  EXPECT_EQ(as_vector("*J* = J*n*"), "*J* = J*n*");
  // a product has no first letter that is its vector
  EXPECT_EQ(as_vector("mg"), "mg");
  EXPECT_EQ(as_vector("m g"), "m g");
  EXPECT_EQ(as_vector("m_1 g = {}"), "m_1 g = {}");
  EXPECT_EQ(as_vector("m \\ddot{x}"), "m \\ddot{x}");
  EXPECT_EQ(as_vector("k \\Delta"), "*k* \\Delta");
  EXPECT_EQ(as_vector("v_1'"), "*v*_1'");
  EXPECT_EQ(as_vector("F \\approx 2"), "*F* \\approx 2");
  EXPECT_EQ(as_vector("v = {:.1} m/s"), "*v* = {:.1} m/s");
  EXPECT_EQ(as_vector("net force"), "net force");
}

// A number that changes: the digits stay, and nothing but its own space stands between it and the sign.
TEST(Formula, DigitsOfALiveValueStayAndLeaveNoHole) {
  const std::string text = "F = {:.1} N";
  const auto ends = [&](double value) {
    const Formula it = live(text, value, -3.2, 120, "N", 100, {});
    double x = 0, equals = 0;
    std::vector<double> at;  // where the sign, the number and the unit end
    for (const Span& span : it.spans) {
      x += span.lead;
      if (span.tabular) {
        EXPECT_NEAR(x, equals, 1e-9) << value;
      }
      x += shape({{0, 0}, Align::left, {span}}).width - span.lead;
      if (span.text.find('=') != std::string::npos) equals = x;
      at.push_back(x);
    }
    EXPECT_NEAR(x, it.width, 1e-6) << value;
    return at;
  };
  const std::vector<double> long_one = ends(120), short_one = ends(2.4), below = ends(-3.2);
  ASSERT_EQ(short_one.size(), long_one.size());
  for (std::size_t k = short_one.size() - 2; k < short_one.size(); ++k) {
    EXPECT_NEAR(short_one[k], long_one[k], 1e-9) << k;
    EXPECT_NEAR(below[k], long_one[k], 1e-9) << k;
  }
}

TEST(Formula, UnitsAfterANumberAreUpright) {
  using enum Face;
  EXPECT_THAT(set("m = 2 kg"), ElementsAre(std::pair("m", math_italic), std::pair(" = 2 kg", math)));
  EXPECT_THAT(set("9.8 m/s^2"), ElementsAre(std::pair("9.8 m/s", math), std::pair("2", math)));
  EXPECT_THAT(set("3 N m"), ElementsAre(std::pair("3 N m", math)));
  EXPECT_THAT(set("2 m v"), ElementsAre(std::pair("2 ", math), std::pair("m", math_italic),
                                        std::pair(" ", math), std::pair("v", math_italic)));
  EXPECT_THAT(set("2 g"), ElementsAre(std::pair("2 ", math), std::pair("g", math_italic)));
  EXPECT_EQ(latex("m = 2 kg"), "$m=2\\ \\mathrm{kg}$");
}

// Beside an arrow, of a film or in print, however it turns: no corner of the words lies over its line.
TEST(Placing, WordsBesideAnArrowClearItsLineAtAnyAngle) {
  const Point tail(0, 0), size(140, 28);
  for (int k = 0; k < 144; ++k) {
    const Point u(std::cos(k * 0.0872665), std::sin(k * 0.0872665)), v(-u.y(), u.x());
    for (const Placing::Candidate& each : Placing::along(tail, 300 * u, 8, size, 3, k < 72)) {
      const double middle = each.center.dot(v), half = (size / 2).dot(v.cwiseAbs());
      // beyond its tip it stands across the line, and off the arrow by the part of the gap along an axis
      bool at_tip = each.center.dot(u) > 300 && std::abs(middle) <= half;
      for (double s = 0; s <= 300; s += 1)
        at_tip = at_tip &&
                 ((s * u - each.center).cwiseAbs() - size / 2).cwiseMax(0).norm() > 8 / std::sqrt(2.0) - 1e-9;
      EXPECT_TRUE(at_tip || std::abs(middle) - half > 8 - 1e-9) << k << " " << middle << " " << half;
    }
  }
}

TEST(Placing, WordsKeepOffLinesAndOffEachOther) {
  Placing placing({0, 0, 400, 400});
  const Point at(200, 200), size(40, 20);
  // all but straight down is barred
  for (const double y : {150.0, 165.0, 180.0, 190.0}) placing.avoid({0, y}, {400, y}, 10);
  const auto first = placing.place(size, Placing::around(at, 8, size, 4));
  EXPECT_GT(first.center.y() - size.y() / 2, 190);
  const auto second = placing.place(size, Placing::around(at, 8, size, 4));
  const Point apart = (second.center - first.center).cwiseAbs();
  EXPECT_TRUE(apart.x() >= size.x() || apart.y() >= size.y());
}

TEST(Placing, WordsStayOnThePage) {
  Placing placing({0, 0, 400, 400});
  const Point size(60, 20);
  const auto place = placing.place(size, Placing::around({398, 2}, 8, size, 4));
  EXPECT_LE(place.center.x() + size.x() / 2, 400);
  EXPECT_GE(place.center.y() - size.y() / 2, 0);
}

TEST(Plot, TicksAreRoundNumbersWithinTheirRange) {
  EXPECT_THAT(ticks(0, 1, 5), testing::Pointwise(testing::DoubleEq(), {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(ticks(-3, 12, 4), testing::Pointwise(testing::DoubleEq(), {0.0, 5.0, 10.0}));
  EXPECT_THAT(ticks(2, 2, 4), ElementsAre(2));
}

}  // namespace
}  // namespace obscura::draw
