#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include <unistd.h>

#include "media/image.h"

namespace obscura::media {

/// A directory of the test's own, removed at its end.
struct Folder {
  std::filesystem::path path;
  Folder() {
    static int count = 0;
    path = std::filesystem::temp_directory_path() /
           ("obscura-media-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string operator/(const std::string& name) const { return (path / name).string(); }
  /// Everything in it, hidden files too.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(path))
      all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
  }
};

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline Image random_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(4) * width * height)};
  for (std::uint8_t& byte : image.pixels) byte = std::uint8_t(random());
  return image;
}

/// A picture like ours: a flat ground (a gradient where asked), antialiased discs with outlines that move
/// with time t (s), hatching.
inline Image moving_picture(int width, int height, double t, bool gradient = false) {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(4) * width * height)};
  const double s = height / 360.0;
  for (int y = 0; y < height; ++y) {
    std::uint8_t* p = image.row(y);
    for (int x = 0; x < width; ++x, p += 4) {
      p[0] = p[1] = std::uint8_t(gradient ? 250 - 30 * y / height : 250);
      p[2] = std::uint8_t(gradient ? 252 - 20 * x / width : 252);
      p[3] = 255;
      if (y < 20 * s && (x + y) % int(14 * s + 1) < 1.6 * s) p[0] = p[1] = p[2] = 120;
    }
  }
  constexpr int kColours[5][3] = {
      {230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {213, 94, 0}, {204, 121, 167}};
  for (int i = 0; i < 5; ++i) {
    const double px = width * (0.5 + 0.38 * std::sin(t * (1.1 + 0.3 * i) + i));
    const double py = height * (0.5 + 0.36 * std::cos(t * (1.7 - 0.2 * i) + 2 * i));
    const double r = (18 + 6 * i) * s;
    for (int y = std::max(0, int(py - r - 1)); y < std::min<double>(height, py + r + 2); ++y) {
      for (int x = std::max(0, int(px - r - 1)); x < std::min<double>(width, px + r + 2); ++x) {
        const double d = std::hypot(x + 0.5 - px, y + 0.5 - py) - r;
        const double cover = std::clamp(0.5 - d, 0.0, 1.0), edge = std::clamp(0.5 + d + 2.8 * s, 0.0, 1.0);
        std::uint8_t* p = image.row(y) + 4 * x;
        for (int k = 0; k < 3; ++k) {
          p[k] = std::uint8_t(std::lround(p[k] + cover * (kColours[i][k] * (1 - 0.3 * edge) - p[k])));
        }
      }
    }
  }
  return image;
}

}  // namespace obscura::media
