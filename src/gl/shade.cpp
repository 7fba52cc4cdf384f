// A convex polygon is filled row by row: the row at height y is cut by each edge from a to b that spans it at
//   x = a_x + (y - a_y) (b_x - a_x) / (b_y - a_y)
// and filled from the least of them to the greatest.

#include "gl/shade.h"

#include <algorithm>

namespace obscura::gl {
namespace {

/// The first pixel whose centre is not before x, 0 to `most`.
int first_at(float x, int most) {
  const float from = x - 0.5f;
  if (!(from > 0)) return 0;
  if (from >= float(most)) return most;
  const int whole = int(from);
  return whole + (float(whole) < from);
}

std::uint32_t ones(std::uint32_t x) {
  x -= (x >> 1) & 0x55555555u;
  x = (x & 0x33333333u) + ((x >> 2) & 0x33333333u);
  x = (x + (x >> 4)) & 0x0F0F0F0Fu;
  x += x >> 8;
  return (x + (x >> 16)) & 63u;
}

}  // namespace

Shade::Shade(int width, int height)
    : width_(width),
      height_(height),
      rays_(std::size_t(width) * height),
      dark_(rays_.size()),
      left_(std::size_t(height)),
      right_(std::size_t(height)) {}

void Shade::clear(const Damage::Rect& part) {
  for (int y = part.y; y < part.y + part.height; ++y)
    std::fill_n(rays_.begin() + std::ptrdiff_t(width_) * y + part.x, part.width, 0u);
}

void Shade::add(std::span<const draw::Point> corners, std::uint32_t rays) {
  float low = 1e9f, high = -1e9f;
  for (const draw::Point& p : corners) low = std::min(low, float(p.y())), high = std::max(high, float(p.y()));
  const int top = first_at(low, height_), bottom = first_at(high, height_);
  std::fill(left_.begin() + top, left_.begin() + bottom, 1e9f);
  std::fill(right_.begin() + top, right_.begin() + bottom, -1e9f);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const draw::Point &p = corners[i], &q = corners[i + 1 < corners.size() ? i + 1 : 0];
    const draw::Point &a = p.y() < q.y() ? p : q, &b = p.y() < q.y() ? q : p;
    const int from = first_at(float(a.y()), height_), to = first_at(float(b.y()), height_);
    if (from >= to) continue;
    const double slope = (b.x() - a.x()) / (b.y() - a.y());
    for (int y = from; y < to; ++y) {
      const auto x = float(a.x() + (y + 0.5 - a.y()) * slope);
      left_[y] = std::min(left_[y], x), right_[y] = std::max(right_[y], x);
    }
  }
  for (int y = top; y < bottom; ++y) {
    std::uint32_t* const row = rays_.data() + std::ptrdiff_t(width_) * y;
    const int end = first_at(right_[y], width_);
    for (int x = first_at(left_[y], width_); x < end; ++x) row[x] |= rays;
  }
}

void Shade::count(const Damage::Rect& part) {
  for (int y = part.y; y < part.y + part.height; ++y) {
    const std::uint32_t* const from = rays_.data() + std::ptrdiff_t(width_) * y;
    std::uint8_t* const to = dark_.data() + std::ptrdiff_t(width_) * y;
    for (int x = part.x; x < part.x + part.width; ++x) to[x] = std::uint8_t((ones(from[x]) * 255 + 16) / 32);
  }
}

}  // namespace obscura::gl
