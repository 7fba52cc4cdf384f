#include "media/exposure.h"

#include <gtest/gtest.h>

namespace obscura::media {
namespace {

// one row of pixels of these levels, grey
Image greys(const std::vector<int>& levels, int alpha = 255) {
  Image image{int(levels.size()), 1, {}};
  for (const int level : levels)
    for (const int channel : {level, level, level, alpha}) image.pixels.push_back(std::uint8_t(channel));
  return image;
}

TEST(Exposure, WhatIsTheSameInAllPicturesStaysToTheBit) {
  std::vector<int> levels(256);
  for (int i = 0; i < 256; ++i) levels[std::size_t(i)] = i;
  // the last pixel makes its block be added up all the same
  for (const int n : {2, 7, 64}) {
    Exposure exposure;
    for (int k = 0; k < n; ++k) {
      std::vector<int> these = levels;
      for (std::size_t b = 63; b < 256; b += 64) these[b] = k % 2 ? 255 : 0;
      exposure.add(greys(these));
    }
    const Image mean = exposure.develop();
    for (int i = 0; i < 256; ++i) {
      if (i % 64 == 63) continue;
      EXPECT_EQ(mean.pixels[std::size_t(4 * i)], i) << n;
      EXPECT_EQ(mean.pixels[std::size_t(4 * i + 3)], 255);
    }
  }
}

TEST(Exposure, HalfBlackAndHalfWhiteIsHalfTheLight) {
  Exposure exposure;
  exposure.add(greys({0}));
  exposure.add(greys({255}));
  EXPECT_EQ(exposure.develop().pixels[0], 188);  // 255 (1.055 0.5^(1/2.4) - 0.055) = 187.5
  // and again: nothing is left of what was
  exposure.add(greys({10}));
  EXPECT_EQ(exposure.develop().pixels[0], 10);
}

TEST(Exposure, APictureThatIsOddLaterCountsAllBeforeIt) {
  Exposure exposure;
  for (int k = 0; k < 4; ++k) exposure.add(greys({k == 3 ? 255 : 0}));
  EXPECT_EQ(exposure.develop().pixels[0], 137);  // 255 (1.055 0.25^(1/2.4) - 0.055) = 136.96
}

TEST(Exposure, WhatIsNotThereHasNoColour) {
  Exposure exposure;
  exposure.add(greys({200}, 255));
  exposure.add(greys({0}, 0));
  const Image mean = exposure.develop();
  EXPECT_EQ(mean.pixels[0], 200);
  EXPECT_EQ(mean.pixels[3], 128);
}

}  // namespace
}  // namespace obscura::media
