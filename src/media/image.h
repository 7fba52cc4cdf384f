#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace obscura::media {

/// A part of a picture, px.
struct Rect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// RGBA8, sRGB, row 0 at the top, rows without gaps, alpha not multiplied in.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // 4 * width * height

  std::uint8_t* row(int y) { return pixels.data() + std::size_t(4) * width * y; }
  const std::uint8_t* row(int y) const { return pixels.data() + std::size_t(4) * width * y; }
  bool operator==(const Image&) const = default;
};

/// Metadata of a file: keyword -> text, UTF-8 (PNG: iTXt; movies: one JSON object in `comment`).
using Tags = std::map<std::string, std::string>;

}  // namespace obscura::media
