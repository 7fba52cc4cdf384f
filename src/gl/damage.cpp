#include "gl/damage.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace obscura::gl {

namespace {

constexpr float kHair = 1.0f / 64;  // px
constexpr int kGap = 3;             // tiles: cheaper to copy than to begin again

}  // namespace

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

void Damage::mark(std::span<const Corner> polygon, const Bounds& b) {
  const int r0 = int(b.y0) / kTile, r1 = std::min(int(b.y1) / kTile, rows_ - 1);
  for (int r = r0; r <= r1; ++r) {
    // the part of the polygon in this row of tiles, from its edges there
    const float top = float(r * kTile), bottom = float((r + 1) * kTile);
    float low = b.x1, high = b.x0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      Corner p = polygon[i], q = polygon[(i + 1) % polygon.size()];
      if (p.y > q.y) std::swap(p, q);
      if (!(p.y <= bottom && q.y >= top)) continue;
      const float slope = q.y > p.y ? (q.x - p.x) / (q.y - p.y) : 0;
      const float x0 = p.y < top ? p.x + (top - p.y) * slope : p.x,
                  x1 = q.y > bottom ? p.x + (bottom - p.y) * slope : q.x;
      low = std::min({low, x0, x1}), high = std::max({high, x0, x1});
    }
    // a hair for the rounding of slopes
    low = std::max(low - kHair, b.x0), high = std::min(high + kHair, b.x1);
    if (low > high) continue;
    const int c0 = int(low) / kTile, c1 = std::min(int(high) / kTile, columns_ - 1);
    std::memset(&tiles_[std::size_t(columns_) * r + c0], 1, std::size_t(c1 - c0 + 1));
  }
}

const std::vector<Damage::Rect>& Damage::rects() { return runs(0); }

const std::vector<Damage::Rect>& Damage::bands() { return runs(kGap); }

// rows of tiles that are alike, in runs without holes of more than `gap` tiles
const std::vector<Damage::Rect>& Damage::runs(int gap) {
  rects_.clear();
  for (int r = 0; r < rows_;) {
    const std::uint8_t* row = &tiles_[std::size_t(columns_) * r];
    int below = r + 1;
    while (below < rows_ && !std::memcmp(row, &tiles_[std::size_t(columns_) * below], std::size_t(columns_)))
      ++below;
    const int y = r * kTile, height = std::min(below * kTile, height_) - y;
    for (int c = 0; c < columns_; ++c) {
      if (!row[c]) continue;
      int end = c + 1;  // of the run
      for (int next = end; next < columns_ && next - end <= gap; ++next)
        if (row[next]) end = next + 1;
      rects_.push_back({c * kTile, y, std::min(end * kTile, width_) - c * kTile, height});
      c = end;
    }
    r = below;
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
