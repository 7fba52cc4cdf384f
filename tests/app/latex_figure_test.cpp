// Figures in two files, for LaTeX: lines in a PDF, words over it in the document's own fonts.

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <vector>

#include <gmock/gmock.h>

#include "needs.h"
#include "page/page.h"
#include "program.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

const char* const kNamed = R"(
duration = 2
[room]
size = [4, 2.5]
[[ball]]
name = "ball"
radius = 0.2
position = [1.2, 1.5]
velocity = [1.5, 0.5]
[figure]
at = 0.4
axes = true
scale_bar = true
formula = '*J* = J *n*, \frac{1}{2} m v_0^2'
[[figure.vector]]
quantity = "velocity"
of = "ball"
label = "v_center"
[[figure.point]]
at = [3.2, 0.5]
label = "P'"
[[figure.plot]]
quantity = ["energy", "kinetic"]
)";

class LatexFigure : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    OBSCURA_NEEDS(page::writes(page::Form::pdf), "libcairo2-dev, where it is built");
    OBSCURA_NEEDS(installed("pdftotext"), "poppler-utils");
    scene(kNamed);
  }

  /// A document of one figure, set by an engine; its log in the error where that fails.
  void document(const std::string& engine, const std::string& before = "") const {
    scene("\\documentclass{article}\\usepackage{graphicx,color}\\pagestyle{empty}\\begin{document}\n" +
              before + "\\noindent\\input{figures/a.tex}\n\\end{document}\n",
          "document.tex");
    const Outcome set = shell(engine + " -interaction=nonstopmode -halt-on-error document.tex");
    ASSERT_EQ(set.exit, 0) << set.out;
    // a glyph that no font has, a file that is missing
    EXPECT_THAT(set.out, Not(HasSubstr("Missing character")));
    EXPECT_THAT(set.out, Not(HasSubstr("not available")));
  }
};

/// A word of a page, pt.
struct Written {
  double left = 0, top = 0, right = 0, bottom = 0;
};

// by pdftotext -bbox
std::multimap<std::string, Written> words_of(const std::string& page) {
  std::multimap<std::string, Written> all;
  static const std::regex word(
      "<word xMin=\"([0-9.]+)\" yMin=\"([0-9.]+)\" xMax=\"([0-9.]+)\" yMax=\"([0-9.]+)\">([^<]*)</word>");
  for (std::sregex_iterator it(page.begin(), page.end(), word), end; it != end; ++it)
    all.emplace((*it)[5],
                Written{std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4])});
  return all;
}

TEST_F(LatexFigure, LinesAreAPdfWithoutWordsAndWordsAreLatex) {
  ASSERT_EQ(obscura("figure scene.toml -o a.tex").exit, 0);
  EXPECT_EQ(shell("pdftotext a-lines.pdf - | tr -d '\\f\\n '").out, "");
  const std::string words = contents(path("a.tex"));
  for (const char* each : {"\\includegraphics[width=238.11\\unitlength]{\\obscurafolder a-lines.pdf}",
                           "$\\obscurabold{v}_{\\mathrm{center}}$", "$P^{\\prime}$", "\\frac{1}{2}",
                           "$x\\ /\\ \\obscuratext{m}$", "\\obscuratext{m/s}"})
    EXPECT_THAT(words, HasSubstr(each));
}

TEST_F(LatexFigure, IsTheSameBytesWheneverItIsMade) {
  ASSERT_EQ(obscura("figure scene.toml -o a.tex").exit, 0);
  const std::string words = contents(path("a.tex")), lines = contents(path("a-lines.pdf"));
  ASSERT_EQ(obscura("figure scene.toml -o a.tex").exit, 0);
  EXPECT_EQ(contents(path("a.tex")), words);
  EXPECT_EQ(contents(path("a-lines.pdf")), lines);
}

/// In the document's fonts, found beside the .tex wherever that lies.
TEST_F(LatexFigure, BothEnginesSetItInTheDocumentsFonts) {
  OBSCURA_NEEDS(installed("pdflatex"), "texlive-latex-base");
  OBSCURA_NEEDS(installed("lualatex"), "texlive-luatex");
  ASSERT_EQ(obscura("figure scene.toml -o figures/a.tex").exit, 0);
  for (const std::string engine : {"pdflatex", "lualatex"}) {
    document(engine);
    if (HasFatalFailure()) return;
    const std::string text = shell("pdftotext document.pdf -").out;
    for (const char* each : {"center", "total", "kinetic", "m/s"})
      EXPECT_THAT(text, HasSubstr(each)) << engine;
    const std::string fonts = shell("pdffonts document.pdf").out;
    EXPECT_THAT(fonts, Not(HasSubstr("STIX"))) << engine;
    EXPECT_THAT(fonts, Not(HasSubstr("Inter"))) << engine;
  }
}

/// The document's font has other widths: the numbers of an axis still end at it, names still begin where
/// lines end. Against the same figure as one PDF: an end that is held is within 0.6 pt, the side bearings of
/// digits; the others may move.
TEST_F(LatexFigure, WordsAreHeldOnTheSideOfWhatTheyName) {
  OBSCURA_NEEDS(installed("pdflatex"), "texlive-latex-base");
  ASSERT_EQ(obscura("figure scene.toml --set 'figure.formula=\"\"' -o figures/a.tex").exit, 0);
  ASSERT_EQ(obscura("figure scene.toml --set 'figure.formula=\"\"' -o whole.pdf").exit, 0);
  document("pdflatex");
  if (HasFatalFailure()) return;
  const auto set = words_of(shell("pdftotext -bbox document.pdf -").out),
             whole = words_of(shell("pdftotext -bbox whole.pdf -").out);
  // "total" begins where its line ends, in both
  ASSERT_EQ(set.count("total"), 1u);
  ASSERT_EQ(whole.count("total"), 1u);
  const double shift = set.find("total")->second.left - whole.find("total")->second.left;
  int numbers = 0;
  for (const auto& [word, at] : set) {
    if (word.find_first_not_of("0123456789.") != std::string::npos) continue;
    double held = 1e300;
    for (auto [it, end] = whole.equal_range(word); it != end; ++it) {
      const Written& there = it->second;
      held = std::min({held, std::abs(at.left - there.left - shift), std::abs(at.right - there.right - shift),
                       std::abs((at.left + at.right - there.left - there.right) / 2 - shift)});
    }
    EXPECT_LT(held, 0.6) << word;
    ++numbers;
  }
  EXPECT_GT(numbers, 10);
}

/// As wide as the document says, with the words in their size.
TEST_F(LatexFigure, TakesTheWidthThatTheDocumentGives) {
  OBSCURA_NEEDS(installed("pdflatex"), "texlive-latex-base");
  ASSERT_EQ(obscura("figure scene.toml -o figures/a.tex").exit, 0);
  const auto across = [&](const std::string& before) {
    document("pdflatex", before);
    const auto words = words_of(shell("pdftotext -bbox document.pdf -").out);
    const auto name = words.find("total"), first = words.find("kinetic");
    EXPECT_NE(first, words.end());
    double least = 1e300;
    for (const auto& [word, at] : words) least = std::min(least, at.left);
    const double size = name->second.right - name->second.left;
    return std::pair(name->second.left - least, size);
  };
  const auto [own, size] = across("");
  const auto [twice, same] = across("\\newcommand\\obscurawidth{168mm}");
  EXPECT_NEAR(twice / own, 2, 0.05);
  EXPECT_NEAR(same, size, 1e-3);
}

}  // namespace
}  // namespace obscura::app
