#include "scene/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace obscura::scene {

namespace {

std::vector<Key> built() {
  std::vector<Key> all;
  const std::vector<Key> rows = scene::rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool of_bodies = rows[i].path.starts_with("body.") || rows[i].path.starts_with("particle") ||
                           rows[i].path.starts_with("box");
    if (!of_bodies) {
      all.push_back(rows[i]);
      continue;
    }
    // the run of rows about bodies, once for each kind
    std::size_t end = i;
    while (end < rows.size() && (rows[end].path.starts_with("body.") ||
                                 rows[end].path.starts_with("particle") || rows[end].path.starts_with("box")))
      ++end;
    for (const std::string kind : {"particle", "box"}) {
      for (std::size_t k = i; k < end; ++k) {
        Key key = rows[k];
        if (key.path.starts_with("body.")) key.path = kind + key.path.substr(4);
        for (std::size_t at; (at = key.absent.find("KIND")) != std::string::npos;)
          key.absent.replace(at, 4, kind);
        if (key.path == kind || key.path.starts_with(kind + ".")) all.push_back(key);
      }
    }
    i = end - 1;
  }
  return all;
}

struct Language {
  std::vector<Key> all = built();
  std::map<std::string, std::size_t, std::less<>> index;
  std::map<std::string, Node, std::less<>> fallbacks;

  Language() {
    for (std::size_t i = 0; i < all.size(); ++i) {
      index.emplace(all[i].path, i);
      if (!all[i].fallback.empty())
        fallbacks.emplace(all[i].path, document("x = " + all[i].fallback, all[i].path).table().front().node);
    }
  }
};

const Language& language() {
  static const Language it;
  return it;
}

constexpr std::string_view kLater[] = {"joint",
                                       "polygon",
                                       "chain",
                                       "bond",
                                       "explosion",
                                       "body",
                                       "contact",
                                       "golden",
                                       "room.friction",
                                       "room.walls.friction",
                                       "particle.friction",
                                       "particle.group",
                                       "box.friction",
                                       "box.group",
                                       "spring.breaks"};

}  // namespace

std::span<const Key> keys() { return language().all; }

const Key* key(std::string_view path) {
  const auto found = language().index.find(path);
  return found == language().index.end() ? nullptr : &language().all[found->second];
}

std::vector<const Key*> keys_of(std::string_view owner) {
  std::vector<const Key*> own;
  for (const Key& each : keys())
    if (each.owner() == owner) own.push_back(&each);
  return own;
}

const Node& fallback(std::string_view path) { return language().fallbacks.find(path)->second; }

std::span<const std::string_view> later_keys() { return kLater; }

std::string unit_words(std::string_view unit) {
  static const std::map<std::string_view, std::string_view> words = {{"m", "metres"},
                                                                     {"kg", "kilograms"},
                                                                     {"s", "seconds"},
                                                                     {"deg", "degrees"},
                                                                     {"m/s", "metres per second"},
                                                                     {"m/s^2", "metres per second squared"},
                                                                     {"deg/s", "degrees per second"},
                                                                     {"N/m", "newtons per metre"},
                                                                     {"N s/m", "newton seconds per metre"},
                                                                     {"kg/m^2", "kilograms per square metre"},
                                                                     {"1/s", "per second"}};
  const auto found = words.find(unit);
  return std::string(found == words.end() ? unit : found->second);
}

std::string expected(const Key& key) {
  const std::string of = key.unit.empty() ? "" : (key.unit == "1/s" ? " " : " of ") + unit_words(key.unit);
  const std::string in = key.unit.empty() ? "" : " in " + unit_words(key.unit);
  switch (key.form) {
    case Form::table:
      return "a table";
    case Form::tables:
      return "a list of tables";
    case Form::number:
      return "a number" + of;
    case Form::integer:
      return "a whole number" + of;
    case Form::boolean:
      return "true or false";
    case Form::text:
      return "a string";
    case Form::name:
      return "a name: a string of letters, digits, _ and -";
    case Form::rational:
      return "a number" + of + ", or a fraction such as \"30000/1001\"";
    case Form::choice:
      return fmt::format("one of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::choices:
      return fmt::format("a list of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::color:
      return "a colour: a name or \"#rrggbb\"";
    case Form::vector:
      return "two numbers [x, y]" + in;
    case Form::pixels:
      return "two whole numbers [width, height]";
    case Form::count:
      return "a whole number, or two [columns, rows]";
    case Form::offset:
      return "two numbers [x, y]" + in + ", or a list of such";
    case Form::which:
      return "true, false, or which copies: \"0..4\", \"0,5\"";
    case Form::ends:
      return "two ends, each a body's name, { body = \"name\", local = [x, y] } or a place [x, y]";
    case Form::thing:
      return "the name of a body with copies";
    case Form::path:
      return "points in time [[t, x, y], ...], two at least";
    case Form::trails:
      return "a number of seconds, or a table of them by body";
  }
  return "";
}

std::string bounds(const Range& range, const std::string& unit, double x) {
  const std::string of = unit.empty() ? "" : " " + (unit == "1/s" ? unit_words(unit) : unit);
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  if (low && high && range.high <= 100 && !range.above)
    return fmt::format("must be between {} and {}{}", range.low, range.high, of);
  if (high && x > range.high) return fmt::format("must be at most {}{}", std::int64_t(range.high), of);
  if (range.low == 0) return range.above ? "must be positive" : "must not be negative";
  return fmt::format("must be at least {}{}", range.low, of);
}

}  // namespace obscura::scene
