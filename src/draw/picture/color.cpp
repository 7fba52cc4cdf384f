#include "draw/picture/color.h"

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

}  // namespace obscura::draw
