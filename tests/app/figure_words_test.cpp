// What a figure says: type that fits its place or is told, values as they are promised, and what is left out.

#include <algorithm>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "media/png.h"
#include "needs.h"
#include "page/page.h"
#include "program.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;
using testing::Not;

class FigureWords : public Program {
 protected:
  /// The text of an SVG, its marks left out.
  std::string drawn(const std::string& arguments) {
    told_ = obscura("figure scene.toml -o words.svg " + arguments).err;
    std::string svg = contents(path("words.svg"));
    if (const auto from = svg.find("<style>"), to = svg.find("</style>"); to != std::string::npos)
      svg.erase(from, to - from);
    return std::regex_replace(svg, std::regex("<[^>]*>|\n"), "");
  }
  std::set<double> sizes(const std::string& arguments) {
    drawn(arguments);
    const std::string svg = contents(path("words.svg"));
    std::set<double> all;
    static const std::regex size(" font-size=\"([0-9.]+)\"");
    for (std::sregex_iterator it(svg.begin(), svg.end(), size), end; it != end; ++it)
      all.insert(std::stod((*it)[1]));
    return all;
  }
  std::string told_;  // beside the picture
};

const char* const kTwoPanels = R"(
duration = 1
[room]
size = [4, 3]
corner = [-2, -1]
[[ball]]
name = "ball"
radius = 0.2
position = [0.5, 0.5]
[figure]
at = [0, 0.4]
low = [-0.5, -0.5]
high = [1, 1.5]
axes = true
scale_bar = true
formula = "E = m g h"
[[figure.point]]
at = [3.5, 0.5]
label = "outside"
[[figure.label]]
at = [0.2, 9]
text = '"far above"'
panel = "b"
[[figure.point]]
at = [0.2, 0.2]
label = "Q"
)";

TEST_F(FigureWords, OutsideOfAPanelAreLeftOutAndToldOnce) {
  scene(kTwoPanels);
  const std::string words = drawn("");
  EXPECT_THAT(words, HasSubstr("Q"));
  EXPECT_THAT(words, Not(HasSubstr("outside")));
  EXPECT_THAT(told_, HasSubstr("the point 'outside'"));
  EXPECT_THAT(told_, HasSubstr("the label 'far above' of panel b"));
  EXPECT_EQ(std::count(told_.begin(), told_.end(), '\n'), 1) << told_;
}

TEST_F(FigureWords, OfALongPanelTitleAreSmallerOrTold) {
  const auto smallest = [&](const std::string& title) {
    std::string text = kTwoPanels;
    text.insert(text.find("at = [0, 0.4]"), "titles = '\"" + title + "\"; \"after\"'\n");
    scene(text);
    return *sizes("").begin();
  };
  const double usual = smallest("before");
  const double longer = smallest("before and a longer title here");
  EXPECT_LT(longer, usual);
  EXPECT_THAT(told_, Not(HasSubstr("title")));
  smallest("before and a very long title that has no room whatever is done here at all");
  EXPECT_THAT(told_, HasSubstr("the title of panel (a) is "));
}

TEST_F(FigureWords, OfAFormulaWiderThanThePageAreTold) {
  scene(kTwoPanels);
  drawn("--width 60mm");
  EXPECT_THAT(told_, Not(HasSubstr("formula")));
  drawn("--width 60mm --set 'figure.formula=\"E = m g h + m g h + m g h + m g h + m g h + m g h + m g h\"'");
  EXPECT_THAT(told_, HasSubstr("the formula is "));
}

// all type is of the em of words, of rulers and the legend, of letters, and of the formula
TEST_F(FigureWords, AreAsMuchLargerAsTheScaleOfTypeSays) {
  scene(kTwoPanels);
  const std::set<double> usual = sizes("--width 160mm"),
                         large = sizes("--width 160mm --set look.type_scale=1.5");
  ASSERT_EQ(usual.size(), large.size());
  for (auto a = usual.begin(), b = large.begin(); a != usual.end(); ++a, ++b) EXPECT_NEAR(*b, 1.5 * *a, 0.02);
}

TEST_F(FigureWords, SayABodysAngleAsItHasTurned) {
  for (const auto& [angle, said] :
       {std::pair("216", "216°"), std::pair("-30", "−30°"), std::pair("400", "400°")}) {
    scene(std::string(R"(
duration = 1
[room]
size = [4, 2]
[[box]]
name = "wheel"
size = [0.4, 0.4]
position = [2, 1]
angle = )") +
          angle + R"(
[figure]
at = 0
[[figure.angle]]
of = "wheel"
label = "{}"
)");
    EXPECT_THAT(drawn(""), HasSubstr(said));
  }
}

const char* const kElasticities = R"(
duration = 1
[room]
size = [4, 2]
[[ball]]
name = "ball"
radius = 0.2
position = [1, 1.5]
velocity = [1, 0]
[figure]
at = 1
room = false
[[figure.plot]]
quantity = ["vy"]
of = "ball"
)";

TEST_F(FigureWords, TellWhatALogarithmicPlotLeavesOut) {
  scene(std::string(kElasticities) + "over = \"ball.elasticity=0,1\"\nscale = \"log\"\n");
  const std::string words = drawn("");
  EXPECT_THAT(told_, HasSubstr("leaves out "));
  EXPECT_THAT(words, Not(HasSubstr("slope")));  // of one point there is none
}

// The last number, 1.0005, stands out by half of itself.
TEST_F(FigureWords, OfAnAxisStayOnThePage) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf) && installed("pdftotext"), "libcairo2-dev, poppler-utils");
  scene(std::string(kElasticities) + "from = 0.999\nto = 1.0005\n");
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
  const std::string page = shell("pdftotext -bbox a.pdf -").out;
  static const std::regex word("xMin=\"[-0-9.]+\" yMin=\"[-0-9.]+\" xMax=\"([-0-9.]+)\"");
  int count = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), word), end; it != end; ++it, ++count)
    EXPECT_LE(std::stod((*it)[1]), 84 * 72 / 25.4);
  EXPECT_GT(count, 4);
}

TEST_F(FigureWords, ThatTheFontLacksAreBoxesInAPdfToo) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf) && installed("pdftotext"), "libcairo2-dev, poppler-utils");
  scene(R"(
duration = 1
[room]
size = [4, 2]
[figure]
at = 0
[[figure.label]]
at = [2, 1]
text = '"A日本B"'
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
  EXPECT_THAT(shell("pdftotext a.pdf -").out, HasSubstr("A□□B"));
}

}  // namespace
}  // namespace obscura::app
