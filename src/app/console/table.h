#pragma once

#include <string>
#include <vector>

namespace obscura::app {

/// A row of --help: an option, or what stands at a place.
struct OptionRow {
  std::vector<std::string> names;  // "-o", "--output"; none of what stands at a place
  std::string value;               // the placeholder of its value, as in OUT; empty of a flag
  std::string about;
  std::vector<std::string> words;  // its values, where they are words
  std::string range;               // "1 to 63", where it has one
  bool required = false;
  bool repeated = false;

  /// Whether it stands at a place, without a name.
  bool positional() const { return names.empty(); }
};

/// What --help of a command is made of, and of the program itself.
struct CommandTable {
  std::string name;
  std::string about;
  std::string footer;
  std::vector<OptionRow> options;

  bool operator==(const std::string& other) const { return name == other; }
};

/// The program first, under the name obscura, then each command in the order of --help.
using CommandTables = std::vector<CommandTable>;

}  // namespace obscura::app
