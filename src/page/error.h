#pragma once

#include <stdexcept>

namespace obscura::page {

/// A page that cannot be written: a font, a library that this build lacks.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace obscura::page
