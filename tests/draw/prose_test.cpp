// Words with mathematics between dollars: what is which, in letters alone, how wide, and where it is wrong.

#include "draw/picture/prose.h"

#include <gtest/gtest.h>

#include "draw/page/layout.h"

namespace obscura::draw {
namespace {

TEST(Prose, DollarsHoldMathematicsAsInPandoc) {
  const std::vector<Phrase> all = phrases("a slope of $\\mu = 0.3$, and $E$");
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].text, "a slope of ");
  EXPECT_TRUE(all[1].mathematics);
  EXPECT_EQ(all[1].text, "\\mu = 0.3");
  EXPECT_EQ(all[2].text, ", and ");
  EXPECT_EQ(all[3].text, "E");
  for (const char* money : {"from $5 to $10", "$ 5 $", "5 $", "no dollars", ""})
    EXPECT_FALSE(contains_mathematics(money)) << money;
}

TEST(Prose, IsReadInLetters) {
  EXPECT_EQ(in_letters("Energy $E = \\frac{1}{2} m v^2$ of $q_0$"), "Energy E = ½ m v² of q₀");
  EXPECT_EQ(in_letters("$\\sqrt{2gh}$, $\\sqrt[3]{V}$, $\\int_0^1 x$"), "√(2gh), ³√V, ∫₀¹ x");
  EXPECT_EQ(in_letters("$\\frac{v_0^2}{2\\mu g}$, $\\frac{v_0}{12.5}$, $\\sqrt{\\hat{a}}$"),
            "v₀²/(2μ g), v₀/12.5, √a\u0302");
  EXPECT_EQ(in_letters("$\\left. x \\right|$"), " x |");
  EXPECT_EQ(in_letters("$\\frac{f + g}{N}$ and $\\dot{q}$, $x^{ab}$"), "(f + g)/N and q̇, x^(ab)");
  EXPECT_EQ(in_letters("costs $5 or $10"), "costs $5 or $10");
  EXPECT_EQ(formula_in_letters("E_{kin} = *v* \\cdot \\text{all}"), "E_kin = v · all");
}

TEST(Prose, MistakesHaveTheirColumn) {
  EXPECT_FALSE(prose_mistake("no \\omgea here, and $\\omega$ there"));
  const auto wrong = prose_mistake("the rate $\\omgea$");
  ASSERT_TRUE(wrong);
  EXPECT_EQ(wrong->column, 11u);
  EXPECT_NE(wrong->what.find("\\omega"), std::string::npos);
  EXPECT_EQ(prose_mistake("é and $\\frac{1}$")->column, 8u);
  EXPECT_EQ(prose_mistake("the rate $\\omega t")->column, 10u);  // not closed, and no money
  EXPECT_FALSE(prose_mistake("from $5 to \\$10"));
}

TEST(Prose, ADollarWithABackslashIsASign) {
  EXPECT_EQ(in_letters("costs \\$5 or \\$x$"), "costs $5 or $x$");
  EXPECT_FALSE(contains_mathematics("\\$x\\$"));
  const Formula set = prose("\\$5 for $x$", Face::regular, 20, {});
  ASSERT_EQ(set.parts.size(), 2u);
  EXPECT_EQ(set.parts[0].spans[0].text, "$5 for ");
  EXPECT_EQ(width_of("\\$5", Face::regular, 20), width_of("$5", Face::regular, 20));
  List list;
  add_prose("costs \\$5", Face::regular, 20, {}, {0, 0}, Align::left, list);
  EXPECT_EQ(list.texts.at(0).spans[0].text, "costs $5");
}

TEST(Prose, IsAsWideAsItsParts) {
  const double words = width_of("the slope ", Face::regular, 20);
  const Formula set = prose("the slope $\\mu$", Face::regular, 20, {});
  ASSERT_EQ(set.parts.size(), 2u);
  EXPECT_NEAR(set.width, words + set.parts[1].width, 1e-9);
  EXPECT_NEAR(set.places[1].x(), words, 1e-9);
  EXPECT_NEAR(width_of("the slope $\\mu$", Face::regular, 20), set.width, 1e-9);
}

TEST(Prose, LinesEndBetweenWordsAndNotInMathematics) {
  const std::string words = "so $a + b + c$ it is";
  for (double width = 10; width < 300; width += 5)
    for (const std::string& line : wrapped(words, Face::regular, 20, width))
      EXPECT_EQ(contains_mathematics(line), line.find('$') != line.npos) << line;
  const std::string cut = fitted("words and $a + b + c$", Face::regular, 20, 150);
  EXPECT_EQ(cut.find('$'), std::string::npos) << cut;
}

}  // namespace
}  // namespace obscura::draw
