#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "media/yuv.h"

namespace obscura::media {

/// What a movie file is to be. The container follows from the path's ending: mp4 mkv mov webm gif.
struct MovieSpec {
  int width = 0, height = 0;
  std::int64_t fps_num = 60, fps_den = 1;
  std::string codec{};          // libav's name of an encoder; empty: the container's default (h264, vp9, gif)
  std::optional<double> crf{};  // none: 18 for H.264, its like for others
  std::string preset{};         // x264's; empty: our default, see docs
  Tags tags{};
};

/// Throws media::Error where this file could not be made here: no such container, codec, preset; odd sizes
/// (the message names the nearest even size). Called before anything is simulated. Opens an encoder, writes
/// nothing.
void check(const std::string& path, const MovieSpec& spec);

/// The codec that `check` accepted, as libav names it, for messages.
std::string codec_name(const std::string& path, const MovieSpec& spec);

/// How many frames a closed segment holds: those of one second.
int segment_frames(const MovieSpec& spec);

/// An encoded segment: closed, decodable alone, its frames numbered from 0.
struct Segment {
  struct Packet {
    std::vector<std::uint8_t> bytes;
    std::int64_t pts = 0, dts = 0, duration = 1;  // in frames
    bool key = false;
  };
  std::vector<Packet> packets;
  std::vector<std::uint8_t> extradata;  // the codec's header, equal for all segments of a spec
  int frames = 0;
};

/// Encodes one segment with one thread: its bytes depend on its frames and the spec alone.
class SegmentEncoder {
 public:
  SegmentEncoder(const std::string& path, const MovieSpec& spec);
  ~SegmentEncoder();
  SegmentEncoder(SegmentEncoder&&) noexcept;

  /// Adds a frame of the spec's size. Throws media::Error.
  void add(const Image& frame);
  /// The whole segment; the encoder is spent.
  Segment finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Joins segments by stream copy into a movie under a temporary name beside `path`; close() renames it into
/// place. Destroyed before close(), it removes what it wrote.
class MovieWriter {
 public:
  MovieWriter(const std::string& path, const MovieSpec& spec);
  ~MovieWriter();
  MovieWriter(MovieWriter&&) noexcept;

  void add(const Segment& segment);
  /// Finishes the file, checks that every byte was written, and renames it to `path`, or to `instead` where
  /// given (a partial movie). Throws media::Error.
  void close(const std::optional<std::string>& instead = {});
  std::int64_t frames() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// "libavcodec 59.37.100 (GPL version 3 or later), libx264 present".
std::string libraries();

}  // namespace obscura::media
