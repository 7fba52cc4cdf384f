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

/// The instructions a conversion runs by. The bytes are the same.
enum class Lanes { scalar, sse2, avx2 };

/// Whether this processor has them.
bool available(Lanes lanes);

/// Converts an image of even size, alpha ignored: every sample is the exact value of ITU-R BT.709, rounded to
/// the nearest integer (halves up). The widest lanes this processor has, unless told.
void convert(const Image& image, const Yuv420& out);
void convert(const Image& image, const Yuv420& out, Lanes lanes);
/// The same of a part alone, whose place and size are even.
void convert(const Image& image, const Yuv420& out, const Rect& part);

}  // namespace obscura::media
