#include "scene/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "scene/body_kinds.h"
#include "scene/utf8.h"

namespace obscura::scene {

namespace {

// a row for several kinds of body, "any.mass": which kinds
bool holds(std::string_view prefix, const BodyKind& kind) {
  return prefix == "any" || (prefix == "rigid" && kind.turns) || (prefix == "handout" && kind.handout);
}

bool of_bodies(const Key& row) {
  const std::string_view prefix = std::string_view(row.path).substr(0, row.path.find('.'));
  return prefix == "any" || prefix == "rigid" || prefix == "handout" || prefix == "own";
}

void replace(std::string& text, std::string_view word, std::string_view by) {
  for (std::size_t at; (at = text.find(word)) != std::string::npos;) text.replace(at, word.size(), by);
}

std::vector<Key> built() {
  std::vector<Key> all;
  std::vector<Key> rows = world_rows();
  for (Key& row : picture_rows()) rows.push_back(std::move(row));
  for (std::size_t i = 0; i < rows.size();) {
    if (rows[i].path.starts_with("mark.")) {
      ++i;
      continue;
    }
    if (const std::size_t dot = rows[i].path.find(".marks"); dot != std::string::npos) {
      for (Key mark : rows) {
        if (!mark.path.starts_with("mark.")) continue;
        mark.path.replace(0, 4, rows[i].path.substr(0, dot));
        all.push_back(std::move(mark));
      }
      ++i;
      continue;
    }
    if (!of_bodies(rows[i])) {
      all.push_back(rows[i++]);
      continue;
    }
    // the run of rows about bodies, once for each kind
    std::size_t end = i;
    while (end < rows.size() && of_bodies(rows[end])) ++end;
    for (const BodyKind& kind : body_kinds()) {
      all.push_back({.path = std::string(kind.name),
                     .form = Form::tables,
                     .dimension = kind.dimension,
                     .instead = std::string(kind.instead),
                     .doc = std::string(kind.doc)});
      for (std::size_t k = i; k < end; ++k) {
        Key key = rows[k];
        if (key.path == "own") {
          for (Key& own : kind.keys()) all.push_back(std::move(own));
          continue;
        }
        const std::size_t dot = key.path.find('.');
        if (!holds(std::string_view(key.path).substr(0, dot), kind)) continue;
        key.path.replace(0, dot, kind.name);
        replace(key.absent, "KIND", kind.name);
        replace(key.doc, "ORIGIN", kind.own_origin ? "own origin" : "centre of mass");
        all.push_back(std::move(key));
      }
    }
    i = end;
  }
  return all;
}

struct Language {
  std::vector<Key> all = built();
  std::map<std::string, std::size_t, std::less<>> index;
  std::map<std::string, Node, std::less<>> planar, spatial;  // defaults

  Language() {
    const auto value = [](const std::string& text, const std::string& path) {
      return document("x = " + text, path).table().front().node;
    };
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Key& it = all[i];
      index.emplace(it.path, i);
      if (it.fallback.empty()) continue;
      planar.emplace(it.path, value(it.fallback, it.path));
      Node there = value(it.in_space.empty() ? it.fallback : it.in_space, it.path);
      if (it.form == Form::vector && there.list().size() == 2) there.list().push_back({{}, 0.0});
      spatial.emplace(it.path, std::move(there));
    }
  }
};

const Language& language() {
  static const Language it;
  return it;
}

constexpr std::string_view kLater[] = {"spring.breaks"};

}  // namespace

std::span<const Key> keys() { return language().all; }

const Key* key(std::string_view path) {
  const auto found = language().index.find(path);
  return found == language().index.end() ? nullptr : &language().all[found->second];
}

std::string unit_of(std::string_view path) {
  // a component has the unit of its vector
  if (path.size() > 2 && path[path.size() - 2] == '.' && std::string_view("xyz").find(path.back()) < 3)
    path.remove_suffix(2);
  const Key* own = key(path);
  if (own) return own->unit;
  // a name in the place of its table's
  const std::size_t dot = path.find('.');
  if (dot == path.npos) return {};
  const std::string_view rest = path.substr(dot);
  std::vector<std::string_view> units;
  for (const Key& each : keys())
    if (const std::size_t table = each.path.find('.');
        table != each.path.npos && std::string_view(each.path).substr(table) == rest)
      units.push_back(each.unit);
  const bool same = std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  return !units.empty() && same && units[0].find(',') == units[0].npos ? std::string(units[0]) : "";
}

std::vector<const Key*> keys_of(std::string_view owner) {
  std::vector<const Key*> own;
  for (const Key& each : keys())
    if (each.owner() == owner) own.push_back(&each);
  return own;
}

const Node& fallback(std::string_view path, int dimension) {
  const auto& all = dimension == 2 ? language().planar : language().spatial;
  return all.find(path)->second;
}

std::span<const std::string_view> later_keys() { return kLater; }

std::string unit_words(std::string_view unit) {
  static const std::map<std::string_view, std::string_view> words = {
      {"m", "metres"},
      {"kg", "kilograms"},
      {"s", "seconds"},
      {"deg", "degrees"},
      {"m/s", "metres per second"},
      {"m/s^2", "metres per second squared"},
      {"deg/s", "degrees per second"},
      {"N/m", "newtons per metre"},
      {"N s/m", "newton seconds per metre"},
      {"kg/m^2, in space kg/m^3", "kilograms per square metre, in space per cubic metre"},
      {"m/N", "metres per newton"},
      {"N m^2", "newton square metres"},
      {"N", "newtons"},
      {"%", "percent"},
      {"J", "joules"},
      {"C", "coulombs"},
      {"T", "teslas"},
      {"V/m", "volts per metre"},
      {"1/s", "per second"}};
  const auto found = words.find(unit);
  return std::string(found == words.end() ? unit : found->second);
}

std::string expected(const Key& key, int dimension) {
  const std::string of = key.unit.empty() ? "" : (key.unit == "1/s" ? " " : " of ") + unit_words(key.unit);
  const std::string in = key.unit.empty() ? "" : " in " + unit_words(key.unit);
  const bool space = (key.dimension == 0 ? dimension : key.dimension) == 3;
  const std::string place = space ? "[x, y, z]" : "[x, y]",
                    numbers = (space ? "three numbers " : "two numbers ") + place;
  switch (key.form) {
    case Form::table:
      return "a table";
    case Form::tables:
      return "a list of tables";
    case Form::cameras:
      return space ? "a table, or a list of them" : "a table";
    case Form::speeds:
      return "a number or fraction, or a list of tables";
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
    case Form::label:
      return kPathName;
    case Form::rational:
      return "a number" + of + ", or a fraction such as \"30000/1001\"";
    case Form::choice:
      return fmt::format("one of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::choices:
      return fmt::format("a list of \"{}\"", fmt::join(key.choices, "\", \""));
    case Form::color:
      return "a colour: a name or \"#rrggbb\"";
    case Form::vector:
      return numbers + in;
    case Form::spin:
      return space ? numbers + in : "a number" + of;
    case Form::turn:
      return "three turns [x, y, z] in degrees, or { axis = [x, y, z], angle = degrees }";
    case Form::pixels:
      return "two whole numbers [width, height]";
    case Form::count:
      return space ? "a whole number, or up to three [columns, rows, layers]"
                   : "a whole number, or two [columns, rows]";
    case Form::offset:
      return numbers + in + ", or a list of such";
    case Form::which:
      return "true, false, or which copies: \"0..4\", \"0,5\"";
    case Form::ends:
      return fmt::format("two ends, each a body's name, {{ body = \"name\", local = {0} }} or a place {0}",
                         place);
    case Form::places:
      return fmt::format("a list of places, each {0}, a body's name or {{ body = \"name\", local = {0} }}",
                         place);
    case Form::couple:
      return "two names";
    case Form::things:
      return "a list of names of bodies";
    case Form::thing:
      return "the name of a body";
    case Form::points:
      return (space ? "four points or more [[x, y, z], ...]" : "three points or more [[x, y], ...]") + in;
    case Form::pairs:
      return "pairs of names [[\"a\", \"b\"], ...]";
    case Form::limits:
      return "two numbers [lowest, highest]";
    case Form::path:
      return fmt::format("points in time [[t, {}, ...], two at least", place.substr(1));
    case Form::curve:
      return fmt::format(
          "places and pieces of a track, such as [{0}, {{ through = {0}, to = {0} }}], two at least", place);
    case Form::walls:
      return "\"ground\", \"none\", or a list of tables";
    case Form::place:
      return fmt::format("a body's name, {{ body = \"name\", local = {0} }} or a place {0}", place);
    case Form::times:
      return "a number" + of + ", or a list of them";
    case Form::cue:
      return "a number of seconds, the name of a mark, or { time = either of them, after = seconds of the "
             "film }";
    case Form::trails:
      return "a number of seconds, or a table of them by body";
    case Form::states:
      return "true, false, or the file of a run (CSV)";
    case Form::bodies:
      return "the name of a body, such as \"ball[*]\", or a list of them";
    case Form::expression:
      return "an expression such as \"-2*x\", or a number";
    case Form::expressions:
      return space ? "three expressions such as [\"-2*x\", \"0\", \"0\"]"
                   : "two expressions such as [\"-2*x\", \"0\"]";
    case Form::torque:
      return space ? "three expressions such as [\"0\", \"-2*spiny\", \"0\"]"
                   : "an expression such as \"-2*spin\"";
    case Form::numbers:
      return "a table of numbers with names";
    case Form::any:
      return "a value";
    case Form::moment:
      return "a number" + of + ", a fraction such as \"30000/1001\", or the name of a mark";
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
