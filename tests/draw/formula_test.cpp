#include "draw/picture/formula.h"
#include "draw/picture/formula_values.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/page/placing.h"
#include "draw/page/plot.h"
#include "draw/picture/latex.h"
#include "draw/picture/prose.h"
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

TEST(Formula, ARaisedDigitIsAScript) {
  for (const auto& [sign, script] : {std::pair("5 m/s²", "5 m/s^2"), std::pair("x³ y", "x^3 y")}) {
    const Formula raised = formula(sign, 10, {}), typed = formula(script, 10, {});
    ASSERT_EQ(raised.spans.size(), typed.spans.size()) << sign;
    for (std::size_t i = 0; i < typed.spans.size(); ++i) {
      EXPECT_EQ(raised.spans[i].text, typed.spans[i].text);
      EXPECT_EQ(raised.spans[i].size, typed.spans[i].size);
      EXPECT_EQ(raised.spans[i].rise, typed.spans[i].rise);
    }
  }
}

TEST(Formula, AnUnknownCommandIsToldWithItsColumn) {
  EXPECT_FALSE(mistake("\\frac{\\omega^2}{\\sqrt[3]{2}} \\hat n \\, \\text{a}"));
  EXPECT_FALSE(mistake("\"a \\b\""));
  const auto found = mistake("v = \\omgea r");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->column, 5u);
  EXPECT_EQ(found->what, "unknown command '\\omgea'; did you mean '\\omega'?");
  EXPECT_TRUE(mistake("a $b"));
  EXPECT_EQ(mistake("café \\omgea")->column, 6u);  // counted in characters
  // of TOML's "a \theta" a tab is left
  EXPECT_EQ(
      mistake("a \theta")->what,
      "in double quotes '\\theta' begins with a tab: write '\\\\theta', or put the text in single quotes");
  EXPECT_EQ(mistake("a \theta")->column, 3u);
  EXPECT_TRUE(mistake("in words \beta and $x$"));
  EXPECT_TRUE(mistake("$\nu$"));
  EXPECT_FALSE(mistake("words\nu$x$"));  // a line that ends
  EXPECT_FALSE(mistake("a \t b"));
  EXPECT_TRUE(prose_mistake("An angle \theta"));
  EXPECT_EQ(prose_mistake("Über $a$ und \rho")->column, 14u);
  EXPECT_FALSE(prose_mistake("Two lines\nu"));
}

// What is not whole: told at its column, with how it is written.
TEST(Formula, WhatIsNotWholeIsAMistake) {
  struct Case {
    const char *text, *what;
    std::size_t column;
  };
  for (const Case& wrong : {
           Case{"\\frac{1}", "'\\frac' needs what stands above and below: '\\frac{1}{2}'", 1},
           {"a \\frac{1}{2", "'{' without a '}' that closes it", 11},
           {"\\frac{}{2}", "'\\frac' needs", 1},
           {"\\sqrt", "'\\sqrt' needs what stands under it: '\\sqrt{2gh}'", 1},
           {"\\sqrt[3", "'[' without a ']'", 6},
           {"x^", "'^' without what it raises", 2},
           {"x_ y", "'_' without what it lowers", 2},
           {"10^{}", "'^' without what it raises", 3},
           {"v_{a^}", "'^' without what it raises", 5},
           {"{a", "'{' without a '}'", 1},
           {"a}", "'}' without a '{'", 2},
           {"\\hat", "'\\hat' needs its letter", 1},
           {"\\text", "'\\text' needs its words", 1},
           {"x^\\frac{1}{2}", "'\\frac' needs braces here", 3},
           {"\\left( x", "'\\left' without its '\\right'", 1},
           {"x \\right)", "'\\right' without its '\\left'", 3},
           {"\\left x \\right)", "'\\left' without a bracket", 1},
           {"*v", "'*' without another", 1},
           {"\"at rest", "'\"' without another", 1},
           {"so $\\sqrt$", "'\\sqrt' needs", 5},
           {"so $x$ and \\alpha", "outside of the dollars", 12},
           {"x\\", "without a command", 2},
       }) {
    const auto found = mistake(wrong.text);
    ASSERT_TRUE(found) << wrong.text;
    EXPECT_EQ(found->column, wrong.column) << wrong.text;
    EXPECT_THAT(found->what, testing::HasSubstr(wrong.what)) << wrong.text;
  }
  for (const char* whole :
       {"\\frac12", "\\frac \\pi 2", "x^*", "v^-", "v_center'", "v_\"max\"", "$x^ 2$", "{} m",
        "*v* = {:.2} m/s", "\\sqrt[3]{2}", "\\{ x \\}", "\\left\\{ \\frac{{}}{2} \\right.", "costs \\$5",
        "\\sum_{i=1}^n i", "[0, 1)", "\\overline{AB} \\dfrac{1}{2} \\tfrac12", "\\operatorname{div} *v*",
        "x'^2", "30^\\circ"})
    EXPECT_FALSE(mistake(whole)) << whole << ": " << mistake(whole)->what;
}

TEST(Formula, ADollarWithABackslashIsASign) {
  EXPECT_EQ(set("costs \\$5")[0].first, "costs $5");
  EXPECT_EQ(set("\\$5 for $x$")[0].first, "$5 for ");
  EXPECT_EQ(set("\"costs \\$5\"")[0].first, "costs $5");
}

// The limits keep off the ink of the sign, and not far.
TEST(Formula, LimitsOfASumAreClearOfItsSign) {
  for (const char* sign : {"\\sum", "\\prod"}) {
    const Formula it = formula(std::string(sign) + "_{i=1}^n", 100, {});
    ASSERT_EQ(it.parts.size(), 3u);
    const auto ink = [&](std::size_t k) {
      const auto [above, below] = ink_of({{0, 0}, Align::left, it.parts[k].spans});
      return std::pair(it.places[k].y() - above, it.places[k].y() + below);
    };
    const auto [top, foot] = ink(0);
    EXPECT_GT(ink(1).first, foot + 6) << sign;
    EXPECT_LT(ink(1).first, foot + 25) << sign;
    EXPECT_LT(ink(2).second, top - 6) << sign;
    EXPECT_GT(ink(2).second, top - 25) << sign;
  }
}

TEST(Formula, AFunctionHasRoomBeforeALetterNotBeforeABracket) {
  const auto room = [](const std::string& text, const std::string& first, const std::string& second) {
    return formula(text, 100, {}).width - formula(first, 100, {}).width - formula(second, 100, {}).width;
  };
  EXPECT_NEAR(room("\\sin\\theta", "\\sin", "\\theta"), 17, 1);
  EXPECT_NEAR(room("sin\\theta", "sin", "\\theta"), 17, 1);
  EXPECT_NEAR(room("\\sin(x)", "\\sin", "(x)"), 0, 1);
  EXPECT_NEAR(room("$\\sin^2 x$", "$\\sin^2$", "$x$"), 17, 1);
  EXPECT_NEAR(room("$\\sin (x)$", "$\\sin$", "$(x)$"), 0, 1);
  EXPECT_NEAR(room("$2\\sin x$", "$2$", "$\\sin x$"), 17, 1);
  EXPECT_NEAR(room("2\\operatorname{sinc} x", "2", "\\operatorname{sinc} x"), 17, 1);
}

TEST(Formula, BracketsAreAsHighAsWhatIsBetweenThem) {
  for (const auto& [left, right] : {std::pair("(", ")"), {"[", "]"}, {"\\{", "\\}"}}) {
    const Formula fraction = formula("\\frac{a}{b}", 100, {});
    const Formula it = formula(std::string("\\left") + left + "\\frac{a}{b}\\right" + right, 100, {});
    ASSERT_EQ(it.spans.size(), 2u);
    for (const Span& span : it.spans) {
      const auto [above, below] = ink_of({{0, 0}, Align::left, {span}});
      EXPECT_GT(above, fraction.ascent - 12) << left;
      EXPECT_GT(below, fraction.descent - 12) << left;
      EXPECT_NEAR(above - 25, below + 25, 12) << left;  // around the axis
    }
    EXPECT_GT(it.width, fraction.width + 50) << left;
  }
  const Formula bars = formula("\\left|\\frac{a}{b}\\right|", 100, {});
  ASSERT_EQ(bars.lines.size(), 3u);
  EXPECT_LT(bars.lines[0].points[0].y(), -formula("\\frac{a}{b}", 100, {}).ascent + 1);
  EXPECT_GT(bars.lines[2].points[0].x(), bars.lines[1].points[1].x());
  EXPECT_EQ(set("\\left\\| x \\right\\|")[0].first, "‖");
  EXPECT_EQ(formula("\\left\\| \\frac{a}{b} \\right\\|", 100, {}).lines.size(), 5u);
  EXPECT_NEAR(formula("\\left( \\frac{a}{b} \\right)", 100, {}).width,
              formula("\\left(\\frac{a}{b}\\right)", 100, {}).width, 1e-9);
  // what is not high has brackets of their own size
  EXPECT_EQ(formula("\\left(x\\right)", 100, {}).spans[0].size, 100);
  EXPECT_EQ(formula("\\left.\\frac{a}{b}\\right|", 100, {}).lines.size(), 2u);
}

TEST(Formula, ALineLiesOverAllOfIt) {
  const Formula it = formula("\\overline{AB}", 100, {}), letters = formula("AB", 100, {});
  ASSERT_EQ(it.overs.size(), 1u);
  EXPECT_NEAR(it.overs[0].to - it.overs[0].from, letters.width, 4);
  EXPECT_GT(it.overs[0].rise, letters.ascent);
  EXPECT_NEAR(formula("\\dfrac{1}{2}", 100, {}).width, formula("\\frac{1}{2}", 100, {}).width, 1e-9);
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

TEST(Formula, ADegreeIsUpAlready) {
  for (const char* text : {"30^\\circ", "30^{\\circ}", "30^°"})
    EXPECT_EQ(formula(text, 24, {}).spans, formula("30°", 24, {}).spans) << text;
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

// A number that changes: its end, and all that stands before it and behind it, stays where it is, whatever
// digits and sign the number has.
TEST(Formula, ALiveLabelKeepsItsPlaceAndItsWidth) {
  for (const std::string text : {"v_y = {:.1} m/s", "F = {}", "$\\frac{1}{2} = {}$", "{}"}) {
    const auto places = [&](double value) {
      const Formula it = live(text, value, -3.2, 120, "m/s", 100, {});
      double x = 0;
      std::vector<double> at{it.width};  // where what does not change begins, and the number ends
      for (const Span& span : it.spans) {
        x += span.lead;
        if (!span.tabular) at.push_back(x);
        x += shape({{0, 0}, Align::left, {span}}).width - span.lead;
        if (span.tabular) at.push_back(x);
      }
      for (const Point& place : it.places) at.push_back(place.x());
      return at;
    };
    const std::vector<double> widest = places(120);
    for (const double value : {-3.2, -0.04, 0.0, 9.99, 10.01, 99.96}) {
      const std::vector<double> at = places(value);
      ASSERT_EQ(at.size(), widest.size()) << text;
      for (std::size_t k = 0; k < at.size(); ++k) EXPECT_NEAR(at[k], widest[k], 1e-9) << text << " " << value;
    }
  }
  // a peak between the samples of the run has its place
  EXPECT_EQ(live("{:.2}", 10.01, 0, 9.99, "", 100, {}).width, live("{:.2}", 5, 0, 9.99, "", 100, {}).width);
  // a value of one sign and one number of digits has no room before it
  EXPECT_NEAR(live("{:.1}", 5, 2, 9, "", 100, {}).width,
              formula("\x01"
                      "5.0\x02",
                      100, {})
                  .width,
              1e-9);
}

// Powers of ten in place of "e+14", from a million up and below a ten thousandth.
TEST(Formula, LargeAndSmallNumbersHaveAPowerOfTen) {
  EXPECT_EQ(as_number(7.4e14), "7.4 \\times 10^{14}");
  EXPECT_EQ(as_number(-5e-8), "-5 \\times 10^{-8}");
  EXPECT_EQ(as_number(250000), "250000");
  EXPECT_EQ(as_number(0), "0");
  EXPECT_THAT(as_numbers({0, 5e-8, 1e-7}), ElementsAre("0", "0.5 \\times 10^{-7}", "1 \\times 10^{-7}"));
  EXPECT_THAT(as_numbers({0, 0.00005, 0.0001}), ElementsAre("0", "0.5 \\times 10^{-4}", "1 \\times 10^{-4}"));
  EXPECT_THAT(as_numbers({-0.5, 1e-17, 0.5}), ElementsAre("-0.5", "0", "0.5"));
  // as many digits as tell them apart
  EXPECT_THAT(as_numbers({100000.5, 100001, 100001.5}), ElementsAre("100000.5", "100001", "100001.5"));
  EXPECT_THAT(as_numbers({5, 5.0000001, 5.0000002}), ElementsAre("5", "5.0000001", "5.0000002"));
  EXPECT_THAT(as_numbers({1e9, 1e9 + 1}), ElementsAre("1 \\times 10^{9}", "1.000000001 \\times 10^{9}"));
  EXPECT_THAT(as_numbers({0.1 + 0.2, 0.4}), ElementsAre("0.3", "0.4"));
  EXPECT_EQ(with_value("p = {}", 1204318732728, "kg m/s"), "p = 1.20 \\times 10^{12}\" kg m/s\"");
  EXPECT_EQ(with_value("{}", 9.999e-5, "m"), "1.00 \\times 10^{-4}\" m\"");
  EXPECT_EQ(with_value("{}", 1216.4, "m/s"), "1216\" m/s\"");
  EXPECT_EQ(with_value("{}", 999.7, "m/s"), "1000\" m/s\"");
  EXPECT_EQ(with_value("{}", 999999.7, "m"), "1.00 \\times 10^{6}\" m\"");
  EXPECT_EQ(with_value("{}", 1e-12, "m"), "1.00 \\times 10^{-12}\" m\"");
  EXPECT_EQ(with_value("{:.1}", 2e6, "m"), "2000000.0");
  // all of a run have the largest's
  const auto read = [](double value) {
    std::string all;
    for (const Span& span : live("{}", value, 0, 7.4e14, "J", 100, {}).spans) all += span.text;
    return all;
  };
  EXPECT_EQ(read(7.4e14), "7.40 × 1014 J");
  EXPECT_EQ(read(2e12), "0.02 × 1014 J");
  // between words it is mathematics too
  EXPECT_EQ(with_value("so {} of $v$", 2e7, "m"), "so $2.00 \\times 10^{7}\" m\"$ of $v$");
  EXPECT_FALSE(mistake(with_value("{}", 2e7, "m")));
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
  // the letter as it looks here; LaTeX's own word as it looks there
  EXPECT_EQ(latex("φ + ε"), "$\\varphi +\\varepsilon$");
  EXPECT_EQ(latex("\\phi"), "$\\phi$");
}

// Beside an arrow, of a film or in print, however it turns: no corner of the words lies over its line.
TEST(Placing, WordsBesideAnArrowClearItsLineAtAnyAngle) {
  const Point tail(0, 0), size(140, 28);
  for (int k = 0; k < 144; ++k) {
    const Point u(std::cos(k * 0.0872665), std::sin(k * 0.0872665)), v(-u.y(), u.x());
    for (const Placing::Candidate& each : Placing::along(tail, 300 * u, 8, size, 3, k < 72)) {
      const double middle = each.center.dot(v), half = (size / 2).dot(v.cwiseAbs());
      // beyond its ends it stands across the line, and off the arrow by the part of the gap along an axis
      bool at_end = std::abs(each.center.dot(u) - 150) > 150 && std::abs(middle) <= half;
      for (double s = 0; s <= 300; s += 1)
        at_end = at_end &&
                 ((s * u - each.center).cwiseAbs() - size / 2).cwiseMax(0).norm() > 8 / std::sqrt(2.0) - 1e-9;
      EXPECT_TRUE(at_end || std::abs(middle) - half > 8 - 1e-9) << k << " " << middle << " " << half;
    }
  }
}

TEST(Placing, WordsKeepOffLinesAndOffEachOther) {
  Placing placing({0, 0, 400, 400});
  const Point at(200, 200), size(40, 20);
  // all but straight down is barred
  for (const double y : {150.0, 165.0, 180.0, 190.0}) placing.avoid({0, y}, {400, y}, 10);
  const Placing::Words words{size, Placing::around(at, 8, size, 4)};
  const auto both = placing.place({words, words});
  for (const Placing::Candidate& each : both) EXPECT_GT(each.center.y() - size.y() / 2, 190);
  const Point apart = (both[1].center - both[0].center).cwiseAbs();
  EXPECT_TRUE(apart.x() >= size.x() || apart.y() >= size.y());
}

TEST(Placing, WordsStayOnThePage) {
  Placing placing({0, 0, 400, 400});
  const Point size(60, 20);
  const auto place = placing.place({{size, Placing::around({398, 2}, 8, size, 4)}})[0];
  EXPECT_LE(place.center.x() + size.x() / 2, 400);
  EXPECT_GE(place.center.y() - size.y() / 2, 0);
}

// A leader may leave the arrow and the body that it begins in, and cross what is no arrow, at no cost.
TEST(Placing, LeadersKeepOffOtherArrowsAndBodies) {
  const auto square = [](double x, double y) {
    return std::vector<Point>{{x - 10, y - 10}, {x + 10, y - 10}, {x + 10, y + 10}, {x - 10, y + 10}};
  };
  Placing placing({0, 0, 400, 400});
  const Point at(100, 100), size(40, 20);
  const auto cost = [&](const Point& center) { return placing.leading(at, size, center, 30); };
  placing.avoid({80, 100}, {120, 100}, 4, true), placing.avoid(square(100, 100), 200);
  placing.avoid({150, 0}, {150, 400}, 4);
  EXPECT_EQ(cost({300, 200}), 0);
  placing.avoid({200, 0}, {200, 400}, 4, true);
  EXPECT_EQ(cost({300, 200}), 30);
  EXPECT_EQ(cost({100, 300}), 0);
  // words that reach to the arrow are not led across it
  EXPECT_EQ(cost({215, 100}), 0);
  // half of the way, or so, over a body
  placing.avoid(square(100, 150), 400);
  EXPECT_GT(cost({100, 200}), 30 + 50);
  EXPECT_LT(cost({100, 200}), 30 + 200);
  // one that costs hardly anything is crossed
  placing.avoid(square(50, 100), 20);
  EXPECT_EQ(cost({20, 100}), 0);
}

TEST(Plot, TicksAreRoundNumbersWithinTheirRange) {
  EXPECT_THAT(ticks(0, 1, 5), testing::Pointwise(testing::DoubleEq(), {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_THAT(ticks(-3, 12, 4), testing::Pointwise(testing::DoubleEq(), {0.0, 5.0, 10.0}));
  EXPECT_THAT(ticks(2, 2, 4), ElementsAre(2));
}

}  // namespace
}  // namespace obscura::draw
