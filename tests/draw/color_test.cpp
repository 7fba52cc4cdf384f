#include "draw/picture/color.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace obscura::draw {
namespace {

using Rgb = std::array<double, 3>;

Rgb linear(Color c) {
  auto decode = [](double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); };
  return {decode(c.r / 255.0), decode(c.g / 255.0), decode(c.b / 255.0)};
}

Rgb times(const std::array<Rgb, 3>& m, const Rgb& v) {
  Rgb out{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[i] += m[i][j] * v[j];
    out[i] = std::min(1.0, std::max(0.0, out[i]));
  }
  return out;
}

// CIE L*a*b* of a linear sRGB colour, white D65.
Rgb lab(const Rgb& c) {
  const double x = (0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2]) / 0.95047;
  const double y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  const double z = (0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]) / 1.08883;
  auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

double distance(const Rgb& a, const Rgb& b) {
  return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
}

// Machado, Oliveira and Fernandes, IEEE TVCG 2009, severity 1, on linear sRGB.
constexpr std::array<Rgb, 3> kProtan{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr std::array<Rgb, 3> kDeutan{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
constexpr std::array<Rgb, 3> kTritan{
    {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};
constexpr std::array<Rgb, 3> kNormal{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

constexpr std::array<const char*, 7> kNames{"orange",    "sky",    "green", "blue",
                                            "vermilion", "purple", "yellow"};

TEST(Color, PaletteIsToldApartWithoutColourVision) {
  // 2.3 is a just noticeable difference in CIE 1976; 10 is plain side by side, 20 across a picture
  const std::array<std::pair<std::array<Rgb, 3>, double>, 4> eyes{
      {{kNormal, 20}, {kProtan, 10}, {kDeutan, 10}, {kTritan, 10}}};
  for (const auto& [eye, least] : eyes) {
    double closest = 1e9;
    std::string pair;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double d =
            distance(lab(times(eye, linear(*color(kNames[i])))), lab(times(eye, linear(*color(kNames[j])))));
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

}  // namespace
}  // namespace obscura::draw
