#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scene/complaints.h"
#include "scene/scene.h"

namespace obscura::app {

/// A key of the scene and the values that it takes in turn, as "crate.elasticity=0,0.5,1" says it, or with
/// ranges, both ends counted: "0:1:0.1", "seed=1:100".
struct Variation {
  /// Throws UsageError where it cannot be read.
  explicit Variation(std::string_view text);

  std::string path;                 // "crate.elasticity"
  std::vector<std::string> values;  // as --set takes them

  /// The key alone: "elasticity", "velocity.y".
  std::string name() const;
  /// The same as mathematics, for an axis: the quantity's letter, `whose` with the name of what has it, or
  /// words.
  std::string symbol(bool whose = true) const;
  /// For a person: "elasticity = 0.1", `whose` with the name of what has it, "crate.elasticity = 0.1"; of a
  /// key whose values are words the word alone, as "Euler".
  std::string words(const std::string& value, bool whose = false) const;
  /// A value for a person: "Euler" for euler, a space for an underscore.
  static std::string spoken(const std::string& value);
  /// A number of many digits rounded, any other value as it is.
  static std::string shown(const std::string& value);
  /// A value that is a number or a fraction. Throws UsageError where it is none.
  double number(const std::string& value) const;
};

/// Runs that differ in the values of keys: all combinations, the last key's values changing fastest.
struct Variations {
  static constexpr std::int64_t kMostRuns = 1'000'000'000;

  /// Throws UsageError where one cannot be read, or is of the same key as another.
  explicit Variations(const std::vector<std::string>& texts);

  std::vector<Variation> keys;
  std::int64_t size = 1;  // how many runs

  /// The values of run `run`, from 0, one a key.
  std::vector<std::string> operator[](std::int64_t run) const;
  /// The same as --set takes them, after others. Throws UsageError where one of those sets what is varied.
  std::vector<std::string> sets(std::int64_t run, std::vector<std::string> sets) const;
  /// Whether no other key has the same name.
  bool alone(const Variation& key) const;
  /// The same for a person: "elasticity = 0.1, seed = 3".
  std::string words(std::int64_t run) const;
  /// The same as mathematics: "e = 0.1", "\"Euler\"".
  std::string formula(std::int64_t run) const;
};

/// Whether a complaint is of a key's value, which it names "--set ball.mass=1", long ones cut.
bool is_of(const scene::Complaint& it, const std::string& set);

/// What is said besides where a value is refused, "ball.mass=1..5", that looks as if it were a range.
std::string of_range(const std::string& set);

/// The same complaints; those of these values name --vary.
scene::Error of_vary(const scene::Error& error, const std::vector<std::string>& values);

/// A run's scene by what reads one with these changes of keys. What is wrong with a value that varies is told
/// as of --vary. Throws scene::Error.
template <class Read>
scene::Scene varied_by_flag(const Variations& all, std::int64_t run, const std::vector<std::string>& sets,
                            const Read& read) {
  try {
    return read(all.sets(run, sets));
  } catch (const scene::Error& error) {
    throw of_vary(error, all.sets(run, {}));
  }
}

}  // namespace obscura::app
