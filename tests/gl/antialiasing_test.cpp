// Every pixel at a rim or an edge against its exact share, here by 64 x 64 points a pixel: 1/64 of a pixel's
// side is the error of the points themselves on an edge along the rows, 1/255 that of 8 bits. The bar
// is 1/16.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "gl/renderer.h"

namespace obscura::gl {
namespace {

constexpr int kPixels = 108;       // a picture's side
constexpr double kPageUnits = 10;  // a pixel
constexpr int kPoints = 64;
constexpr double kBar = 1.0 / 16;

using Inside = std::function<bool(double x, double y)>;  // px

class Antialiasing : public ::testing::Test {
 protected:
  media::Image drawn(const draw::List& list) {
    draw::Picture picture;
    picture.aspect = 1;
    picture.ground = {255, 255, 255};
    picture.moving = list;
    media::Image image;
    renderer_.draw(picture, image);
    return image;
  }

  static int points_in(const Inside& inside, int x, int y, int n) {
    int count = 0;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) count += inside(x + (i + 0.5) / n, y + (j + 0.5) / n);
    }
    return count;
  }

  // the largest error over the picture, and the mean error, which a shape drawn too wide would show
  static void expect_shares(const media::Image& image, const Inside& inside, const std::string& what) {
    double largest = 0, sum = 0;
    int edges = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        // a coarse look first: most pixels are all in or all out
        int count = points_in(inside, x, y, 8) * kPoints * kPoints / 64;
        if (count > 0 && count < kPoints * kPoints) count = points_in(inside, x, y, kPoints);
        const double share = double(count) / (kPoints * kPoints);
        const double error = (255 - image.row(y)[4 * x]) / 255.0 - share;
        largest = std::max(largest, std::abs(error));
        if (count > 0 && count < kPoints * kPoints) sum += error, ++edges;
      }
    }
    EXPECT_LT(largest, kBar) << what;
    EXPECT_LT(std::abs(sum / edges), 0.01) << what;
  }

  static draw::Point page(double x, double y) { return {kPageUnits * x, kPageUnits * y}; }

  Renderer renderer_{kPixels, kPixels};
  const draw::Color ink_{0, 0, 0};
};

TEST_F(Antialiasing, DiscsCoverTheirShareOfEveryPixel) {
  for (const double radius : {1.5, 3.0, 7.3, 20.0}) {
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.5, 0.5}, {0.25, 0.7}, {0.9, 0.1}}) {
      const double cx = 50 + dx, cy = 50 + dy;
      draw::List list;
      list.add(draw::Disc{page(cx, cy), kPageUnits * radius, 0, ink_, ink_});
      expect_shares(
          drawn(list), [=](double x, double y) { return std::hypot(x - cx, y - cy) < radius; },
          "radius " + std::to_string(radius));
    }
  }
}

TEST_F(Antialiasing, TwoPixelLinesCoverTheirShareAtTwelveAngles) {
  for (int k = 0; k < 12; ++k) {
    const double angle = std::numbers::pi * k / 12 + 0.013, c = std::cos(angle), s = std::sin(angle);
    const double cx = 54.3, cy = 53.8, reach = 35;
    draw::List list;
    list.add({{page(cx - reach * c, cy - reach * s), 2 * kPageUnits, ink_},
              {page(cx + reach * c, cy + reach * s), 2 * kPageUnits, ink_}},
             draw::Cap::butt);
    const auto inside = [=](double x, double y) {
      const double along = (x - cx) * c + (y - cy) * s, across = (y - cy) * c - (x - cx) * s;
      return std::abs(along) < reach && std::abs(across) < 1;
    };
    expect_shares(drawn(list), inside, "angle " + std::to_string(15 * k));
  }
}

TEST_F(Antialiasing, BoxesAndTheirOutlinesCoverTheirShare) {
  for (int k = 0; k < 7; ++k) {
    const double angle = std::numbers::pi * k / 13, c = std::cos(angle), s = std::sin(angle);
    const double cx = 53.7, cy = 54.2, w = 21.3, h = 9.4, line = 2.8;
    draw::Box box;
    box.center = page(cx, cy), box.x_axis = {c, s}, box.half = page(w, h);
    box.line = kPageUnits * line, box.fill = {255, 255, 255}, box.outline = ink_;
    draw::List list;
    list.add(box);
    const auto inside = [=](double x, double y) {
      const double u = std::abs((x - cx) * c + (y - cy) * s), v = std::abs((y - cy) * c - (x - cx) * s);
      return u < w && v < h && !(u < w - line && v < h - line);
    };
    expect_shares(drawn(list), inside, "turned " + std::to_string(k) + "/13 of a half turn");
  }
}

TEST_F(Antialiasing, PolygonsCoverTheirShare) {
  draw::List list;
  list.add({page(20, 30), page(80, 41), page(62, 77), page(33, 69)}, ink_);
  const double corners[4][2] = {{20, 30}, {80, 41}, {62, 77}, {33, 69}};
  const auto inside = [&](double x, double y) {
    for (int i = 0; i < 4; ++i) {
      const double *a = corners[i], *b = corners[(i + 1) % 4];
      if ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) < 0) return false;
    }
    return true;
  };
  expect_shares(drawn(list), inside, "a quadrilateral");
}

TEST_F(Antialiasing, AHalfTransparentCurveHasNoBeadsAtItsJoints) {
  // a circle of short pieces: along its middle the ink is what alpha says, to the rounding of 8 bits twice
  std::vector<draw::Node> nodes;
  for (int i = 0; i <= 90; ++i) {
    const double a = 1.5 * std::numbers::pi * i / 90;
    nodes.push_back(
        {page(54 + 30 * std::cos(a), 54 + 30 * std::sin(a)), 6 * kPageUnits, draw::Color{0, 0, 0, 128}});
  }
  draw::List list;
  list.add(nodes, draw::Cap::butt);
  const media::Image image = drawn(list);
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const double dx = x + 0.5 - 54, dy = y + 0.5 - 54, a = std::atan2(dy, dx);
      if (std::abs(std::hypot(dx, dy) - 30) > 1.8 || (a < -0.1 && a > -std::numbers::pi / 2 - 0.1)) continue;
      if (a < 0.1 && a > -std::numbers::pi / 2) continue;
      EXPECT_NEAR(int(image.row(y)[4 * x]), 127, 2) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace obscura::gl
