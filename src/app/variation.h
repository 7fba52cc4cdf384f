#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace obscura::app {

/// A key of the scene and the values that it takes in turn, as "crate.elasticity=0,0.5,1" says it.
struct Variation {
  /// Throws UsageError where it cannot be read.
  explicit Variation(std::string_view text);

  std::string path;                 // "crate.elasticity"
  std::vector<std::string> values;  // as --set takes them

  /// The key alone: "elasticity".
  std::string name() const;
  /// A value that is a number or a fraction. Throws UsageError where it is none.
  double number(const std::string& value) const;
};

}  // namespace obscura::app
