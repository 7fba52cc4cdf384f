#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace obscura::draw {

/// sRGB, 8 bits a channel, alpha not multiplied in. Pictures are blended in these encoded values, as browsers
/// and Cairo do: alpha over, per channel.
struct Color {
  std::uint8_t r = 0, g = 0, b = 0, a = 255;

  bool operator==(const Color&) const = default;
};

/// `a` part of the way to `b`, in encoded values; t in [0, 1].
Color mix(Color a, Color b, double t);

/// How much an eye tells them apart, 1 to 21: the ratio of their luminances, as WCAG 2.2 has it.
double contrast(Color a, Color b);

/// How bright it is to an eye, black 0 to white 1 (WCAG 2.2).
double luminance(Color c);

/// A name of the palette (orange sky green blue vermilion purple yellow grey black white) or #rgb, #rrggbb.
std::optional<Color> color(std::string_view name);

}  // namespace obscura::draw
