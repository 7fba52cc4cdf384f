#include "draw/picture/type.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

namespace obscura::draw {
namespace {

double width(const std::string& words, bool tabular, Face face = Face::regular, double size = 24) {
  return shape({{0, 0}, Align::left, {{.text = words, .face = face, .size = size, .tabular = tabular}}})
      .width;
}

TEST(Type, TimeDoesNotDance) {
  // equal to the last bit: the same advances are added in the same order
  EXPECT_EQ(width("t = 1.11 s", true), width("t = 8.88 s", true));
  EXPECT_NE(width("t = 1.11 s", false), width("t = 8.88 s", false)) << "else this test shows nothing";
}

TEST(Type, FiguresOfMathematicsAreOfEqualWidth) {
  EXPECT_EQ(width("1111", false, Face::math), width("8888", false, Face::math));
}

TEST(Type, PairsAreKerned) { EXPECT_LT(width("AVAVAV", false), 6 * width("A", false)); }

TEST(Type, ScalesWithItsSize) {
  // unhinted: nothing but rounding in double
  EXPECT_NEAR(width("The room", false, Face::bold, 48), 2 * width("The room", false, Face::bold, 24), 1e-9);
}

// "proportional to" is in fonts of mathematics alone, a capital with a caron in those of words
TEST(Type, SignsThatAFontLacksAreTakenFromAnother) {
  const Text words{{0, 0}, Align::left, {{.text = "a ∝ b"}, {.text = "plain"}}};
  const Text all = with_all_signs(words);
  ASSERT_EQ(all.spans.size(), 4u);
  EXPECT_EQ(all.spans[1].text, "∝");
  EXPECT_EQ(all.spans[1].face, Face::math);
  EXPECT_EQ(all.spans[2].face, Face::regular);
  for (const Shaped& span : shape(all).spans)
    for (const Glyph& glyph : span.glyphs) EXPECT_NE(glyph.index, 0u) << "no such sign";
  List list;
  list.add(words);
  EXPECT_EQ(list.texts[0].spans.size(), 4u) << "in pictures";
}

TEST(Type, LettersThatNoFontHasAreKnown) {
  const auto known = [](const std::string& letter) {
    const std::vector<std::string> all = letters_without_glyph();
    return std::find(all.begin(), all.end(), letter) != all.end();
  };
  (void)shape({{0, 0}, Align::left, {{.text = "a\xF3\xB0\x80\x81 b"}}});  // of the private use area
  EXPECT_TRUE(known("\xF3\xB0\x80\x81"));
  EXPECT_FALSE(known("a"));
}

TEST(Type, NumbersHaveTheSceneDecimalMark) {
  EXPECT_EQ(with_decimal_mark("mass = 0.5, no. 2.", ","), "mass = 0,5, no. 2.");
  EXPECT_EQ(with_decimal_mark("mass = 0.5", "."), "mass = 0.5");
}

TEST(Type, EverySignOfOurFormulasHasAGlyph) {
  const std::vector<std::pair<Face, std::string>> needs{{Face::regular, "Aäß…−°²Δ"},
                                                        {Face::bold, "Aäß…"},
                                                        {Face::medium, "Aäß…"},
                                                        {Face::math, "0123456789+−×/=(),"},
                                                        {Face::math_italic, "tmvreωθμPI"},
                                                        {Face::math_bold_italic, "JrnvFω"}};
  for (const auto& [face, words] : needs) {
    const Line line = shape({{0, 0}, Align::left, {{.text = words, .face = face}}});
    for (const Shaped& span : line.spans) {
      for (const Glyph& glyph : span.glyphs) EXPECT_NE(glyph.index, 0u) << words;
    }
  }
}

TEST(Type, SpansFollowOneAnother) {
  const Span a{.text = "v", .face = Face::math_italic, .size = 30};
  const Span b{.text = "n", .face = Face::math_italic, .size = 20, .rise = -6, .lead = 1.5};
  const Line line = shape({{0, 0}, Align::left, {a, b}});
  const double first = width("v", false, Face::math_italic, 30);
  ASSERT_EQ(line.spans.size(), 2u);
  EXPECT_NEAR(line.spans[1].glyphs[0].at.x(), first + 1.5, 1e-12);
  EXPECT_NEAR(line.spans[1].glyphs[0].at.y(), 6, 1e-12) << "a subscript hangs below: y runs down";
  EXPECT_NEAR(line.width, first + 1.5 + width("n", false, Face::math_italic, 20), 1e-12);
}

TEST(Type, ThreadsShapeAlike) {
  const double alone = width("particles, springs, boxes", false);
  std::vector<double> found(8);
  {
    std::vector<std::jthread> threads;
    for (double& w : found) {
      threads.emplace_back([&w] {
        for (int i = 0; i < 200; ++i) w = width("particles, springs, boxes", false);
      });
    }
  }
  for (double w : found) EXPECT_EQ(w, alone);
}

}  // namespace
}  // namespace obscura::draw
