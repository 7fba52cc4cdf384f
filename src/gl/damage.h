#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "media/image.h"

namespace obscura::gl {

/// A part of the picture, px; empty where high is not beyond low.
struct Bounds {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

inline Bounds operator&(const Bounds& a, const Bounds& b) {
  return {a.x0 > b.x0 ? a.x0 : b.x0, a.y0 > b.y0 ? a.y0 : b.y0, a.x1 < b.x1 ? a.x1 : b.x1,
          a.y1 < b.y1 ? a.y1 : b.y1};
}

/// False for what is not a number, too.
inline bool any(const Bounds& b) { return b.x0 < b.x1 && b.y0 < b.y1; }

/// Which tiles of a picture were drawn on.
class Damage {
 public:
  static constexpr int kTile = 32;  // px
  using Rect = media::Rect;
  struct Corner {
    float x = 0, y = 0;  // px
  };

  Damage(int width, int height);

  void clear();
  /// `b` lies within the picture.
  void mark(const Bounds& b);
  /// Every tile that a convex polygon meets within `b`.
  void mark(std::span<const Corner> polygon, const Bounds& b);
  /// The marked tiles as rectangles without overlap, row by row, tall where rows are alike.
  const std::vector<Rect>& rects();
  /// The same in fewer: gaps of a few tiles in a row belong to them.
  const std::vector<Rect>& bands();
  /// Marks all that `other` marks; the sizes must be equal.
  void add(const Damage& other);
  /// Marked tiles over all.
  double share() const;

 private:
  int width_, height_, columns_, rows_;
  std::vector<std::uint8_t> tiles_;
  std::vector<Rect> rects_;

  const std::vector<Rect>& runs(int gap);
};

}  // namespace obscura::gl
