// How pictures differ. A pixel is no more than an edge that moved by less than a pixel where each of the two
// pictures has its value between those that the other one has around it:
//   min B(3x3) <= a <= max B(3x3)  and  min A(3x3) <= b <= max A(3x3),  in every channel.
// Antialiased edges that are drawn a little otherwise are such; a colour, noise on a flat ground, a dot that
// is lost are not.

#include "media/pixels.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <cstring>

namespace obscura::media {

namespace {

// whether `value` lies within what `image` has around (x, y), in every channel
bool within(const Image& image, int x, int y, const std::uint8_t* value) {
  std::uint8_t low[4] = {255, 255, 255, 255}, high[4] = {0, 0, 0, 0};
  for (int j = std::max(0, y - 1); j <= std::min(image.height - 1, y + 1); ++j) {
    for (int i = std::max(0, x - 1); i <= std::min(image.width - 1, x + 1); ++i) {
      const std::uint8_t* p = image.row(j) + 4 * i;
      for (int k = 0; k < 4; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
  }
  for (int k = 0; k < 4; ++k)
    if (value[k] < low[k] || value[k] > high[k]) return false;
  return true;
}

bool edge(const Image& a, const Image& b, int x, int y) {
  return within(b, x, y, a.row(y) + 4 * x) && within(a, x, y, b.row(y) + 4 * x);
}

constexpr std::uint8_t kSolid[3] = {213, 94, 0}, kEdge[3] = {0, 114, 178};

}  // namespace

Difference difference(const Image& expected, const Image& actual, int level) {
  assert(expected.width == actual.width && expected.height == actual.height);
  Difference d;
  d.alpha_only = true;
  d.left = expected.width, d.top = expected.height, d.right = d.bottom = -1;
  for (int y = 0; y < expected.height; ++y) {
    const std::uint8_t *a = expected.row(y), *b = actual.row(y);
    if (std::memcmp(a, b, std::size_t(4) * expected.width) == 0) continue;
    for (int x = 0; x < expected.width; ++x) {
      int most = 0;
      for (int k = 0; k < 4; ++k) {
        const int off = std::abs(int(a[4 * x + k]) - int(b[4 * x + k]));
        most = std::max(most, off);
        if (off > 0 && k < 3) d.alpha_only = false;
      }
      if (most == 0) continue;
      ++d.pixels;
      d.beyond += most > level;
      d.solid += !edge(expected, actual, x, y);
      if (most > d.largest) d.largest = most, d.x = x, d.y = y;
      d.left = std::min(d.left, x), d.right = std::max(d.right, x);
      d.top = std::min(d.top, y), d.bottom = std::max(d.bottom, y);
    }
  }
  if (d.same()) d = {};
  return d;
}

std::vector<Box> difference_boxes(const Image& expected, const Image& actual, std::size_t most) {
  assert(expected.width == actual.width && expected.height == actual.height);
  struct Cell {
    int left = 0, top = 0, right = -1, bottom = -1;  // around its pixels that differ, right and bottom within
    bool any() const { return right >= left; }
    void join(const Cell& o) {
      if (!any()) *this = o;
      left = std::min(left, o.left), right = std::max(right, o.right);
      top = std::min(top, o.top), bottom = std::max(bottom, o.bottom);
    }
    Box box() const { return {left, top, right - left + 1, bottom - top + 1}; }
  };
  const int cell = std::max(8, std::max(expected.width, expected.height) / 64);
  const int columns = (expected.width + cell - 1) / cell, rows = (expected.height + cell - 1) / cell;
  std::vector<Cell> cells(std::size_t(columns) * rows);
  for (int y = 0; y < expected.height; ++y) {
    const std::uint8_t *a = expected.row(y), *b = actual.row(y);
    if (std::memcmp(a, b, std::size_t(4) * expected.width) == 0) continue;
    for (int x = 0; x < expected.width; ++x)
      if (std::memcmp(a + 4 * x, b + 4 * x, 4) != 0)
        cells[std::size_t(y / cell) * columns + x / cell].join({x, y, x, y});
  }

  // cells that touch, by a corner too, are one place
  std::vector<Box> boxes;
  Cell all;
  std::vector<std::size_t> next;
  for (std::size_t start = 0; start < cells.size(); ++start) {
    if (!cells[start].any()) continue;
    Cell place;
    next = {start};
    while (!next.empty()) {
      const std::size_t at = next.back();
      next.pop_back();
      if (!cells[at].any()) continue;
      place.join(cells[at]);
      cells[at] = {};
      const int column = int(at % columns), row = int(at / columns);
      for (int j = std::max(0, row - 1); j <= std::min(rows - 1, row + 1); ++j)
        for (int i = std::max(0, column - 1); i <= std::min(columns - 1, column + 1); ++i)
          next.push_back(std::size_t(j) * columns + i);
    }
    all.join(place);
    boxes.push_back(place.box());
  }
  if (boxes.size() > most) boxes = {all.box()};
  return boxes;
}

Image difference_picture(const Image& expected, const Image& actual) {
  Image out;
  out.width = std::max(expected.width, actual.width), out.height = std::max(expected.height, actual.height);
  out.pixels.resize(std::size_t(4) * out.width * out.height);
  const auto has = [](const Image& image, int x, int y) { return x < image.width && y < image.height; };
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      std::uint8_t* p = out.row(y) + 4 * x;
      p[3] = 255;
      if (!has(expected, x, y) || !has(actual, x, y)) {
        std::memcpy(p, kSolid, 3);
        continue;
      }
      const std::uint8_t *a = expected.row(y) + 4 * x, *b = actual.row(y) + 4 * x;
      if (std::memcmp(a, b, 4) != 0) {
        const bool one_size = expected.width == actual.width && expected.height == actual.height;
        std::memcpy(p, one_size && edge(expected, actual, x, y) ? kEdge : kSolid, 3);
      } else {
        // grey by luma, a quarter as strong
        const int grey = (54 * a[0] + 183 * a[1] + 19 * a[2]) / 256;
        p[0] = p[1] = p[2] = std::uint8_t(255 - (255 - grey) / 4);
      }
    }
  }
  return out;
}

}  // namespace obscura::media
