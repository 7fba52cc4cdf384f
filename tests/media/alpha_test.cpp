#include "media/alpha.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace obscura::media {
namespace {

/// Every sample is the real number of BT.709, rounded: never more than half a level off.
TEST(Deep, EverySampleIsTheNearestToBt709) {
  Image image{256, 64, std::vector<std::uint8_t>(4 * 256 * 64)};
  std::mt19937 random(5);
  for (std::uint8_t& byte : image.pixels) byte = std::uint8_t(random());
  // the corners of the cube too
  for (int k = 0; k < 8; ++k)
    for (int c = 0; c < 3; ++c) image.pixels[std::size_t(4 * k + c)] = k >> c & 1 ? 255 : 0;
  const std::size_t n = 256 * 64;
  std::vector<std::uint16_t> y(n), u(n), v(n), a(n);
  convert_deep(image, {y.data(), u.data(), v.data(), a.data(), 256, 256, 256, 256});
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t* p = &image.pixels[4 * i];
    const double r = p[0] / 255.0, g = p[1] / 255.0, b = p[2] / 255.0;
    const double e = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    EXPECT_NEAR(y[i], 64 + 876 * e, 0.5 + 1e-9);
    EXPECT_NEAR(u[i], 512 + 896 * (b - e) / 1.8556, 0.5 + 1e-9);
    EXPECT_NEAR(v[i], 512 + 896 * (r - e) / 1.5748, 0.5 + 1e-9);
    EXPECT_NEAR(a[i], 1023 * (p[3] / 255.0), 0.5 + 1e-9);
  }
}

/// What is not seen takes the colour of what is seen beside it; what is seen keeps its own.
TEST(Alpha, ColoursSpreadToInvisibleNeighbours) {
  Image image{4, 2, std::vector<std::uint8_t>(32, 0)};
  const auto set = [&](int x, int y, std::uint8_t r, std::uint8_t g, std::uint8_t alpha) {
    std::uint8_t* p = image.row(y) + 4 * x;
    p[0] = r, p[1] = g, p[3] = alpha;
  };
  set(0, 0, 200, 100, 255), set(1, 1, 100, 0, 85);
  spread_colors(image);
  // (255 * 200 + 85 * 100) / 340 = 175
  EXPECT_EQ(image.row(0)[4], 175);
  EXPECT_EQ(image.row(0)[5], 75);
  EXPECT_EQ(image.row(0)[7], 0) << "it stays invisible";
  EXPECT_EQ(image.row(0)[0], 200);
  EXPECT_EQ(image.row(1)[4], 100);
  EXPECT_EQ(image.row(0)[8], 0) << "four that are all invisible";
}

TEST(Alpha, IsAPlaneOfItsOwn) {
  Image image{2, 2, std::vector<std::uint8_t>(16, 9)};
  image.pixels[7] = 200;
  std::vector<std::uint8_t> plane(6, 1);
  alpha_plane(image, plane.data(), 3);
  EXPECT_EQ(plane, (std::vector<std::uint8_t>{9, 200, 1, 9, 9, 1}));
}

}  // namespace
}  // namespace obscura::media
