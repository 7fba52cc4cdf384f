#pragma once

#include <stdexcept>

namespace obscura::gl {

/// No context, a picture beyond its limits, a shader that does not compile.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace obscura::gl
