#include "gl/damage.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace obscura::gl {

Damage::Damage(int width, int height)
    : width_(width),
      height_(height),
      columns_((width + kTile - 1) / kTile),
      rows_((height + kTile - 1) / kTile),
      tiles_(std::size_t(columns_) * rows_) {}

void Damage::clear() { std::fill(tiles_.begin(), tiles_.end(), std::uint8_t(0)); }

void Damage::mark(const Bounds& b) {
  const int c0 = int(b.x0) / kTile, c1 = std::min(int(b.x1) / kTile, columns_ - 1);
  const int r0 = int(b.y0) / kTile, r1 = std::min(int(b.y1) / kTile, rows_ - 1);
  for (int r = r0; r <= r1; ++r)
    std::memset(&tiles_[std::size_t(columns_) * r + c0], 1, std::size_t(c1 - c0 + 1));
}

const std::vector<Damage::Rect>& Damage::rects() {
  rects_.clear();
  for (int r = 0; r < rows_;) {
    const std::uint8_t* row = &tiles_[std::size_t(columns_) * r];
    int below = r + 1;
    while (below < rows_ && !std::memcmp(row, &tiles_[std::size_t(columns_) * below], std::size_t(columns_)))
      ++below;
    const int y = r * kTile, height = std::min(below * kTile, height_) - y;
    for (int c = 0; c < columns_; ++c) {
      if (!row[c]) continue;
      const int begin = c;
      while (c < columns_ && row[c]) ++c;
      const int x = begin * kTile;
      rects_.push_back({x, y, std::min(c * kTile, width_) - x, height});
    }
    r = below;
  }
  return rects_;
}

const std::vector<Damage::Rect>& Damage::bands() {
  rects_.clear();
  for (int r = 0; r < rows_; ++r) {
    const auto row = tiles_.begin() + std::ptrdiff_t(columns_) * r, end = row + columns_;
    const auto first = std::find(row, end, std::uint8_t(1));
    if (first == end) continue;
    auto last = end;
    while (!last[-1]) --last;
    const int x = int(first - row) * kTile, y = r * kTile;
    const int width = std::min(int(last - row) * kTile, width_) - x, height = std::min(kTile, height_ - y);
    if (!rects_.empty() && rects_.back().x == x && rects_.back().width == width &&
        rects_.back().y + rects_.back().height == y) {
      rects_.back().height += height;
    } else {
      rects_.push_back({x, y, width, height});
    }
  }
  return rects_;
}

void Damage::add(const Damage& other) {
  for (std::size_t i = 0; i < tiles_.size(); ++i) tiles_[i] |= other.tiles_[i];
}

double Damage::share() const {
  return double(std::count(tiles_.begin(), tiles_.end(), std::uint8_t(1))) / double(tiles_.size());
}

}  // namespace obscura::gl
