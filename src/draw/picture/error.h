#pragma once

#include <stdexcept>

namespace obscura::draw {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace obscura::draw
