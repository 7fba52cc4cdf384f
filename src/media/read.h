#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "media/image.h"

namespace obscura::media {

/// The metadata of a movie file.
struct MovieFacts {
  int width = 0, height = 0;
  std::int64_t fps_num = 0, fps_den = 1;
  std::int64_t frames = 0;  // 0: the file does not say
  double tick = 0;          // s, to which times of frames are rounded
  std::string codec;        // "h264"
  Tags tags;                // those of the comment, and the title as "Title"
};

/// Hands out the frames of a movie in order, as RGBA8 with values 0 to 255, converted by the matrix and range
/// the file is tagged with (bt709, limited, where it is silent), and with the alpha that it carries.
class MovieReader {
 public:
  /// Throws media::Error naming the path where it is no movie.
  explicit MovieReader(const std::string& path);
  ~MovieReader();
  MovieReader(MovieReader&&) noexcept;

  const MovieFacts& facts() const;
  /// The next frame. False after the last. Throws media::Error where the file is damaged.
  bool next(Image& frame);
  /// When the last frame begins, in seconds.
  double time() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace obscura::media
