#include "draw/picture/formula.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/page/placing.h"
#include "draw/page/plot.h"

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
  EXPECT_EQ(as_vector("v_center"), "*v*_center");
  EXPECT_EQ(as_vector("*J* = J*n*"), "*J* = J*n*");
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
