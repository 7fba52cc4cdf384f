// Movies with alpha. The colours are not multiplied by it, as players of VP9 and ProRes 4444 want them.
//
// In 10 bits, ITU-R BT.709-6 items 3.2 to 3.5 with Y = 64 + 876 E, Cb = 512 + 896 (B - E) / 1.8556, Cr = 512
// + 896 (R - E) / 1.5748; in integers as in yuv.cpp, with one pixel a sample of chroma:
//
//   S = 1063 R + 3576 G + 361 B           E = S / (5000 * 255)      Y  = 64 + 73 S / 106250
//   U = -1063 R - 3576 G + 4639 B                                   Cb = 512 + 448 U / 1182945
//   V = 3937 R - 3576 G - 361 B                                     Cr = 512 + 448 V / 1003935

#include "media/alpha.h"

#include <cstddef>

namespace obscura::media {

void spread_colors(Image& image) {
  for (int y = 0; y + 1 < image.height; y += 2) {
    std::uint8_t *top = image.row(y), *bottom = image.row(y + 1);
    for (int x = 0; x + 1 < image.width; x += 2) {
      std::uint8_t* const four[] = {top + 4 * x, top + 4 * x + 4, bottom + 4 * x, bottom + 4 * x + 4};
      int sum = 0, visible = 0;
      for (const std::uint8_t* p : four) sum += p[3], visible += p[3] > 0;
      if (visible == 0 || visible == 4) continue;
      std::uint8_t mean[3];
      for (int k = 0; k < 3; ++k) {
        int all = 0;
        for (const std::uint8_t* p : four) all += p[3] * p[k];
        mean[k] = std::uint8_t((2 * all + sum) / (2 * sum));
      }
      for (std::uint8_t* p : four)
        if (p[3] == 0) p[0] = mean[0], p[1] = mean[1], p[2] = mean[2];
    }
  }
}

void alpha_plane(const Image& image, std::uint8_t* plane, int stride) {
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* from = image.row(y);
    std::uint8_t* to = plane + std::ptrdiff_t(stride) * y;
    for (int x = 0; x < image.width; ++x) to[x] = from[4 * x + 3];
  }
}

void convert_deep(const Image& image, const Deep444& out) {
  // n / d to the nearest, n may be negative
  const auto ratio = [](std::int64_t n, std::int64_t d) { return std::uint16_t((2 * n + d) / (2 * d)); };
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* p = image.row(row);
    std::uint16_t *y = out.y + std::ptrdiff_t(out.y_stride) * row,
                  *u = out.u + std::ptrdiff_t(out.u_stride) * row,
                  *v = out.v + std::ptrdiff_t(out.v_stride) * row,
                  *a = out.a + std::ptrdiff_t(out.a_stride) * row;
    for (int x = 0; x < image.width; ++x, p += 4) {
      const std::int64_t r = p[0], g = p[1], b = p[2];
      y[x] = ratio(73 * (1063 * r + 3576 * g + 361 * b) + 64 * 106250, 106250);
      u[x] = ratio(448 * (-1063 * r - 3576 * g + 4639 * b) + 512LL * 1182945, 1182945);
      v[x] = ratio(448 * (3937 * r - 3576 * g - 361 * b) + 512LL * 1003935, 1003935);
      a[x] = ratio(1023LL * p[3], 255);
    }
  }
}

}  // namespace obscura::media
