// How pictures differ: counted by hand on small ones.

#include "media/pixels.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "media/pictures.h"

namespace obscura::media {
namespace {

Image flat(int width, int height, std::uint8_t level) {
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(4) * width * height, level)};
  for (std::size_t i = 3; i < image.pixels.size(); i += 4) image.pixels[i] = 255;
  return image;
}

void set(Image& image, int x, int y, std::uint8_t level) {
  for (int k = 0; k < 3; ++k) image.row(y)[4 * x + k] = level;
}

// dark to the left of `edge`, light to its right, the pixel that it crosses in between
Image edged(double edge) {
  Image image = flat(20, 10, 0);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 20; ++x)
      set(image, x, y, std::uint8_t(std::lround(200 * std::clamp(x + 1 - edge, 0.0, 1.0))));
  return image;
}

TEST(Pixels, OfOnePictureAreTheSame) {
  const Difference d = difference(edged(7.3), edged(7.3));
  EXPECT_TRUE(d.same());
  EXPECT_EQ(d.largest, 0);
}

TEST(Pixels, OneIsFoundWithItsPlaceAndLevel) {
  Image other = flat(20, 10, 100);
  other.row(4)[4 * 13 + 1] = 103;
  const Difference d = difference(flat(20, 10, 100), other);
  EXPECT_EQ(d.pixels, 1);
  EXPECT_EQ(d.solid, 1);
  EXPECT_EQ(d.largest, 3);
  EXPECT_EQ(d.x, 13);
  EXPECT_EQ(d.y, 4);
  EXPECT_EQ(d.left, 13);
  EXPECT_EQ(d.right, 13);
  EXPECT_FALSE(d.alpha_only);
}

TEST(Pixels, WhatDiffersIsBoxedPlaceByPlace) {
  const Image one = flat(100, 80, 100);
  Image other = one;
  EXPECT_TRUE(difference_boxes(one, other, 12).empty());
  other.row(4)[4 * 13] = 101;
  EXPECT_EQ(difference_boxes(one, other, 12), (std::vector<Box>{{13, 4, 1, 1}}));
  // across cells' edges, and by their corners
  set(other, 17, 7, 0);
  set(other, 25, 8, 0);
  EXPECT_EQ(difference_boxes(one, other, 12), (std::vector<Box>{{13, 4, 13, 5}}));
  // the last pixel, in a cell that is cut, is another place; of more than are asked for all are one
  other.row(79)[4 * 99 + 3] = 0;
  EXPECT_EQ(difference_boxes(one, other, 2), (std::vector<Box>{{13, 4, 13, 5}, {99, 79, 1, 1}}));
  EXPECT_EQ(difference_boxes(one, other, 1), (std::vector<Box>{{13, 4, 87, 76}}));
}

TEST(Pixels, AlphaAloneIsSaidSo) {
  Image other = flat(20, 10, 100);
  other.row(0)[3] = 254;
  EXPECT_TRUE(difference(flat(20, 10, 100), other).alpha_only);
}

TEST(Pixels, AnEdgeThatMovesByAPartOfAPixelIsNotSolid) {
  // the crossed column alone changes, by 0.4 of 200
  const Difference d = difference(edged(7.2), edged(7.6));
  EXPECT_EQ(d.pixels, 10);
  EXPECT_EQ(d.largest, 80);
  EXPECT_EQ(d.solid, 0);
}

TEST(Pixels, AnEdgeThatMovesByThreeIs) {
  // each of the three whole columns in between has nothing like it around it in one of the two
  const Difference d = difference(edged(7), edged(10));
  EXPECT_EQ(d.pixels, 30);
  EXPECT_EQ(d.solid, 30);
}

TEST(Pixels, ALevelOfNoiseOnAFlatGroundIsSolid) {
  const Difference d = difference(flat(20, 10, 100), flat(20, 10, 101), 1);
  EXPECT_EQ(d.pixels, 200);
  EXPECT_EQ(d.solid, 200);
  EXPECT_EQ(d.beyond, 0);
}

TEST(Pixels, ALostLineIsSolid) {
  Image line = flat(20, 10, 255);
  for (int x = 0; x < 20; ++x) set(line, x, 5, 0);
  EXPECT_EQ(difference(line, flat(20, 10, 255)).solid, 20);
}

TEST(Pixels, OfTheDifferenceAreColouredWhereTheyDiffer) {
  Image other = flat(20, 10, 100);
  set(other, 3, 2, 0);
  const Image picture = difference_picture(flat(20, 10, 100), other);
  EXPECT_EQ(picture.row(2)[4 * 3], 213);
  EXPECT_EQ(picture.row(2)[4 * 4], picture.row(2)[4 * 4 + 1]);
  // of two sizes: as large as either
  const Image larger = difference_picture(flat(20, 10, 100), flat(10, 30, 100));
  EXPECT_EQ(larger.width, 20);
  EXPECT_EQ(larger.height, 30);
}

}  // namespace
}  // namespace obscura::media
