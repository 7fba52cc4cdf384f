#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/document.h"

namespace obscura::scene {

/// The type of a key's value.
enum class Form {
  table,   // [room]
  tables,  // [[box]]
  number,
  integer,
  boolean,
  text,
  name,      // of a thing: letters, digits, _ and -
  label,     // words to be shown that become part of a path too (scene/utf8.h)
  rational,  // a number, or "30000/1001": where time is exact
  choice,
  choices,  // one word, a list of words
  color,
  vector,       // [x, y], in space [x, y, z]
  spin,         // a number in the plane, [x, y, z] in space
  turn,         // in space: [x, y, z] or { axis, angle }
  pixels,       // [width, height], whole
  count,        // 12, or [6, 2]
  offset,       // a vector, or one a direction of the grid
  which,        // true, or "0..4": all, or those of the copies
  points,       // [[x, y], ...], three at least; in space four
  pairs,        // [["a", "b"], ...], names
  limits,       // [lowest, highest]
  ends,         // the two ends of a spring
  places,       // ends of springs, one at least
  couple,       // two names
  thing,        // the name of a body
  things,       // references to bodies
  path,         // [[t, x, y], ...]
  curve,        // places, arcs and splines
  walls,        // "ground", "none", or tables
  cameras,      // [camera], in space [[camera]] too
  speeds,       // a speed, or keys of it
  place,        // one end of a spring: a body, a point of one, a place
  times,        // an exact time, or a list of them
  cue,          // seconds of the run, or { time, after }
  trails,       // seconds, or a table of them by body
  states,       // true, false, or the file of another program's run
  bodies,       // references to bodies, or one
  expression,   // an expression, or a number
  expressions,  // one a dimension
  torque,       // one expression, in space three
  numbers,      // [constants]: any names
  any,          // the value of another key
  moment,       // an exact time, or the name of a mark
};

struct Range {
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  bool above = false;  // low itself is out

  bool has(double x) const { return (above ? x > low : x >= low) && x <= high; }
};

/// One key of the language: all that its check, its line in the schema and its line on the page of keys are
/// made of.
struct Key {
  std::string path{};  // "room.size", "box.copies.count"
  Form form = Form::number;
  std::string unit{};      // "m", "kg", "deg"; empty: none
  std::string fallback{};  // the default, as TOML; empty: see `absent`
  std::string absent{};    // the default, in words, where it is no constant
  Range range{};
  std::string in_space{};  // the default there, where it is not that of the plane and zeros
  int dimension = 0;       // 2, 3: of the plane, of space only
  std::string instead{};   // what says it in the other
  bool varies = false;     // over copies: { from, to } or a list as well
  bool required = false;
  std::vector<std::string> choices{}, later{};  // words of today, words that a later version will have
  std::string doc{};                            // one line
  std::string example{};                        // as TOML

  std::string_view last() const { return std::string_view(path).substr(path.rfind('.') + 1); }
  std::string_view owner() const {
    return path.rfind('.') == std::string::npos ? std::string_view()
                                                : std::string_view(path).substr(0, path.rfind('.'));
  }
};

/// The rows of the language as they are written, of the run and of its pictures; those of any.* stand for
/// every kind of body, those of rigid.* for the kinds that turn, those of handout.* for those that the
/// handout's collisions know, and `own` for the keys of the form of each kind (scene/body_kinds.h); those of
/// mark.* are the marks of figures and films, which stand where figure.marks and film.marks do.
std::vector<Key> world_rows();
std::vector<Key> picture_rows();

/// The language: every key, in the order of the page.
std::span<const Key> keys();

/// The key of a path; none where the language has no such key.
const Key* key(std::string_view path);

/// The unit of what a path names as --set does, "crate.velocity.x": that of its key in all tables whose
/// members have it; empty where it has none, or they differ.
std::string unit_of(std::string_view path);

/// The keys right under a table, "" for the top.
std::vector<const Key*> keys_of(std::string_view owner);

/// The default of a key as a value, in the plane or in space. Requires a key with a constant default.
const Node& fallback(std::string_view path, int dimension);

/// Keys of the language's next versions, which this one refuses by name.
std::span<const std::string_view> later_keys();

/// The values of a key, in words: "a number of kilograms", "two numbers [x, y] in metres".
std::string expected(const Key& key, int dimension = 2);

/// "kg" as "kilograms"; the unit itself where it has no better word.
std::string unit_words(std::string_view unit);

/// The range that a number must be in, in words: "must be positive", "must be between 0 and 1".
std::string bounds(const Range& range, const std::string& unit, double x);

}  // namespace obscura::scene
