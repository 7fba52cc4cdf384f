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
