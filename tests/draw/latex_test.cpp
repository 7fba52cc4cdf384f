#include "draw/picture/latex.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "draw/picture/formula.h"

namespace obscura::draw {
namespace {

TEST(Latex, SaysWhatTheFormulaSays) {
  for (const auto& [text, written] : {
           std::pair("v_center'", "$v_{\\mathrm{center}}^{\\prime}$"),
           std::pair("a_{ij}", "$a_{ij}$"),
           std::pair("*J* = -(1 + e) v_n *n*", "$\\obscurabold{J}=-(1+e)\\ v_{n}\\ \\obscurabold{n}$"),
           std::pair("*r* \\perp *n*", "$\\obscurabold{r}\\perp \\obscurabold{n}$"),
           std::pair("F = 0.5 \"m/s\"", "$F=0.5\\ \\obscuratext{m/s}$"),
           std::pair("\\frac{1}{2} m v^2", "$\\frac{1}{2}\\ m\\ v^{2}$"),
           std::pair("\\sqrt[3]{2gh}", "$\\sqrt[3]{2gh}$"),
           std::pair("\\sum_{i=1}^n m_i", "$\\sum\\limits _{i=1}^{n}\\ m_{i}$"),
           std::pair("\\int_a^b", "$\\int _{a}^{b}$"),
           std::pair("\\dot{q}\\hat n", "$\\dot{q}\\hat{n}$"),
           std::pair("\\text{at rest}", "$\\obscuratext{at rest}$"),
           std::pair("\\theta = 30\\deg", "$\\theta =30^{\\circ}$"),
           std::pair("30^\\circ", "$30^{\\circ}$"),
           std::pair("\\theta / \"deg\"", "$\\theta \\ /\\ \\obscuratext{deg}$"),
           std::pair("x / \"m\"", "$x\\ /\\ \\obscuratext{m}$"),
           std::pair("θ ≤ π", "$\\theta \\le \\pi$"),
           std::pair("\\sin \\omega t", "$\\sin \\omega t$"),
           std::pair("e = 0.8", "$e=0.8$"),
           std::pair("sin\\theta", "$\\sin \\theta$"),
           std::pair("\\$5 for $x$", "\\$5 for $x$"),
           std::pair("\\dfrac{1}{2}\\overline{AB}", "$\\frac{1}{2}\\overline{AB}$"),
           std::pair("\\operatorname{div} a", "$\\mathop{\\mathrm{div}}\\nolimits a$"),
           std::pair("$\\left( \\frac{a}{b} \\right\\}$", "$\\left(\\frac{a}{b}\\right\\}$"),
           std::pair("\\left( \\frac{a}{b} \\right)", "$\\left(\\frac{a}{b}\\right)$"),
           std::pair("\\left( x", "$(x$"),
           std::pair("at $t=0$, 50%", "at $t=0$, 50\\%"),
       })
    EXPECT_EQ(latex(text), written) << text;
}

/// LaTeX refuses two scripts of a kind after one another.
TEST(Latex, GivesASecondScriptABaseOfItsOwn) {
  EXPECT_EQ(latex("v'^2"), "$v^{\\prime}{}^{2}$");
  EXPECT_EQ(latex("a_b_c"), "$a_{b}{}_{c}$");
  EXPECT_EQ(latex("v_a'"), "$v_{a}^{\\prime}$");
}

TEST(Latex, EscapesItsOwnCharacters) {
  EXPECT_EQ(latex_text("100 % of {a_b} & #1 $~^\\"),
            "100 \\% of \\{a\\_b\\} \\& \\#1 \\$\\~{}\\^{}\\textbackslash{}");
  EXPECT_EQ(latex_text("30° – 2 × 5 m²"), "30${}^{\\circ}$ -- 2 $\\times $ 5 m${}^{2}$");
}

TEST(Latex, NumbersTakeTheDecimalMark) {
  EXPECT_EQ(latex_with_mark("$t=0.25\\ \\obscuratext{s}$, fig. 2.", ","),
            "$t=0{,}25\\ \\obscuratext{s}$, fig. 2.");
}

/// On a list whose words are apart nothing is type, and each is held where its side says.
TEST(Latex, WordsOfAListAreApartAndHeld) {
  List list, page;
  list.apart = page.apart = true;
  const Formula f = formula("v = 2", 40, {});
  add(f, {100, 50}, list, {Align::right, Level::top});
  list.add(Text{{10, 20}, Align::center, {{.text = "50 %", .face = Face::bold, .size = 30}}});
  EXPECT_TRUE(list.texts.empty());
  page.add(list, 2, {1000, 0});
  ASSERT_EQ(page.words.size(), 2u);
  EXPECT_EQ(page.words[0].latex, "$v=2$");
  EXPECT_NEAR(page.words[0].at.x(), 1000 + 2 * (100 + f.width), 1e-9);
  EXPECT_NEAR(page.words[0].at.y(), 2 * (50 - f.ascent), 1e-9);
  EXPECT_EQ(page.words[0].size, 80);
  EXPECT_EQ(page.words[1].latex, "\\textbf{50 \\%}");
  EXPECT_EQ(page.words[1].align, Align::center);
}

}  // namespace
}  // namespace obscura::draw
