#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "media/image.h"
#include "media/movie.h"

namespace obscura::media {

enum class PipeFormat { y4m, rgba };

/// Makes the bytes of frames as a pipe has them: planes of 4:2:0, or RGBA. Not thread-safe; each thread that
/// draws has one.
class PipeFrames {
 public:
  /// Throws media::Error where frames of this size cannot be made.
  PipeFrames(PipeFormat format, const MovieSpec& spec);

  /// A frame's bytes, which take the place of `bytes`. `changed`: where alone it differs from the frame
  /// before, in rectangles whose places and sizes are even; null: anywhere.
  void make(const Image& frame, const std::vector<Rect>* changed, std::vector<std::uint8_t>& bytes);

 private:
  PipeFormat format_;
  int width_, height_;
  std::vector<std::uint8_t> planes_;  // of the last frame
};

/// Streams frames to a file descriptor: yuv4mpeg2 4:2:0 with a frame rate, or raw RGBA. Not thread-safe.
class PipeWriter {
 public:
  PipeWriter(int descriptor, PipeFormat format, const MovieSpec& spec);

  /// The bytes of a frame, by PipeFrames. False when the reader has closed the pipe: end quietly (SIGPIPE
  /// must be ignored by then). Throws media::Error on any other failure.
  bool write(std::span<const std::uint8_t> frame);

 private:
  int descriptor_;
  PipeFormat format_;
  MovieSpec spec_;
  bool begun_ = false;
};

}  // namespace obscura::media
