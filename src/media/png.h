#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "media/image.h"

namespace obscura::media {

struct PngOptions {
  bool alpha = false;    // keep the alpha channel; else opaque RGB
  double per_metre = 0;  // pixels a metre (pHYs); 0: left open
  Tags tags{};
};

/// A PNG file as bytes: 8-bit, sRGB chunk, tags as iTXt. The same bytes for the same image and tags.
std::vector<std::uint8_t> encode_png(const Image& image, const PngOptions& options = {});

/// Writes a PNG under a temporary name beside `path`, then renames it. Throws media::Error naming the path.
void write_png(const std::string& path, const Image& image, const PngOptions& options = {});

struct Png {
  Image image;
  Tags tags{};
};

/// Reads a PNG as RGBA8. Throws media::Error naming the path.
Png read_png(const std::string& path);

}  // namespace obscura::media
