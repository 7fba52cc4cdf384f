#pragma once

#include <cstdint>

#include "media/image.h"

namespace obscura::media {

/// Gives invisible pixels beside visible ones their colour: the mean of the visible ones, by their alpha, of
/// the same four pixels that share one sample of chroma. Else the edge of everything would be dark. Requires
/// even sides.
void spread_colors(Image& image);

/// The alpha of an image as a plane, 0 to 255.
void alpha_plane(const Image& image, std::uint8_t* plane, int stride);

/// Planes of limited-range bt709 4:4:4 of 10 bits, with an alpha of 0 to 1023; strides in samples.
struct Deep444 {
  std::uint16_t *y = nullptr, *u = nullptr, *v = nullptr, *a = nullptr;
  int y_stride = 0, u_stride = 0, v_stride = 0, a_stride = 0;
};

/// Converts with its alpha, every sample rounded to the nearest.
void convert_deep(const Image& image, const Deep444& out);

}  // namespace obscura::media
