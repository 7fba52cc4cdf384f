#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "draw/picture/list.h"
#include "gl/damage.h"

namespace obscura::gl {

/// How many of 32 rays each pixel of a picture misses: convex shadows are put down ray by ray, so that those
/// of one ray unite, and then counted. A pixel lies in a shadow where its centre does.
class Shade {
 public:
  Shade(int width, int height);

  /// Forgets the shadows in a part of the picture, px.
  void clear(const Damage::Rect& part);
  /// Adds a convex shadow, its corners (px) in order, either way around, to those of `rays`, a bit each.
  void add(std::span<const draw::Point> corners, std::uint32_t rays);
  /// How dark a part of the picture is, 0 to 255, into `dark()`.
  void count(const Damage::Rect& part);
  /// By rows, the first the picture's upper one.
  const std::vector<std::uint8_t>& dark() const { return dark_; }

 private:
  int width_, height_;
  std::vector<std::uint32_t> rays_;
  std::vector<std::uint8_t> dark_;
  std::vector<float> left_, right_;  // of each row of a shadow
};

}  // namespace obscura::gl
