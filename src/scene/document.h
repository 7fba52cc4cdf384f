#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scene/error.h"

namespace obscura::scene {

/// The place in a file where a piece of a scene was written.
struct Place {
  int set = 0;               // 0: the file; n: the n-th --set
  int line = 0, column = 0;  // from 1, in code points; 0: the source as a whole

  bool operator==(const Place&) const = default;
};

struct Entry;

/// A value of a scene as it was written: a tree of tables, lists and leaves, each with its place.
struct Node {
  struct Date {};  // TOML has dates and times; the language has none
  using List = std::vector<Node>;
  using Table = std::vector<Entry>;

  Place place;
  std::variant<std::int64_t, double, bool, std::string, Date, List, Table> value;
  int inside = 0;       // of a string in one pair of quotes: columns from its place to its text; 0: not told
  bool header = false;  // a table under a [header] of its own, or a list of such

  bool is_table() const { return std::holds_alternative<Table>(value); }
  bool is_list() const { return std::holds_alternative<List>(value); }
  bool is_text() const { return std::holds_alternative<std::string>(value); }
  bool is_integer() const { return std::holds_alternative<std::int64_t>(value); }
  bool is_number() const { return is_integer() || std::holds_alternative<double>(value); }

  const Table& table() const { return std::get<Table>(value); }
  Table& table() { return std::get<Table>(value); }
  const List& list() const { return std::get<List>(value); }
  List& list() { return std::get<List>(value); }
  const std::string& text() const { return std::get<std::string>(value); }

  /// The number, whether it was written 2 or 2.0. Requires is_number().
  double number() const;

  /// The value under a key of this table; none where it has no such key, or is no table.
  const Node* find(std::string_view key) const;
  Node* find(std::string_view key);
};

struct Entry {
  std::string key;
  Place place;  // of the key
  Node node;
};

/// Its name in an error message: "a string", "a list", "-1", "true".
std::string described(const Node& node);

/// Reads TOML into a tree, in the order of the file. Throws Error where the text is too long or too deep, has
/// bytes that are not UTF-8, or is not TOML: one complaint, for past it nothing can be trusted.
Node document(std::string_view text, const std::string& file);

/// The bytes of a file, or of standard input for "-". Throws Error where there is none, it is a folder, or is
/// too long.
std::string contents(const std::string& file);

}  // namespace obscura::scene
