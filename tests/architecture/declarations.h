#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace obscura::architecture {

/// A word, number or sign of C++, and its line.
struct Token {
  std::string text;
  int line;
};
using Tokens = std::vector<Token>;

bool begins_word(char c);

/// The tokens of a file's text; a literal is "" whatever it holds; no comments, no lines of the preprocessor.
Tokens tokens_of(const std::string& text);

enum class Kind { function, alias, other };

/// A name at the level of namespaces.
struct Defined {
  Kind kind;
  std::string scope;  // the namespaces it is in, "obscura::sim::"
  std::string name;
  std::string type;  // of a function its parameters' types, of an alias what it stands for
  int line;
  bool unnamed;  // in an unnamed namespace, or static
};

/// The functions, types and variables that tokens declare at the level of namespaces, but for types without a
/// body.
std::vector<Defined> names_of(Tokens tokens);

std::string contents(const std::filesystem::path& file);

/// The headers that a file includes, and those that they include, as far as they lie beside it or
/// under one of `roots`.
std::set<std::filesystem::path> headers_of(const std::filesystem::path& file,
                                           const std::vector<std::filesystem::path>& roots);

}  // namespace obscura::architecture
