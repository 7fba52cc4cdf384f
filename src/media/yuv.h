#pragma once

#include <cstdint>
#include <vector>

#include "media/image.h"

namespace obscura::media {

/// Planes of limited-range bt709 4:2:0. Chroma is the mean of its four pixels (sited at their centre).
struct Yuv420 {
  std::uint8_t* y = nullptr;
  std::uint8_t* u = nullptr;
  std::uint8_t* v = nullptr;
  int y_stride = 0, u_stride = 0, v_stride = 0;
};

/// Converts an image of even size, alpha ignored. Integer arithmetic: the same bytes on every processor,
/// whichever instructions it runs by.
void convert(const Image& image, const Yuv420& out);

}  // namespace obscura::media
