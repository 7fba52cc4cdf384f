// sRGB (IEC 61966-2-1) says how much light L a level c of 0 to 1 stands for,
//   L = c / 12.92 up to c = 0.04045, else ((c + 0.055) / 1.055)^2.4
// Light is counted in 65535 steps, three to five of them between the darkest levels, so that the mean of one
// level is that level. In pictures that are not opaque, light is weighted by its alpha:
//   L = sum a_i L_i / sum a_i,  a = sum a_i / n

#include "media/exposure.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

namespace obscura::media {
namespace {

constexpr double kMost = 65535;

double light(double level) {
  const double c = level / 255;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

struct Tables {
  std::array<std::uint32_t, 256> light_of;   // a level
  std::array<std::uint8_t, 65536> level_of;  // light, to the nearest level

  Tables() {
    for (int i = 0; i < 256; ++i) light_of[std::size_t(i)] = std::uint32_t(std::lround(kMost * light(i)));
    std::size_t next = 0;
    for (int i = 0; i < 256; ++i) {
      const auto end = i == 255 ? level_of.size() : std::size_t(std::ceil(kMost * light(i + 0.5)));
      for (; next < end; ++next) level_of[next] = std::uint8_t(i);
    }
  }
};

const Tables& tables() {
  static const Tables it;
  return it;
}

}  // namespace

void Exposure::add(const std::uint8_t* pixels, std::size_t first, std::size_t count, std::uint32_t times) {
  const Tables& table = tables();
  const std::uint8_t* p = pixels + 4 * first;
  std::uint32_t* sum = sums_.data() + 4 * first;
  for (std::size_t i = 0; i < count; ++i, p += 4, sum += 4) {
    const std::uint32_t alpha = p[3] * times;
    for (int c = 0; c < 3; ++c) sum[c] += table.light_of[p[c]] * alpha;
    sum[3] += alpha;
  }
}

void Exposure::add(const Image& picture) {
  const std::size_t pixels = picture.pixels.size() / 4, blocks = (pixels + kBlock - 1) / kBlock;
  if (count_++ == 0) {
    image_ = picture;
    apart_.assign(blocks, 0);
    return;
  }
  assert(count_ <= 64 && picture.pixels.size() == image_.pixels.size());
  sums_.resize(4 * pixels);
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t first = b * kBlock, n = std::min(kBlock, pixels - first);
    if (!apart_[b]) {
      if (!std::memcmp(&picture.pixels[4 * first], &image_.pixels[4 * first], 4 * n)) continue;
      // until now all were as the first
      apart_[b] = 1;
      std::fill_n(sums_.begin() + std::ptrdiff_t(4 * first), 4 * n, 0u);
      add(image_.pixels.data(), first, n, count_ - 1);
    }
    add(picture.pixels.data(), first, n, 1);
  }
}

const Image& Exposure::develop() {
  const Tables& table = tables();
  const std::size_t pixels = image_.pixels.size() / 4;
  for (std::size_t b = 0; b < apart_.size(); ++b) {
    if (!apart_[b]) continue;
    const std::size_t end = std::min((b + 1) * kBlock, pixels);
    for (std::size_t i = b * kBlock; i < end; ++i) {
      const std::uint32_t* sum = &sums_[4 * i];
      const std::uint32_t alpha = sum[3];
      std::uint8_t* p = &image_.pixels[4 * i];
      for (int c = 0; alpha > 0 && c < 3; ++c) p[c] = table.level_of[(sum[c] + alpha / 2) / alpha];
      p[3] = std::uint8_t((alpha + count_ / 2) / count_);
    }
  }
  count_ = 0;
  return image_;
}

}  // namespace obscura::media
