#include "draw/picture/color.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "color_vision.h"
#include "draw/picture/theme.h"

namespace obscura::draw {
namespace {

Rgb linear(Color c) { return linear_rgb(c.r, c.g, c.b); }

constexpr std::array<const char*, 7> kNames{"orange",    "sky",    "green", "blue",
                                            "vermilion", "purple", "yellow"};

TEST(Color, PaletteIsToldApartWithoutColourVision) {
  const std::array<std::pair<Eye, double>, 4> eyes{
      {{kNormalEye, 20}, {kProtanEye, 10}, {kDeutanEye, 10}, {kTritanEye, 10}}};
  for (const auto& [eye, least] : eyes) {
    double closest = 1e9;
    std::string pair;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double d = color_difference(lab(seen(eye, linear(*color(kNames[i])))),
                                          lab(seen(eye, linear(*color(kNames[j])))));
        if (d < closest) closest = d, pair = std::string(kNames[i]) + " and " + kNames[j];
      }
    }
    std::cout << "closest: " << pair << ", dE " << closest << "\n";
    EXPECT_GT(closest, least) << pair;
  }
}

TEST(Color, NamesAreOkabeAndIto) {
  EXPECT_EQ(color("orange"), (Color{0xE6, 0x9F, 0x00}));
  EXPECT_EQ(color("sky"), (Color{0x56, 0xB4, 0xE9}));
  EXPECT_EQ(color("green"), (Color{0x00, 0x9E, 0x73}));
  EXPECT_EQ(color("blue"), (Color{0x00, 0x72, 0xB2}));
  EXPECT_EQ(color("vermilion"), (Color{0xD5, 0x5E, 0x00}));
  EXPECT_EQ(color("purple"), (Color{0xCC, 0x79, 0xA7}));
  EXPECT_EQ(color("yellow"), (Color{0xF0, 0xE4, 0x42}));
}

TEST(Color, HexIsReadAndNothingElse) {
  EXPECT_EQ(color("#1f2328"), (Color{0x1F, 0x23, 0x28}));
  EXPECT_EQ(color("#F0a"), (Color{0xFF, 0x00, 0xAA}));
  for (const char* wrong : {"", "#", "#12", "#12345", "#1234567", "#gg0000", "Orange", "1f2328"}) {
    EXPECT_FALSE(color(wrong)) << wrong;
  }
}

TEST(Color, MixingRunsFromOneToTheOther) {
  const Color a{10, 200, 0, 255}, b{20, 100, 255, 0};
  EXPECT_EQ(mix(a, b, 0), a);
  EXPECT_EQ(mix(a, b, 1), b);
  EXPECT_EQ(mix(a, b, 0.5), (Color{15, 150, 128, 128}));
}

/// WCAG's own examples: black on white, and the lightest grey that may carry text on white.
TEST(Color, ContrastIsThatOfWcag) {
  const Color white{255, 255, 255}, black{0, 0, 0}, grey{0x76, 0x76, 0x76};
  EXPECT_NEAR(contrast(black, white), 21, 1e-9);
  EXPECT_NEAR(contrast(grey, white), 4.54, 0.005);
  EXPECT_EQ(contrast(white, grey), contrast(grey, white));
  EXPECT_EQ(contrast(grey, grey), 1);
}

/// Words in the colour of a thing can be read on either theme, and those that could be are not changed.
TEST(Color, WordsAreLegible) {
  for (const Theme theme : {Theme::paper, Theme::screen}) {
    const Palette colours = palette(theme);
    for (const char* name : kNames) {
      Color thin = *color(name);
      thin.a = 100;
      const Color words = legible(thin, colours);
      EXPECT_EQ(words.a, 100) << name;
      EXPECT_GE(contrast({words.r, words.g, words.b}, colours.room), 4.5) << name;
      if (contrast(*color(name), colours.room) >= 4.5) {
        EXPECT_EQ(words, thin) << name;
      }
    }
  }
}

/// In grey, too: the colours of the first things are as far apart in lightness as blue and vermilion.
TEST(Color, TheFirstInTurnAreToldApartInGrey) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) {
      const auto lightness = [](Color c) { return lab(linear(c))[0]; };
      EXPECT_GT(std::abs(lightness(turn(i)) - lightness(turn(j))), 8) << i << ' ' << j;
    }
}

}  // namespace
}  // namespace obscura::draw
