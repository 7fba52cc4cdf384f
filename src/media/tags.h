#pragma once

#include <string>

#include "media/image.h"

namespace obscura::media {

/// Tags as one JSON object, for a movie's comment. A tag that is JSON itself stands as such.
std::string comment(const Tags& tags);

/// The tags in such a comment; any other comment is the tag "Comment".
Tags tags_of_comment(const std::string& text);

}  // namespace obscura::media
