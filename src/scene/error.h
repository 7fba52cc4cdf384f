#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace obscura::scene {

/// One thing wrong with a scene.
struct Complaint {
  std::string file;
  int line = 0, column = 0;  // from 1; 0: the file as a whole
  std::string message;       // "mass must be positive, got -1"; with a hint where there is one

  /// "scenes/a.toml:12:8: mass must be positive, got -1"
  std::string text() const;
};

/// All that is wrong with a scene, in one go, by place.
struct Error : std::runtime_error {
  explicit Error(std::vector<Complaint> all);
  std::vector<Complaint> complaints;
};

}  // namespace obscura::scene
