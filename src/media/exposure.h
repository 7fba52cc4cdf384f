#pragma once

#include <cstdint>
#include <vector>

#include "media/image.h"

namespace obscura::media {

/// The mean of several pictures in linear light, as an open shutter sees them. Where all of them are equal,
/// the mean has the same bits.
class Exposure {
 public:
  /// At most 64 pictures, all of one size.
  void add(const Image& picture);
  /// The mean of what was added since the last call, which is one at least; good until the next add.
  const Image& develop();

 private:
  /// Pixels that are compared, and added up, together.
  static constexpr std::size_t kBlock = 64;

  void add(const std::uint8_t* pixels, std::size_t first, std::size_t count, std::uint32_t times);

  Image image_;                      // the first
  std::uint32_t count_ = 0;          // pictures
  std::vector<std::uint8_t> apart_;  // blocks in which one was not as the first
  std::vector<std::uint32_t> sums_;  // of theirs: light times alpha, and alpha, four a pixel
};

}  // namespace obscura::media
