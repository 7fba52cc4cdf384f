#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/document.h"
#include "scene/error.h"

namespace obscura::scene {

/// The errors of one scene, as they are found.
class Diagnostics {
 public:
  Diagnostics(std::string file, std::vector<std::string> sets)
      : file_(std::move(file)), sets_(std::move(sets)) {}

  void add(Place place, std::string message) { found_.emplace_back(place, std::move(message)); }
  bool none() const { return found_.empty(); }
  std::size_t count() const { return found_.size(); }
  /// What was found first. Requires one.
  const std::string& first() const { return found_.front().second; }
  /// Beyond so many, hints are left out.
  bool enough() const { return found_.size() > 1000; }

  /// "scenes/a.toml:12:8", "--set crate.mass=-1": for a complaint that names two places.
  std::string text(Place place) const;

  /// What is wrong at a place.
  Complaint complaint(Place place, std::string message) const;

  /// Throws Error with all of them in the order of the file, the overrides after it; the first hundred, and
  /// how many more. Requires one.
  [[noreturn]] void raise() const;

 private:
  std::string file_;
  std::vector<std::string> sets_;
  std::vector<std::pair<Place, std::string>> found_;
};

/// Replaces each control character by a space and each byte that is not UTF-8 by a question mark, so that a
/// message about a file is one line and no command to a terminal.
std::string one_line(std::string_view text);

/// "'ball'", cut where it is long: a word of the scene as a complaint quotes it.
std::string in_quotes(std::string_view word);

/// The word of `words` that was probably meant; empty where none is near.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& words);

/// "; did you mean 'mass'?", or nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& words);

}  // namespace obscura::scene
