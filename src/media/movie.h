#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"
#include "media/yuv.h"

namespace obscura::media {

/// Words of a movie's text track, s from its start.
struct TextCue {
  double begin = 0, end = 0;
  std::string text;
};

/// A chapter of a movie reaches to the next, or to the movie's end.
struct Chapter {
  double begin = 0, end = 0;  // s
  std::string title;
};

/// Settings of a movie file. The container follows from the path's ending: mp4 mkv mov webm gif.
struct MovieSpec {
  int width = 0, height = 0;
  std::int64_t fps_num = 60, fps_den = 1;
  std::string codec{};  // libav's name of an encoder, or h264 hevc vp9; empty: the container's default
  std::optional<double> crf{};  // none: 18 for H.264 and HEVC, 24 for VP9
  std::string preset{};  // x264's or x265's; empty: quick settings that reach `medium`'s likeness (codec.cpp)
  Tags tags{};           // "Title" is the movie's title too
  bool alpha = false;    // with transparency: VP9 in webm, ProRes 4444 in mov
  std::vector<TextCue> captions{};  // one after another; a GIF has none
  std::vector<Chapter> chapters{};  // the same
};

/// Throws media::Error where this file could not be made here: no such container, codec, preset; odd sizes
/// (the message names the nearest even size); a GIF of more than 50 frames a second. Called before anything
/// is simulated. Opens an encoder, writes nothing. A name that ends in .y4m stands for a pipe of that form.
void check(const std::string& path, const MovieSpec& spec);

/// The codec that `check` accepted, as libav names it, for messages.
std::string codec_name(const std::string& path, const MovieSpec& spec);

/// How many frames a closed segment holds: those of one second.
int segment_frames(const MovieSpec& spec);

/// An encoded segment: closed, decodable alone, its frames numbered from 0. (Of a GIF: changed rectangles.)
struct Segment {
  struct Packet {
    std::vector<std::uint8_t> bytes;
    std::int64_t pts = 0, dts = 0, duration = 1;  // in frames
    bool key = false;
    std::vector<std::uint8_t> beside{};  // what a container keeps beside the bytes: the alpha of VP9
  };
  std::vector<Packet> packets;
  std::vector<std::uint8_t> extradata;  // the codec's header, the same for a whole movie; a GIF's palette
  int frames = 0;
};

/// Encodes one segment with one thread: its bytes depend on its frames and the spec alone.
class SegmentEncoder {
 public:
  SegmentEncoder(const std::string& path, const MovieSpec& spec);
  ~SegmentEncoder();
  SegmentEncoder(SegmentEncoder&&) noexcept;

  /// Adds a frame of the spec's size. `changed`: where alone it differs from the frame before, in rectangles
  /// of even places and sizes; the bytes are the same without. Throws media::Error.
  void add(const Image& frame, const std::vector<Rect>* changed = nullptr);
  /// The whole segment; the encoder is spent.
  Segment finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Joins segments, in order, by stream copy into a movie under a temporary name beside `path`; close()
/// renames it into place. Destroyed before close(), it removes what it wrote. Frame n begins at n / fps,
/// which mp4 and mov say exactly, mkv and webm to the millisecond, gif to the hundredth.
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

/// The libraries in use, a line each: "libavcodec 59.37.100 (GPL version 2 or later), encoders: libx264,
/// libvpx-vp9", "libpng 1.6.39".
std::string libraries();

}  // namespace obscura::media
