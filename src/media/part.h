#pragma once

#include <string>

#include "media/movie.h"

namespace obscura::media {

// A part is a segment in a file of its own: a movie that plays, and that gives the segment back, so that a
// film that was made in pieces, at several times or in several places, is joined of them by stream copy.

/// The ending of the names of a movie's parts: "mp4", for a GIF "gif"; the movie's own with alpha and of
/// ProRes.
std::string part_ending(const std::string& movie, const MovieSpec& spec = {});

/// Writes a segment as a part; `spec` is the movie's, with the part's own tags. Throws media::Error.
void write_part(const std::string& path, const MovieSpec& spec, const Segment& segment);

/// The content of a part.
struct Part {
  Segment segment;
  Tags tags;
};

/// Reads a part. The segment is not byte for byte that which was written, for containers have their own way
/// of laying out a codec's packets: a movie is joined of segments that all come from parts, or all do not.
/// Throws media::Error where the file is no whole part.
Part read_part(const std::string& path);

/// Its tags alone: reads no packet of a movie's part. Throws media::Error as well.
Tags part_tags(const std::string& path);

}  // namespace obscura::media
