#pragma once

#include <cstdint>

#include "media/image.h"
#include "media/movie.h"

namespace obscura::media {

enum class PipeFormat { y4m, rgba };

/// Streams frames to a file descriptor: yuv4mpeg2 4:2:0 with a frame rate, or raw RGBA. Not thread-safe.
class PipeWriter {
 public:
  PipeWriter(int descriptor, PipeFormat format, const MovieSpec& spec);

  /// False when the reader has closed the pipe: end quietly (SIGPIPE must be ignored by then). Throws
  /// media::Error on any other failure.
  bool write(const Image& frame);

 private:
  int descriptor_;
  PipeFormat format_;
  MovieSpec spec_;
  bool begun_ = false;
  std::vector<std::uint8_t> planes_;
};

}  // namespace obscura::media
