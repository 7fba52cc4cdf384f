#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "media/image.h"

namespace obscura::media {

/// The differences of two pictures of one size. The largest counts first: a single measure of likeness would
/// rate a lost pixel better than a level of noise everywhere.
struct Difference {
  std::int64_t pixels = 0;  // that differ in any channel
  std::int64_t beyond = 0;  // of them: by more than the level asked for
  std::int64_t solid = 0;   // of them: more than an edge moved by less than a pixel makes
  int largest = 0;          // difference of a channel, levels of 255
  bool alpha_only = false;  // only in alpha
  int left = 0, top = 0, right = 0, bottom = 0;  // the smallest box around them, right and bottom within
  int x = 0, y = 0;                              // the pixel of the largest difference, the first of several

  bool same() const { return pixels == 0; }
};

/// Compares pixel by pixel, alpha too; `beyond` counts differences larger than `level`. Requires one size.
Difference difference(const Image& expected, const Image& actual, int level = 0);

/// A rectangle of pixels.
struct Box {
  int left = 0, top = 0, width = 0, height = 0;
  bool operator==(const Box&) const = default;
};

/// Boxes around what differs, one for each place where it does: pixels less than eight apart, in large
/// pictures than a 64th of their longer side, are of one place. More than `most` are one box around all.
/// Requires one size.
std::vector<Box> difference_boxes(const Image& expected, const Image& actual, std::size_t most);

/// The differences on the paled expected picture: solid ones in vermilion, those of edges in blue.
/// Pictures of two sizes: as large as either, what only one of them has in vermilion.
Image difference_picture(const Image& expected, const Image& actual);

}  // namespace obscura::media
