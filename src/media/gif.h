#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "media/file.h"
#include "media/image.h"
#include "media/movie.h"
#include "media/part.h"

namespace obscura::media {

/// Throws media::Error where no GIF of this spec can be.
void check_gif(const std::string& path, const MovieSpec& spec);

/// A segment of a GIF: a palette for its frames (the extradata, 255 colours and one that means "as before"),
/// and for each packet the rectangle that changed and its indices, compressed. Quality and preset have no
/// say.
class GifEncoder {
 public:
  GifEncoder(const std::string& path, const MovieSpec& spec);
  void add(const Image& frame);
  Segment finish();

 private:
  int width_, height_;
  // frames wait, deflated, until all colours of the segment are known
  std::vector<std::vector<std::uint8_t>> waiting_;
  std::unordered_map<std::uint32_t, std::uint32_t> counts_;  // 0xRRGGBB -> pixels
};

/// Joins segments into a GIF that repeats for ever. Delays are hundredths of a second, each frame's end
/// rounded, so that the sum never drifts.
class GifWriter {
 public:
  GifWriter(const std::string& path, const MovieSpec& spec);
  void add(const Segment& segment);
  void close(const std::string& instead);
  std::int64_t frames() const { return frames_; }

 private:
  MovieSpec spec_;
  File file_;
  std::vector<std::uint8_t> palette_;  // of the first segment: the file's own
  std::int64_t frames_ = 0;
};

/// Reads a GIF of one segment by GifWriter. Throws Error if it is not one, or is incomplete.
Part gif_part(const std::string& path, std::span<const std::uint8_t> bytes);

}  // namespace obscura::media
