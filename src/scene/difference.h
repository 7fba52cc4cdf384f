#pragma once

#include <string>
#include <vector>

namespace obscura::scene {

/// One key that two scenes say differently.
struct KeyDifference {
  std::string path;  // as --set names it: "crate.mass"
  std::string a, b;  // the values as TOML; empty where left out
};

/// The text of a scene and what --set puts over it.
struct Source {
  std::string text;
  std::vector<std::string> sets;
};

/// The keys in which two scenes differ, in the order of a's file; things are matched by name, or else by
/// place. None: they differ in comments and layout alone. Throws Error where one is not TOML.
std::vector<KeyDifference> differences(const Source& a, const Source& b);

}  // namespace obscura::scene
