#include "draw/picture/color.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace obscura::draw {
namespace {

// Okabe and Ito, Color Universal Design, 2008: told apart without colour vision. Grey is ours: as light as
// their vermilion, without hue.
constexpr std::array<std::pair<std::string_view, Color>, 10> kPalette{{
    {"orange", {0xE6, 0x9F, 0x00}},
    {"sky", {0x56, 0xB4, 0xE9}},
    {"green", {0x00, 0x9E, 0x73}},
    {"blue", {0x00, 0x72, 0xB2}},
    {"vermilion", {0xD5, 0x5E, 0x00}},
    {"purple", {0xCC, 0x79, 0xA7}},
    {"yellow", {0xF0, 0xE4, 0x42}},
    {"grey", {0x80, 0x85, 0x8C}},
    {"black", {0x00, 0x00, 0x00}},
    {"white", {0xFF, 0xFF, 0xFF}},
}};

// other names that people type, in the palette's tone: most are not told apart without colour vision
constexpr std::array<std::pair<std::string_view, Color>, 14> kOthers{{
    {"red", {0xD6, 0x27, 0x28}},
    {"gray", {0x80, 0x85, 0x8C}},
    {"brown", {0x8C, 0x56, 0x4B}},
    {"pink", {0xE3, 0x77, 0xC2}},
    {"cyan", {0x17, 0xBE, 0xCF}},
    {"magenta", {0xC2, 0x2E, 0xA0}},
    {"violet", {0x7F, 0x5F, 0xC7}},
    {"navy", {0x1F, 0x3A, 0x6E}},
    {"teal", {0x12, 0x80, 0x80}},
    {"turquoise", {0x40, 0xC4, 0xB8}},
    {"olive", {0x8A, 0x8A, 0x1C}},
    {"lime", {0x8C, 0xC6, 0x2E}},
    {"gold", {0xD9, 0xA4, 0x06}},
    {"silver", {0xB8, 0xBC, 0xC2}},
}};

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

Color mix(Color a, Color b, double t) {
  auto channel = [t](std::uint8_t from, std::uint8_t to) {
    return std::uint8_t(std::lround(from + (double(to) - from) * t));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b), channel(a.a, b.a)};
}

std::optional<Color> color(std::string_view name) {
  for (const auto& [known, value] : kPalette) {
    if (name == known) return value;
  }
  for (const auto& [known, value] : kOthers) {
    if (name == known) return value;
  }
  if (name.empty() || name[0] != '#' || (name.size() != 4 && name.size() != 7)) return std::nullopt;
  const int wide = name.size() == 7 ? 2 : 1;
  std::array<std::uint8_t, 3> rgb;
  for (int i = 0; i < 3; ++i) {
    const int high = digit(name[1 + wide * i]), low = digit(name[wide * (i + 1)]);
    if (high < 0 || low < 0) return std::nullopt;
    rgb[i] = std::uint8_t(16 * high + low);
  }
  return Color{rgb[0], rgb[1], rgb[2]};
}

double luminance(Color c) {
  const auto linear = [](std::uint8_t level) {
    const double x = level / 255.0;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

double contrast(Color a, Color b) {
  const double x = luminance(a) + 0.05, y = luminance(b) + 0.05;
  return std::max(x, y) / std::min(x, y);
}

}  // namespace obscura::draw
