#pragma once

#include <stdexcept>

namespace obscura::media {

/// A file that cannot be read or written, a codec that is missing or fails. The message names the path.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace obscura::media
