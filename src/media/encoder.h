#pragma once

#include <string>

#include "media/libav.h"
#include "media/movie.h"

namespace obscura::media {

/// Throws media::Error where frames of this size and rate cannot be 4:2:0; `what` needs it to be so
/// ("H.264").
void check_frame(const std::string& path, const MovieSpec& spec, const std::string& what);

/// The encoder for `path`, opened: 4:2:0 (ProRes: 4:4:4 of 10 bits with alpha), tagged as `convert` converts,
/// time counted in frames, one thread. Throws media::Error where there is none, or it refuses.
CodecContext open_encoder(const std::string& path, const MovieSpec& spec);

}  // namespace obscura::media
