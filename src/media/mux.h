#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "media/file.h"
#include "media/libav.h"
#include "media/movie.h"

namespace obscura::media {

/// Joins segments into a file by one of libav's muxers, by stream copy: packets keep their bytes, their times
/// are moved on by the frames before.
class Muxer {
 public:
  Muxer(const std::string& path, const MovieSpec& spec);
  Muxer(const Muxer&) = delete;
  Muxer& operator=(const Muxer&) = delete;

  void add(const Segment& segment);
  void close(const std::string& instead);
  std::int64_t frames() const { return frames_; }

 private:
  // drops what is not written yet
  struct Close {
    void operator()(AVFormatContext* format) const;
  };
  void begin(const std::vector<std::uint8_t>& extradata);
  void add_text_track(const std::string& muxer);
  void add_chapters();
  void write_captions(double until);
  static int on_write(void* self, const std::uint8_t* bytes, int size);
  static std::int64_t on_seek(void* self, std::int64_t offset, int whence);
  /// Throws where libav or the disk refused.
  void require(int code, const char* doing) const;

  std::string path_;
  MovieSpec spec_;
  File file_;
  int failure_ = 0;  // errno of the first write that failed
  std::unique_ptr<AVFormatContext, Close> format_;
  AVStream *stream_ = nullptr, *text_ = nullptr;
  std::size_t said_ = 0;  // captions written
  Packet packet_;
  bool begun_ = false;  // its header is written
  std::int64_t frames_ = 0, last_dts_;
};

}  // namespace obscura::media
