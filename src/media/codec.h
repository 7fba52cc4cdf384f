#pragma once

#include <functional>
#include <string>
#include <vector>

#include "media/movie.h"

namespace obscura::media {

/// A kind of movie file, by the ending of its name.
struct Container {
  std::string ending;                 // "mp4"
  std::string muxer;                  // libav's name; gif and y4m are written by ourselves
  std::vector<std::string> encoders;  // the first that libav has is taken
  std::vector<std::string> others;    // taken where the spec asks for them
  std::string video;                  // what `encoders` make, for messages: "H.264"
};

/// The container of `path`. Throws media::Error naming the endings there are.
const Container& container(const std::string& path);

/// The encoder for `path`: the spec's, by libav's name or by its family (h264, hevc, vp9), or the
/// container's first. `present` says which names libav has. Throws media::Error saying what to do instead.
std::string encoder_name(const std::string& path, const MovieSpec& spec,
                         const std::function<bool(const std::string&)>& present);

/// The options an encoder is opened with, in libav's words, beyond size, colour and time; those of x264 as
/// its own parameters. Throws media::Error where the encoder has no such preset or quality.
std::vector<std::pair<std::string, std::string>> encoder_options(const std::string& path,
                                                                 const MovieSpec& spec,
                                                                 const std::string& encoder);

}  // namespace obscura::media
