#pragma once

#include <string>

namespace obscura::scene {

/// The things of a model that one table makes, under the table's name: from one number to before another.
struct NameRange {
  std::string name;
  int first = 0, end = 0;
};

}  // namespace obscura::scene
