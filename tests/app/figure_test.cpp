// Figures: the same picture as vectors and as pixels, type that stays type, arrows that end where the world
// says.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <set>

#include <gmock/gmock.h>

#include "app/run/plots.h"
#include "app/run/variation.h"
#include "media/png.h"
#include "needs.h"
#include "page/page.h"
#include "program.h"
#include "scene/scene.h"
#include "where.h"

namespace obscura::app {
namespace {

using testing::HasSubstr;

using Figure = Program;

// what is written in an SVG, without its marks
std::string written(std::string svg) {
  if (const auto from = svg.find("<style>"), to = svg.find("</style>"); to != std::string::npos)
    svg.erase(from, to - from);
  std::string words;
  bool mark = false;
  for (const char c : svg) {
    if (c == '<') mark = true;
    if (!mark && c != '\n') words += c;
    if (c == '>') mark = false;
  }
  return words;
}

// names of the fonts that an SVG is set in
std::set<std::string> families(const std::string& svg) {
  const std::string key = "font-family=\"";
  std::set<std::string> names;
  for (auto at = svg.find(key); at != svg.npos; at = svg.find(key, at + 1)) {
    const auto from = at + key.size();
    names.insert(svg.substr(from, svg.find('"', from) - from));
  }
  return names;
}

const char* const kMarked = R"(
duration = 2
[room]
size = [4, 2.5]
[[box]]
name = "crate"
size = [0.9, 0.5]
position = [1.2, 1.5]
velocity = [1.5, 0.5]
spin = 60
[[spring]]
between = ["crate", [3, 2.4]]
[look]
trails = 0.5
[figure]
at = 0.4
scale_bar = true
formula = "*J* = J *n*"
[[figure.vector]]
quantity = "velocity"
of = "crate"
label = "v_center"
[[figure.point]]
at = { body = "crate", at = "top right" }
label = "P'"
[[figure.label]]
at = [0.8, 0.5]
text = "e = 0.8"
)";

// what is not ground, as part of what either has
double overlap(const media::Image& a, const media::Image& b) {
  const auto inked = [](const media::Image& image, int x, int y) {
    if (x >= image.width || y >= image.height) return false;
    const std::uint8_t* p = image.row(y) + 4 * x;
    return std::min({p[0], p[1], p[2]}) < 235;
  };
  double both = 0, any = 0;
  for (int y = 0; y < std::max(a.height, b.height); ++y) {
    for (int x = 0; x < std::max(a.width, b.width); ++x) {
      const bool of_a = inked(a, x, y), of_b = inked(b, x, y);
      both += of_a && of_b, any += of_a || of_b;
    }
  }
  return any > 0 ? both / any : 0;
}

/// Figures as PDF, and poppler to look at them.
class FigurePdf : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    OBSCURA_NEEDS(page::writes(page::Form::pdf), "libcairo2-dev, where it is built");
    OBSCURA_NEEDS(installed("pdfinfo"), "poppler-utils");
    scene(kMarked);
  }
};

// The issue's bound; edges, of letters above all, are what two rasterisers see differently (measured: 0.996).
constexpr double kSamePicture = 0.995;

TEST_F(Figure, AsSvgIsTheSamePictureAsItsPixels) {
  OBSCURA_NEEDS(installed("rsvg-convert"), "librsvg2-bin");
  scene(kMarked);
  ASSERT_EQ(obscura("figure scene.toml -o a.png --dpi 600").exit, 0);
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  ASSERT_EQ(shell("rsvg-convert -d 600 -p 600 a.svg -o svg.png").exit, 0);
  EXPECT_GT(overlap(media::read_png(path("a.png")).image, media::read_png(path("svg.png")).image),
            kSamePicture);
}

TEST_F(FigurePdf, IsTheSamePictureAsItsPixels) {
  ASSERT_EQ(obscura("figure scene.toml -o a.png --dpi 600").exit, 0);
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
  // not pdftoppm: its fills take every pixel that they touch, which widens a hatching line by a tenth (0.972)
  ASSERT_EQ(shell("pdftocairo -singlefile -r 600 -png a.pdf pdf").exit, 0);
  EXPECT_GT(overlap(media::read_png(path("a.png")).image, media::read_png(path("pdf.png")).image),
            kSamePicture);
}

TEST_F(Figure, TypeStaysType) {
  scene(kMarked);
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  for (const char* words : {">center<", ">P<", ">e<", "@font-face"}) EXPECT_THAT(svg, HasSubstr(words));
}

TEST_F(FigurePdf, TypeStaysType) {
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
  // how wide a space is, in mathematics, is its own matter
  const std::string text = shell("pdftotext a.pdf - | sed 's/J = /J=/'").out;
  for (const char* words : {"center", "P′", "e = 0.8", "J=Jn", "m/s"})
    EXPECT_THAT(text, HasSubstr(words)) << text;
}

TEST_F(Figure, ThePageIsAsLargeAsTheFigure) {
  scene(kMarked);
  ASSERT_EQ(obscura("figure scene.toml -o a.svg --width 120mm").exit, 0);
  EXPECT_THAT(contents(path("a.svg")), HasSubstr("width=\"120mm\""));
}

TEST_F(FigurePdf, ThePageIsAsLargeAsTheFigure) {
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf --width 240pt").exit, 0);
  EXPECT_THAT(shell("pdfinfo a.pdf").out, testing::ContainsRegex("Page size: +240 x [0-9.]+ pts"));
}

TEST_F(Figure, TypeAndLinesKeepTheirSizeWhateverTheWidth) {
  scene(kMarked);
  const auto sizes = [&](const std::string& width) {
    EXPECT_EQ(obscura("figure scene.toml -o a.svg --width " + width).exit, 0);
    const std::string svg = contents(path("a.svg"));
    std::set<std::string> found;
    static const std::regex size(" font-size=\"([0-9.]+)\"");
    for (std::sregex_iterator it(svg.begin(), svg.end(), size), end; it != end; ++it) found.insert((*it)[1]);
    EXPECT_THAT(svg, HasSubstr("stroke-width=\"0.9\""));  // outlines, pt
    return found;
  };
  EXPECT_EQ(sizes("60mm"), sizes("170mm"));
}

// Without walls the margin is 2 pt, and 84 mm are 238.11 pt: a place (x, y) of what is shown from `low` to
// `high` lies at 2 + (x - low) s, s = (238.11 - 4) / (high - low).
TEST_F(Figure, ArrowTipsAreWhereTheProjectionSays) {
  scene(R"(
duration = 1
[room]
size = [4, 3]
walls = "none"
[[particle]]
name = "ball"
position = [2.5, 1.75]
[figure]
at = 0
low = [0.5, 0.5]
high = [3.5, 2.5]
[[figure.vector]]
at = [1, 0.75]
of = "ball"
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  const double s = (84 * 72 / 25.4 - 4) / 3, x = 2 + 2 * s, y = 2 + 0.75 * s;
  static const std::regex head("d=\"M([0-9.]+) ([0-9.]+)L[^Z\"]*Z\"");
  double nearest = 1e9;
  for (std::sregex_iterator it(svg.begin(), svg.end(), head), end; it != end; ++it)
    nearest = std::min(nearest, std::hypot(std::stod((*it)[1]) - x, std::stod((*it)[2]) - y));
  EXPECT_LT(nearest, 0.05);  // pt, as the issue asks
}

TEST_F(Figure, APngSaysItsDensity) {
  scene(kMarked);
  ASSERT_EQ(obscura("figure scene.toml -o a.png --dpi 300").exit, 0);
  // 300 / 0.0254 = 11811 pixels a metre, both ways, unit 1
  EXPECT_THAT(contents(path("a.png")), HasSubstr(std::string("pHYs\0\0\x2e\x23\0\0\x2e\x23\x01", 13)));
  EXPECT_EQ(media::read_png(path("a.png")).image.width, 993);  // 84 mm are 992.1
}

TEST_F(Figure, TheSameFigureIsTheSameBytes) {
  scene(kMarked);
  for (const std::string end : {"svg", "pdf", "png"}) {
    if (end == "pdf" && !page::writes(page::Form::pdf)) continue;
    ASSERT_EQ(obscura("figure scene.toml -o a." + end).exit, 0);
    ASSERT_EQ(obscura("figure scene.toml -o b." + end).exit, 0);
    EXPECT_EQ(contents(path("a." + end)), contents(path("b." + end))) << end;
  }
}

TEST_F(Figure, SeveralInstantsAndValuesArePanelsWithLetters) {
  scene(kMarked);
  ASSERT_EQ(obscura("figure scene.toml -o a.svg --at 0,0.2 --vary crate.elasticity=0,1 --columns 2").exit, 0);
  const std::string svg = contents(path("a.svg"));
  for (const char* words : {"(a)", "(d)", "e = 0, t = 0.2 s", "e = 1, t = 0 s"})
    EXPECT_THAT(written(svg), HasSubstr(words));
}

/// "before" and "after" have marks of their own.
TEST_F(Figure, PanelsHaveTitlesAndMarksOfTheirOwn) {
  scene(R"(
duration = 1
[room]
size = [4, 2]
[[ball]]
name = "ball"
radius = 0.1
position = [1, 1]
velocity = [1, 0]
[figure]
at = [0.2, 0.9]
every = 0.3
times_of = "ball"
titles = '"before"; "after" t_0'
[[figure.vector]]
quantity = "velocity"
of = "ball"
label = 'v_{in}'
panel = "a"
[[figure.vector]]
quantity = "velocity"
of = "ball"
label = 'v_{out}'
panel = "b"
[[figure.point]]
at = [3, 1.5]
label = "Q"
)");
  const auto words = [&](const std::string& sets) {
    const Outcome drawn = obscura("figure scene.toml -o a.svg " + sets);
    EXPECT_EQ(drawn.exit, 0) << drawn.err;
    return written(contents(path("a.svg")));
  };
  const auto count = [](const std::string& text, const std::string& word) {
    int n = 0;
    for (auto at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++n;
    return n;
  };
  const std::string text = words("");
  for (const char* each : {"before", "after t0"}) EXPECT_THAT(text, HasSubstr(each));
  EXPECT_THAT(text, testing::Not(HasSubstr("t = 0.2")));
  EXPECT_EQ(count(text, "vin"), 1);
  EXPECT_EQ(count(text, "vout"), 1);
  EXPECT_EQ(count(text, "Q"), 2);
  // exposures of 0, and of 0, 0.3 and 0.6 s
  EXPECT_EQ(count(text, "0 s"), 2);
  EXPECT_EQ(count(text, "0.3 s"), 1);
  EXPECT_EQ(count(text, "0.6 s"), 1);
}

/// No letter and no arrow of a figure reaches beyond its page, but the ends of what is clipped there.
TEST_F(Figure, WordsStayOnThePage) {
  namespace fs = std::filesystem;
  int words = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(OBSCURA_SOURCE_DIR) / "scenes/figures")) {
    OBSCURA_NEEDS(page::writes(page::Form::pdf) && installed("pdftotext"), "libcairo2-dev, poppler-utils");
    ASSERT_EQ(obscura("figure '" + entry.path().string() + "' -o a.pdf --dpi 40").exit, 0) << entry.path();
    const std::string page = shell("pdftotext -bbox a.pdf -").out;
    static const std::regex size("<page width=\"([0-9.]+)\" height=\"([0-9.]+)\">"),
        word(
            "<word xMin=\"([-0-9.]+)\" yMin=\"([-0-9.]+)\" xMax=\"([-0-9.]+)\" yMax=\"([-0-9.]+)\">([^<]*)<");
    std::smatch whole;
    ASSERT_TRUE(std::regex_search(page, whole, size)) << entry.path();
    const double width = std::stod(whole[1]), height = std::stod(whole[2]);
    for (std::sregex_iterator it(page.begin(), page.end(), word), end; it != end; ++it, ++words) {
      // a box is as high as the font's tallest letter
      EXPECT_GE(std::stod((*it)[1]), 0) << entry.path() << ": " << (*it)[5];
      EXPECT_LE(std::stod((*it)[3]), width) << entry.path() << ": " << (*it)[5];
      const double middle = (std::stod((*it)[2]) + std::stod((*it)[4])) / 2;
      EXPECT_GT(middle, 2) << entry.path() << ": " << (*it)[5];
      EXPECT_LT(middle, height - 2) << entry.path() << ": " << (*it)[5];
    }
  }
  EXPECT_GT(words, 200);
}

/// In a corner the words of an arrow are on the page, whichever way it goes: seen from the picture's pixels
/// they are those of the arrow's colour left of it and below.
TEST_F(Figure, WordsOfAnArrowInACornerAreOnThePage) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf) && installed("pdftotext"), "libcairo2-dev, poppler-utils");
  for (const auto& [place, velocity] :
       {std::pair("[3.8, 2.8]", "[2, 2]"), std::pair("[0.2, 0.2]", "[-2, -2]"),
        std::pair("[0.2, 2.8]", "[-2, 2]"), std::pair("[3.8, 0.2]", "[2, -2]")}) {
    scene(fmt::format(R"(
duration = 1
[room]
size = [4, 3]
[[ball]]
name = "d"
position = {}
velocity = {}
[figure]
at = 0
[[figure.vector]]
quantity = "velocity"
of = "d"
label = "speed = {{}}"
)",
                      place, velocity));
    ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
    const std::string page = shell("pdftotext -bbox a.pdf -").out;
    static const std::regex word("xMin=\"([-0-9.]+)\" yMin=\"([-0-9.]+)\" xMax=\"([-0-9.]+)\"[^>]*>2.83<");
    std::smatch its;
    ASSERT_TRUE(std::regex_search(page, its, word)) << page;
    EXPECT_GE(std::stod(its[1]), 0);
    EXPECT_GE(std::stod(its[2]), 0);
    EXPECT_LE(std::stod(its[3]), 84 * 72 / 25.4);
  }
}

/// Kinds of arrows that find no room beside the scale go on in another line.
TEST_F(Figure, ALegendTakesLines) {
  OBSCURA_NEEDS(page::writes(page::Form::pdf) && installed("pdftotext"), "libcairo2-dev, poppler-utils");
  std::string text = R"(
duration = 1
[room]
size = [4, 3]
[[ball]]
name = "d"
position = [1, 2]
velocity = [2, 0]
[figure]
at = 0.3
scale_bar = true
)";
  for (const char* each : {"velocity", "acceleration", "momentum", "weight"})
    text += fmt::format("[[figure.vector]]\nquantity = \"{}\"\nof = \"d\"\n", each);
  scene(text);
  ASSERT_EQ(obscura("figure scene.toml -o a.pdf").exit, 0);
  const std::string page = shell("pdftotext -bbox a.pdf -").out;
  static const std::regex word(
      "xMin=\"([-0-9.]+)\" yMin=\"([-0-9.]+)\" xMax=\"([-0-9.]+)\" yMax=\"([-0-9.]+)\">");
  std::vector<std::array<double, 4>> all;
  for (std::sregex_iterator it(page.begin(), page.end(), word), end; it != end; ++it)
    all.push_back({std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4])});
  EXPECT_GE(all.size(), 9u) << page;  // "1 m", four values with their units
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_GE(all[i][0], 0);
    for (std::size_t j = 0; j < i; ++j) {
      const double wide = std::min(all[i][2], all[j][2]) - std::max(all[i][0], all[j][0]),
                   high = std::min(all[i][3], all[j][3]) - std::max(all[i][1], all[j][1]);
      EXPECT_FALSE(wide > 0.5 && high > 4) << i << " " << j << "\n" << page;
    }
  }
}

TEST(Variation, NumbersOfManyDigitsAreRoundedWhereTheyAreShown) {
  const Variation over("ball.elasticity=0:1:0.0666666666666666");
  EXPECT_EQ(over.words(over.values[3]), "elasticity = 0.2");
  for (const char* same : {"0.1", "1/3", "12345.678", "euler", "[1, 2, 3, 4, 5]"})
    EXPECT_EQ(Variation::shown(same), same);
}

/// The bodies' own arrows and those that have names are of one scale.
TEST_F(Figure, AllArrowsHaveOneScale) {
  scene(R"(
duration = 1
[room]
size = [4, 3]
gravity = [0, 0]
[[ball]]
name = "a"
position = [1, 1]
velocity = [2, 0]
[[ball]]
name = "b"
position = [1, 2]
velocity = [2, 0]
[look]
arrows = ["velocity"]
[figure]
at = 0
[[figure.vector]]
quantity = "velocity"
of = "b"
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  // the tips of the heads: both own arrows', and that which has a name
  static const std::regex head("d=\"M([0-9.]+) ([0-9.]+)L[^\"]*Z\" fill=\"#(009e73|087f60)\"");
  std::vector<std::string> tips;
  for (std::sregex_iterator it(svg.begin(), svg.end(), head), end; it != end; ++it)
    if (std::stod((*it)[2]) < 180) tips.push_back((*it)[1]);
  ASSERT_EQ(tips.size(), 3u);
  EXPECT_EQ(std::set<std::string>(tips.begin(), tips.end()).size(), 1u);
}

/// The white around an arrow ends where it leaves the ball: on the spring that it runs along it would be a
/// gap. Without walls the margin is 2 pt and 84 mm are 238.11 pt, so that a metre is 234.11 / 3 pt.
TEST_F(Figure, AnArrowAlongASpringLeavesItsCoilsWhole) {
  scene(R"(
duration = 1
[room]
size = [4, 3]
walls = "none"
gravity = [0, 0]
[[ball]]
name = "ball"
radius = 0.2
position = [3, 1.5]
[[spring]]
between = [[1, 1.5], "ball"]
stiffness = 10
rest_length = 1.2
[figure]
at = 0
low = [0.5, 0.5]
high = [3.5, 2.5]
[[figure.vector]]
quantity = "spring"
of = "ball"
label = "f"
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  static const std::regex halo(
      "d=\"M([0-9.]+) [0-9.]+L([0-9.]+) [0-9.]+\" fill=\"none\" stroke-width=\"([0-9.]+)\" "
      "stroke=\"#ffffff\"");
  int found = 0;
  for (std::sregex_iterator it(svg.begin(), svg.end(), halo), end; it != end; ++it) {
    const double length = std::stod((*it)[1]) - std::stod((*it)[2]);
    if (length < 0) continue;  // the legend's
    // looked for in 64 steps of an arrow that is no longer than a third of the height, 160 pt
    EXPECT_NEAR(length, 0.2 * 234.11 / 3, 160.0 / 3 / 64);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

/// By its family's name, whatever its files are called; mathematics too where the font has it.
TEST_F(Figure, FontsAreFoundByTheirFamily) {
  OBSCURA_NEEDS(installed("fc-list"), "fontconfig");
  scene(kMarked);
  const std::string known = shell("fc-list : family").out;
  const auto drawn_in = [&](const std::string& family) {
    const Outcome drawn = obscura("figure scene.toml -o a.svg --font '" + family + "'");
    EXPECT_EQ(drawn.exit, 0) << drawn.err;
    return families(contents(path("a.svg")));
  };
  // in the file STIXMath-Regular.otf
  if (known.find("STIX Math\n") == known.npos) GTEST_SKIP() << "needs fonts-stix with STIX Math";
  EXPECT_EQ(drawn_in("STIX Math"), std::set<std::string>{"STIX Math"});
  EXPECT_EQ(drawn_in("stix math"), std::set<std::string>{"STIX Math"});
  // letters of mathematics are characters of their own there
  EXPECT_THAT(contents(path("a.svg")), HasSubstr("\U0001D497"));  // bold italic v
}

TEST_F(Figure, ErrorsAreOneClearLine) {
  scene(kMarked);
  const auto fails = [&](const std::string& arguments, int exit, const std::string& words) {
    const Outcome outcome = obscura("figure " + arguments);
    EXPECT_EQ(outcome.exit, exit) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(words));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  fails("scene.toml -o a.jpg", 2, "ends with .svg, .pdf, .png or .tex");
  fails("scene.toml -o a.svg --width 3", 2, "--width 3: expected 20mm to 1000mm");
  fails("scene.toml -o a.svg --vary crate", 2, "expected PATH=VALUES");
  fails("scene.toml -o a.svg --font NoSuchFamily", 4, "cannot find the font family 'NoSuchFamily'");
  fails("scene.toml -o a.svg --at 0:10:0.01", 2, "1001 panels are more than 100");
  fails("scene.toml -o a.svg --every 0.0001", 2, "4000 exposures are more than 2000");
  fails("scene.toml -o a.svg --set figure.room=false", 3, "a figure without its picture needs a plot");
  scene("[[box]]\n[[figure.vector]]\nquantity = \"velocity\"\n", "none.toml");
  fails("none.toml -o a.svg", 3, "this vector needs 'of', the body that has it");
}

// what two numbers in a drawing's words come to: "slope -3.98"
std::vector<double> numbers_after(const std::string& words, const std::string& svg) {
  std::vector<double> found;
  for (auto at = svg.find(words); at != svg.npos; at = svg.find(words, at + 1)) {
    std::string number = svg.substr(at + words.size(), 12);
    const std::string minus = "\u2212";
    if (const auto sign = number.find(minus); sign != number.npos) number.replace(sign, minus.size(), "-");
    found.push_back(std::strtod(number.c_str(), nullptr));
  }
  return found;
}

// the handout's scene of orders: the exponents that the plot's lines say
TEST_F(Figure, LogarithmicPlotsSayTheirSlopes) {
  const std::string scene = OBSCURA_SOURCE_DIR "/scenes/figures/order.toml";
  ASSERT_EQ(obscura("figure '" + scene + "' -o a.svg").exit, 0);
  std::vector<double> slopes = numbers_after("slope ", contents(path("a.svg")));
  ASSERT_EQ(slopes.size(), 4u);
  std::sort(slopes.begin(), slopes.end());
  // from 20 steps a second on; the first-order schemes are not yet in their asymptote there (measured: 1.13)
  EXPECT_NEAR(slopes[0], -4, 0.1);
  EXPECT_NEAR(slopes[1], -2, 0.1);
  EXPECT_NEAR(slopes[2], -1, 0.25);
  EXPECT_NEAR(slopes[3], -1, 0.25);
}

// parts of a step of the handout's collisions would show a motion that the run has not
TEST_F(Figure, PlotsOfTheHandoutsCollisionsGoFromStepToStep) {
  const scene::Scene scene = scene::parse(
      "duration = 2\n[room]\nsize = [3, 1.5]\n[physics]\ncollision = \"handout\"\n[[box]]\nname = \"crate\"\n"
      "size = [0.8, 0.4]\nposition = [1.5, 0.6]\nangle = 12\nelasticity = 0.4\nfriction = 0\n"
      "[[figure.plot]]\nquantity = [\"spin\"]\nof = \"crate\"\nfrom = 1\nto = 1.1\n",
      "ants.toml");
  const std::vector<double> times = plots(scene, {})[0].times;
  ASSERT_EQ(times.size(), 61u);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], 1 + double(k) / 600, 1e-12);
  // more steps than points: some of the steps
  const std::vector<double> many = plots(scene.again({"figure.plot[0].to=1.9"}), {})[0].times;
  EXPECT_GT(many.size(), 200u);
  for (const double t : many) EXPECT_NEAR(t * 600, std::round(t * 600), 1e-8);
}

TEST_F(Figure, PlotsGoAgainstOtherQuantities) {
  const std::string scene = OBSCURA_SOURCE_DIR "/scenes/figures/spring_law.toml";
  ASSERT_EQ(obscura("figure '" + scene + "' -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  // each panel's letter once above it and once on the line
  for (const std::string letter : {"a", "b", "c"}) {
    const auto first = svg.find(">(" + letter + ")<");
    ASSERT_NE(first, svg.npos);
    EXPECT_NE(svg.find(">(" + letter + ")<", first + 1), svg.npos) << letter;
  }
}

TEST_F(Figure, AConeIsAsWideAsFrictionSays) {
  scene(R"(
duration = 1
[room]
friction = 0.2
[[box]]
name = "block"
position = [4, 0.25]
friction = 0.45
[figure]
at = 0.1
axes = true
[[figure.cone]]
of = "block"
label = "half = {}"
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.svg").exit, 0);
  const std::string svg = contents(path("a.svg"));
  EXPECT_THAT(svg, HasSubstr("16.7"));  // degrees: arctan of the root of 0.2 times 0.45
  for (const char* words : {">x<", ">y<"}) EXPECT_THAT(svg, HasSubstr(words));  // the rulers
}

// In space the friction cone is round: its outline as it is seen, its rim, its angle, from every side.
TEST_F(Figure, SpaceHasFrictionCones) {
  const std::string text = R"(
duration = 1
[room]
size = [6, 4, 4]
walls = [{ point = [0, 2, 0], normal = [0.34202014332566873, 0.9396926207859084, 0] }]
[physics]
solver = "direct"
[[box]]
name = "block"
size = [1, 0.6, 0.8]
position = [-0.39739395, 2.46389594, 0]
orientation = { axis = [0, 0, 1], angle = -20 }
friction = 0.7
[film]
size = [320, 180]
[figure]
at = 0.5
)";
  for (const char* view : {"side", "slant", "top"}) {
    const std::string seen = text + "[[camera]]\nview = \"" + view + "\"\n";
    scene(seen);
    ASSERT_EQ(obscura("figure scene.toml -o bare.svg").exit, 0);
    scene(seen + "[[figure.cone]]\nof = \"block\"\nlabel = \"half = {:.2}\"\n");
    ASSERT_EQ(obscura("figure scene.toml -o cone.svg").exit, 0) << view;
    const std::string bare = contents(path("bare.svg")), cone = contents(path("cone.svg"));
    EXPECT_THAT(cone, HasSubstr("34.99")) << view;                               // degrees: arctan of 0.7
    for (const char* fill : {"fill-opacity=\"0.157\"", "stroke=\"#666f78\""}) {  // the hull, the rim
      EXPECT_THAT(cone, HasSubstr(fill)) << view;
      EXPECT_EQ(bare.find(fill), std::string::npos) << view;
    }
  }
}

TEST_F(Figure, SpaceHasAPanelForEachCameraAndInstant) {
  scene(R"(
duration = 1
[room]
size = [6, 3, 6]
walls = "ground"
[[ball]]
name = "ball"
radius = 0.1
position = [1, 2, 2]
[[explosion]]
strength = 18
[[camera]]
view = "side"
[[camera]]
view = "slant"
[film]
size = [320, 180]
[figure]
at = [0, 0.1]
columns = 2
axes = true
[[figure.vector]]
quantity = "blast"
of = "ball"
label = "F = {}"
)");
  ASSERT_EQ(obscura("figure scene.toml -o a.svg --dpi 60").exit, 0);
  const std::string svg = contents(path("a.svg"));
  for (const char* words : {"(a)", "(d)", "side, t = 0.1 s", "slant, t = 0 s", "= 2 "})  // S / r^2 = 18 / 9
    EXPECT_THAT(written(svg), HasSubstr(words));
  ASSERT_EQ(obscura("figure scene.toml -o a.png --dpi 60 --width 120mm").exit, 0);
  EXPECT_EQ(media::read_png(path("a.png")).image.width, 284);  // 283.5
}

// 3 rad/s about an axis through the eye's right: the arc's tip and the arrow's length by one scale are the
// legend's
TEST_F(Figure, InSpaceWhatTurnsHasAnArcAndArrowsHaveOneScale) {
  scene(R"(
duration = 1
[room]
size = [4, 3, 4]
walls = "ground"
gravity = [0, 0, 0]
[[box]]
name = "crate"
size = [0.6, 0.4, 0.5]
position = [0, 1.5, 0]
spin = [0, 171.887338539, 0]
velocity = [2, 0, 0]
[[camera]]
view = "side"
projection = "orthographic"
[film]
size = [320, 240]
[figure]
at = 0
[[figure.vector]]
quantity = "spin"
of = "crate"
label = "\\omega = {}"
[[figure.vector]]
quantity = "velocity"
of = "crate"
)");
  const Outcome drawn = obscura("figure scene.toml -o a.svg --dpi 60");
  ASSERT_EQ(drawn.exit, 0) << drawn.err;
  const std::string svg = contents(path("a.svg"));
  EXPECT_THAT(svg, HasSubstr("= 3 rad/s<"));
  EXPECT_THAT(svg, HasSubstr(" m/s<"));  // the legend's
}

TEST_F(Figure, TheHandoutIsAPdfWithItsFiguresAndItsType) {
  OBSCURA_NEEDS(installed("pandoc"), "pandoc");
  OBSCURA_NEEDS(installed("chromium-headless-shell") || installed("chromium"), "chromium-headless-shell");
  OBSCURA_NEEDS(installed("pdftotext"), "poppler-utils");
  const Outcome made = shell(OBSCURA_SOURCE_DIR "/script/handout handout.pdf");
  ASSERT_EQ(made.exit, 0) << made.err;
  const std::string text = shell("pdftotext handout.pdf -").out;
  // of the words, of a figure in the plane and of one with pixels under its lines
  for (const char* words : {"friction", "arctan", "swivel"}) EXPECT_THAT(text, HasSubstr(words));
}

// fonts are of this system's version, and pixels of its OpenGL
std::string without_fonts(std::string svg) {
  if (const auto from = svg.find("<style>"), to = svg.find("</style>"); to != svg.npos)
    svg.erase(from, to - from);
  const std::string raster = "data:image/png;base64,";
  if (const auto from = svg.find(raster); from != svg.npos) svg.erase(from, svg.find('"', from) - from);
  return svg;
}

// script/figures makes them anew
TEST_F(Figure, NoFigureOfTheHandoutIsStale) {
  namespace fs = std::filesystem;
  const std::string page = contents(OBSCURA_SOURCE_DIR "/docs/handout/README.md");
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(OBSCURA_SOURCE_DIR) / "scenes/figures")) {
    if (entry.path().extension() != ".toml") continue;
    const fs::path drawn = fs::path(OBSCURA_SOURCE_DIR) / "docs/handout" / entry.path().stem().concat(".svg");
    ASSERT_EQ(obscura("figure '" + entry.path().string() + "' -o a.svg").exit, 0) << entry.path();
    if (families(contents(path("a.svg"))) != families(contents(drawn.string())))
      GTEST_SKIP() << "this system has other fonts than those of docs/handout";
    EXPECT_TRUE(without_fonts(contents(path("a.svg"))) == without_fonts(contents(drawn.string())))
        << drawn << " is not what its scene draws today; script/figures makes it anew";
    EXPECT_THAT(page, HasSubstr("](" + drawn.filename().string() + ")"));
    ++count;
  }
  EXPECT_GE(count, 15);
}

// 500 periods of 0.2 s, each shorter than a 480th of the run
TEST_F(Figure, AFastOscillationIsABandAndNoSlowOne) {
  scene(R"(
duration = 100
[room]
size = [4, 3]
gravity = [0, 0]
[[particle]]
name = "b"
position = [2.5, 1.5]
mass = 1
[[spring]]
between = [[1, 1.5], "b"]
rest_length = 1
stiffness = 986.96044
[figure]
room = false
[[figure.plot]]
quantity = ["x"]
of = "b"
)");
  ASSERT_EQ(obscura("figure scene.toml -o band.png").exit, 0);
  const media::Image image = media::read_png(path("band.png")).image;
  // in each column right of the axis, within what the line spans, most of the rows have its ink
  int full = 0, columns = 0;
  for (int x = image.width / 4; x < image.width * 3 / 4; ++x, ++columns) {
    int inked = 0;
    for (int y = 0; y < image.height; ++y)
      inked += image.pixels[std::size_t(4 * (y * image.width + x))] < 200;
    full += inked > image.height / 2;
  }
  EXPECT_GT(full, 0.9 * columns);
}

}  // namespace
}  // namespace obscura::app
