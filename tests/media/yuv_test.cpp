#include "media/yuv.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "media/pictures.h"

namespace obscura::media {
namespace {

// planes with strides of their own, and a guard byte after each row
struct Planes {
  int width, height, pad;
  std::vector<std::uint8_t> y, u, v;
  Planes(int w, int h, int gap)
      : width(w),
        height(h),
        pad(gap),
        y(std::size_t(w + gap) * h, 0xAA),
        u(std::size_t(w / 2 + gap) * (h / 2), 0xAA),
        v(u) {}
  Yuv420 out() { return {y.data(), u.data(), v.data(), width + pad, width / 2 + pad, width / 2 + pad}; }
  bool operator==(const Planes&) const = default;
};

// BT.709 in doubles, from the definition
std::array<double, 3> bt709(double r, double g, double b) {
  const double e = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  return {16 + 219 / 255.0 * e, 128 + 224 / 255.0 * (b - e) / (2 * (1 - 0.0722)),
          128 + 224 / 255.0 * (r - e) / (2 * (1 - 0.2126))};
}

// those of this processor
std::vector<Lanes> lanes_here() {
  std::vector<Lanes> all;
  for (const Lanes lanes : {Lanes::scalar, Lanes::sse2, Lanes::avx2})
    if (available(lanes)) all.push_back(lanes);
  return all;
}

class EveryLanes : public ::testing::TestWithParam<Lanes> {};
std::string lanes_name(const ::testing::TestParamInfo<Lanes>& lanes) {
  constexpr const char* kNames[] = {"Scalar", "Sse2", "Avx2"};
  return kNames[int(lanes.param)];
}
INSTANTIATE_TEST_SUITE_P(Yuv, EveryLanes, ::testing::ValuesIn(lanes_here()), lanes_name);

// Half a level from the exact value, and the double formula's own error of 1e-12.
TEST_P(EveryLanes, RoundsTheExactValueOfRandomPictures) {
  const Image image = random_image(334, 52, 1);
  Planes planes(334, 52, 0);
  convert(image, planes.out(), GetParam());
  const auto at = [&](int x, int y) { return image.row(y) + 4 * x; };
  for (int y = 0; y < 52; ++y) {
    for (int x = 0; x < 334; ++x) {
      const std::uint8_t* p = at(x, y);
      EXPECT_LE(std::abs(planes.y[std::size_t(334 * y + x)] - bt709(p[0], p[1], p[2])[0]), 0.5 + 1e-12);
    }
  }
  for (int y = 0; y < 26; ++y) {
    for (int x = 0; x < 167; ++x) {
      double mean[3] = {};
      for (int k = 0; k < 4; ++k) {
        for (int c = 0; c < 3; ++c) mean[c] += at(2 * x + k % 2, 2 * y + k / 2)[c] / 4.0;
      }
      const auto exact = bt709(mean[0], mean[1], mean[2]);
      EXPECT_LE(std::abs(planes.u[std::size_t(167 * y + x)] - exact[1]), 0.5 + 1e-12);
      EXPECT_LE(std::abs(planes.v[std::size_t(167 * y + x)] - exact[2]), 0.5 + 1e-12);
    }
  }
}

TEST_P(EveryLanes, GivesTheSameBytesForEveryWidthAndStride) {
  for (int width = 2; width <= 70; width += 2) {
    for (const int pad : {0, 1, 7, 33}) {
      const Image image = random_image(width, 6, unsigned(width));
      Planes scalar(width, 6, pad), lanes(width, 6, pad);
      convert(image, scalar.out(), Lanes::scalar);
      convert(image, lanes.out(), GetParam());
      ASSERT_EQ(scalar, lanes) << width << " wide, " << pad << " apart";
    }
  }
}

// Every colour there is, as flat blocks of two by two: every value of luma's numerator, and chroma's at every
// fourth.
TEST_P(EveryLanes, GivesTheSameBytesForEveryColour) {
  Image image{512, 512, std::vector<std::uint8_t>(4 * 512 * 512, 255)};
  for (int red = 0; red < 256; ++red) {
    for (int y = 0; y < 512; ++y) {
      std::uint8_t* p = image.row(y);
      for (int x = 0; x < 512; ++x, p += 4) {
        p[0] = std::uint8_t(red);
        p[1] = std::uint8_t(y / 2);
        p[2] = std::uint8_t(x / 2);
      }
    }
    Planes scalar(512, 512, 0), lanes(512, 512, 0);
    convert(image, scalar.out(), Lanes::scalar);
    convert(image, lanes.out(), GetParam());
    ASSERT_EQ(scalar, lanes) << "red " << red;
  }
}

// The reciprocals in yuv.cpp against the integer quotients, for every numerator.
TEST(Yuv, ReciprocalsGiveTheExactQuotient) {
  for (int s = 0; s <= 5000 * 255; ++s) {
    const int t = (73 * s + 7012500) / 8;
    ASSERT_EQ(int(float(t) * (1.0f / 53125)), (73 * s + 7012500) / 425000) << s;
  }
  for (int c = -4639 * 1020; c <= 4639 * 1020; ++c) {
    ASSERT_EQ(int(c * (28.0 / 1182945) + 128.5), (56 * c + 257 * 1182945) / (2 * 1182945)) << c;
  }
  for (int c = -3937 * 1020; c <= 3937 * 1020; ++c) {
    ASSERT_EQ(int(c * (28.0 / 1003935) + 128.5), (56 * c + 257 * 1003935) / (2 * 1003935)) << c;
  }
}

TEST(Yuv, BlackWhiteAndThePrimariesAreWhereTheStandardPutsThem) {
  const auto flat = [](int r, int g, int b) {
    Image image{2, 2, {}};
    for (int k = 0; k < 4; ++k) {
      for (const int c : {r, g, b, 0}) image.pixels.push_back(std::uint8_t(c));
    }
    Planes planes(2, 2, 0);
    convert(image, planes.out());
    return std::array<int, 3>{planes.y[0], planes.u[0], planes.v[0]};
  };
  EXPECT_EQ(flat(0, 0, 0), (std::array{16, 128, 128}));
  EXPECT_EQ(flat(255, 255, 255), (std::array{235, 128, 128}));
  EXPECT_EQ(flat(255, 0, 0), (std::array{63, 102, 240}));
  EXPECT_EQ(flat(0, 255, 0), (std::array{173, 42, 26}));
  EXPECT_EQ(flat(0, 0, 255), (std::array{32, 240, 118}));
}

}  // namespace
}  // namespace obscura::media
