#pragma once

#include <string>
#include <vector>

#include "app/console/progress.h"
#include "gl/context.h"
#include "scene/scene.h"
#include "sim/math/rational.h"

namespace obscura::app {

/// A run that is shown beside others.
struct Tile {
  scene::Scene scene;
  std::string words;  // over it
};

/// The places of `n` equal tiles in a picture, row by row, each under a line of words: as large as they can
/// be. Above them is a strip for the title and the clock.
struct Mosaic {
  int columns = 0, rows = 0;
  int width = 0, height = 0;  // of a tile, px
  int words = 0, gap = 0;     // height of its line, between tiles, px
  int head = 0;               // height of the strip

  /// Throws UsageError where the picture has no room for so many.
  Mosaic(int n, int picture_width, int picture_height, int head = 0);

  int left(int i) const { return gap + i % columns * (width + gap); }
  int top(int i) const { return head + gap + i / columns * (words + height + gap) + words; }
};

/// How high the strip for title and clock of a scene's film is, px; 0: the scene shows neither.
int mosaic_head(const scene::Scene& scene);

struct MosaicOptions {
  int workers = 0;  // 0: one a core
  ProgressKind progress = ProgressKind::automatic;
  gl::ContextOptions context;
};

/// All runs at one instant as a PNG, as large as the first one's film.
int mosaic_still(std::vector<Tile> tiles, sim::Rational at, const std::string& out,
                 const MosaicOptions& options);

/// All runs as one movie, as long as the first one's. A run that cannot go on stands still. Returns the exit
/// code: kDiverged where one could not.
int mosaic_movie(std::vector<Tile> tiles, const std::string& out, const MosaicOptions& options);

}  // namespace obscura::app
