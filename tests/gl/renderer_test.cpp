#include "gl/renderer.h"

#include <gtest/gtest.h>

#include "gl/error.h"
#include "gl/pictures.h"

namespace obscura::gl {
namespace {

constexpr int kSide = 108;  // px, ten page units a pixel

TEST(Renderer, PutsAKnownPointOfThePageIntoItsPixelAndUpIsUp) {
  Renderer renderer(2 * kSide, kSide);
  draw::Picture picture;
  picture.ground = kWhite;
  picture.moving.add(draw::Disc{{555, 255}, 60, 0, kBlack, kBlack});
  media::Image image;
  renderer.draw(picture, image);
  ASSERT_EQ(image.width, 2 * kSide);
  ASSERT_EQ(image.height, kSide);
  double sum = 0, x = 0, y = 0;
  for (int r = 0; r < image.height; ++r) {
    for (int c = 0; c < image.width; ++c) {
      sum += ink(image, c, r);
      x += ink(image, c, r) * (c + 0.5);
      y += ink(image, c, r) * (r + 0.5);
    }
  }
  // the centroid of an antialiased disc is its centre, to the rounding of 8 bits
  EXPECT_NEAR(x / sum, 55.5, 0.02);
  EXPECT_NEAR(y / sum, 25.5, 0.02);
}

TEST(Renderer, RefusesAPictureBeyondTheLimitAndNamesIt) {
  try {
    Renderer renderer(20000, 100);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("limit is 16384 px"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace obscura::gl
