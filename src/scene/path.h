#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace obscura::scene {

/// One step of a path: "ball[3]" is a name and an index.
struct Step {
  std::string name;
  std::vector<std::int64_t> indices;
};

/// Reads "ball[3].position.y"; nothing where it is no path.
std::optional<std::vector<Step>> path(std::string_view text);

/// A name with a list of those meant: "ball", "ball[3]", "ball[0..4]", "ball[*]". Without brackets `which` is
/// empty.
struct Reference {
  std::string name;
  std::string which;
  bool bracketed = false;
};

/// Reads a reference; empty if the text is none. `range` reads the text in the brackets.
std::optional<Reference> reference(std::string_view text);

/// The whole numbers of "0..4", "0,5", "1,3,5..9" or "*" out of 0 .. n-1, in the order written. Nothing where
/// it is no such list, or where one is not below n.
std::optional<std::vector<int>> range(std::string_view text, int n);

}  // namespace obscura::scene
