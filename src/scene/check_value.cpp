#include "scene/check_value.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "draw/picture/color.h"
#include "scene/utf8.h"
#include "sim/math/rational.h"

namespace obscura::scene {

namespace {

constexpr std::int64_t kFinest = 1'000'000;  // of exact times: sums and differences of them fit 64 bits
constexpr double kLargest = 1e100;           // beyond it squares overflow

constexpr const char* kColors[] = {"orange",    "sky",   "green",   "blue",   "vermilion", "purple",
                                   "yellow",    "grey",  "black",   "white",  "red",       "brown",
                                   "pink",      "cyan",  "magenta", "violet", "navy",      "teal",
                                   "turquoise", "olive", "lime",    "gold",   "silver",    "gray"};

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

bool zero(const Node& vector) {
  return std::all_of(vector.list().begin(), vector.list().end(),
                     [](const Node& c) { return c.number() == 0; });
}

// whether all pass; none is passed over, so that each is complained about
template <class List, class Check>
bool each(const List& list, Check check) {
  bool good = true;
  for (const auto& one : list) good = check(one) && good;
  return good;
}

class Values : private Reporter {
 public:
  explicit Values(const Reporter& faults) : Reporter(faults) {}

  bool right(const Node& node, const Key& key) {
    const auto is = [&](bool good) { return good || mistyped(node, key); };
    switch (key.form) {
      case Form::boolean:
        return is(std::holds_alternative<bool>(node.value));
      case Form::text:
        if (key.varies && node.is_list() && !node.list().empty())
          return each(node.list(), [&](const Node& it) { return it.is_text() || mistyped(it, key); });
        return is(node.is_text());
      case Form::thing:
        return is(node.is_text());
      case Form::which:
      case Form::states:
        return is(std::holds_alternative<bool>(node.value) || node.is_text());
      case Form::number:
        return key.varies && !node.is_number() ? varied(node, key) : number(node, key);
      case Form::integer:
        return integer(node, key);
      case Form::rational:
      case Form::speeds:  // those that are a number
        return rational(node, key);
      case Form::times:
        return times(node, key);
      case Form::cue:
        return cue(node, key);
      case Form::vector:
        return key.varies && (node.is_table() || several(node, key)) ? varied(node, key) : vector(node, key);
      case Form::spin:
        return spin(node, key);
      case Form::turn:
        return turn(node, key);
      case Form::pixels:
        return pixels(node, key);
      case Form::count:
        return count(node, key);
      case Form::offset:
        return offset(node, key);
      case Form::points:
        return points(node, key);
      case Form::limits:
        return limits(node, key);
      case Form::path:
        return path(node, key);
      case Form::curve:
        return curve(node, key);
      case Form::trails:
        return trails(node, key);
      case Form::name:
        return name(node, key);
      case Form::label:
        return label(node, key);
      case Form::things:
        return things(node, key);
      case Form::bodies:
        return node.is_text() || (things(node, key) && (!node.list().empty() || mistyped(node, key)));
      case Form::expression:
        return expression(node, key);
      case Form::expressions:
        return expressions(node, key);
      case Form::torque:
        return dimension() == 2 ? expression(node, key) : expressions(node, key);
      case Form::numbers:
        return numbers(node, key);
      case Form::any:
        return true;
      case Form::moment:
        return is_mark(node) || rational(node, key);
      case Form::pairs:
        return pairs(node, key);
      case Form::choice:
      case Form::walls:  // those that are a word
        return is(node.is_text()) && word(node, key);
      case Form::choices:
        return choices(node, key);
      case Form::color:
        return color(node, key);
      case Form::ends:
        return ends(node, key);
      case Form::places:
        if (!node.is_list() || node.list().empty() || node.list().front().is_number())
          return mistyped(node, key);
        return each(node.list(), [&](const Node& it) { return end(it, key); });
      case Form::couple:
        if (!node.is_list() || node.list().size() != 2) return mistyped(node, key);
        return each(node.list(), [&](const Node& it) { return it.is_text() || mistyped(it, key); });
      case Form::place:
        return end(node, key);
      case Form::table:
      case Form::tables:
      case Form::cameras:
        break;
    }
    return false;
  }

 private:
  bool ranges(const Node& node, const Key& key, double x, const std::string& got) {
    return key.range.has(x) ||
           wrong(node, fmt::format("'{}' {}, got {}", key.last(), bounds(key.range, key.unit, x), got));
  }

  // a place with as many numbers as the others have
  bool fits(const Node& node, std::string_view of, std::size_t numbers) {
    return int(numbers) == dimension() ||
           wrong(node, fmt::format("'{}' has {} numbers and {}: a scene is planar or in space, not both", of,
                                   numbers, because()));
  }

  bool number(const Node& node, const Key& key) {
    if (!node.is_number()) return mistyped(node, key);
    const double x = node.number();
    if (!std::isfinite(x)) return wrong(node, fmt::format("'{}' must be finite, got {}", key.last(), x));
    if (!ranges(node, key, x, described(node))) return false;
    return std::abs(x) <= kLargest || wrong(node, fmt::format("'{}' is too large, got {}", key.last(), x));
  }

  bool integer(const Node& node, const Key& key) {
    if (!node.is_integer()) return mistyped(node, key);
    if (key.path == "version" && !key.range.has(node.number()))
      return wrong(node,
                   fmt::format("version {} of the language is newer than this obscura, which reads version 1",
                               described(node)));
    return ranges(node, key, node.number(), described(node));
  }

  bool rational(const Node& node, const Key& key) {
    std::optional<sim::Rational> exact;
    if (node.is_text()) {
      exact = sim::parse_rational(node.text());
      if (!exact) return instead(node, key, in_quotes(node.text()));
    } else {
      if (!number(node, key)) return false;
      exact = node.is_integer() ? sim::Rational{std::get<std::int64_t>(node.value), 1}
                                : sim::from_double(node.number());
    }
    const std::string got = node.is_text() ? in_quotes(node.text()) : described(node);
    if (exact && !ranges(node, key, sim::value(*exact), got)) return false;
    const bool seconds = key.unit == "s";
    return (exact && exact->den <= kFinest && (seconds || exact->num <= kFinest)) ||
           wrong(node,
                 fmt::format(
                     "'{}' is kept exactly and {} has too many digits: expected {}", key.last(), got,
                     seconds ? "microseconds at the finest" : "a fraction of whole numbers up to a million"));
  }

  bool times(const Node& node, const Key& key) {
    if (!node.is_list()) return rational(node, key);
    if (node.list().empty()) return mistyped(node, key);
    return each(node.list(), [&](const Node& time) { return rational(time, key); });
  }

  // the name of a mark of the run; whether there is one is found later
  static bool is_mark(const Node& node) {
    return node.is_text() && !node.text().empty() && letter(node.text()[0]);
  }

  // every number of a list
  bool cue(const Node& node, const Key& key) {
    if (is_mark(node)) return true;
    if (!node.is_table())
      return node.is_number() || node.is_text() ? rational(node, key) : mistyped(node, key);
    bool good = each(node.table(), [&](const Entry& entry) {
      if (entry.key != "time" && entry.key != "after")
        return unknown(entry, fmt::format("'{}'", key.last()), did_you_mean(entry.key, {"time", "after"}));
      if (entry.key == "time" && is_mark(entry.node)) return true;
      return rational(entry.node,
                      {.path = entry.key, .form = Form::rational, .unit = "s", .range = {0, 1e6}});
    });
    if (!node.find("time"))
      good = wrong(node, fmt::format("'{}' needs 'time', seconds of the run", key.last()));
    return good;
  }

  bool components(const Node& node, const Key& key) {
    return each(node.list(),
                [&](const Node& x) { return x.is_number() ? number(x, key) : mistyped(x, key, "numbers"); });
  }

  bool vector(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (key.varies && key.last() == "position" && !node.list().empty() && node.list().front().is_list())
      return wrong(node,
                   "'position' is one place; copies = { at = [[1, 2], [3, 2]] } says that of each copy");
    if (!components(node, key)) return false;
    const std::size_t n = node.list().size();
    if (n != 2 && n != 3) return instead(node, key, fmt::format("{} of them", n));
    if (!fits(node, key.last(), n)) return false;
    if (key.last() == "normal" && zero(node))
      return wrong(node, fmt::format("'normal' is zero: expected the direction into the room, such as {}",
                                     dimension() == 2 ? "[0, 1]" : "[0, 1, 0]"));
    return true;
  }

  // a number in the plane, a vector in space
  bool spin(const Node& node, const Key& key) {
    if (dimension() == 2) return node.is_number() || !key.varies ? number(node, key) : varied(node, key);
    if (node.is_number())
      return wrong(node, fmt::format("'{}' is one number, as in the plane, and {}: expected {}", key.last(),
                                     because(), expected(key)));
    return right(node, {.path = key.path, .form = Form::vector, .unit = key.unit, .varies = key.varies});
  }

  // three turns, or an axis and an angle
  bool turn(const Node& node, const Key& key) {
    if (node.is_list())
      return node.list().size() == 3 ? components(node, key)
                                     : instead(node, key, fmt::format("{} numbers", node.list().size()));
    if (!node.is_table()) return mistyped(node, key);
    bool good = each(node.table(), [&](const Entry& entry) {
      if (entry.key == "axis") {
        if (!vector(entry.node, {.path = "axis", .form = Form::vector})) return false;
        return !zero(entry.node) ||
               wrong(entry.node, "'axis' is zero: expected a direction such as [0, 1, 0]");
      }
      if (entry.key == "angle")
        return number(entry.node, {.path = "angle", .form = Form::number, .unit = "deg"});
      return unknown(entry, "an orientation", did_you_mean(entry.key, {"axis", "angle"}));
    });
    if (good && (!node.find("axis") || !node.find("angle")))
      good = wrong(node, fmt::format("'{}': expected {}", key.last(), expected(key)));
    return good;
  }

  // one vector for each copy; places of copies are copies.at
  static bool several(const Node& node, const Key& key) {
    return node.is_list() && !node.list().empty() && node.list().front().is_list() &&
           key.last() != "position";
  }

  // over copies: { from = a, to = b }, or a list with one for each
  bool varied(const Node& node, const Key& key) {
    if (several(node, key)) return vectors(node, key);
    if (node.is_list()) return components(node, key);
    if (!node.is_table()) return mistyped(node, key);
    bool good = each(node.table(), [&](const Entry& entry) {
      return entry.key == "from" || entry.key == "to" ||
             unknown(entry, fmt::format("'{}'", key.last()),
                     ": expected { from, to } over copies, or " + expected(key));
    });
    for (const char* end : {"from", "to"}) {
      const Node* value = node.find(end);
      if (value) {
        good = (key.form == Form::vector ? vector(*value, key) : number(*value, key)) && good;
      } else if (good) {
        good = wrong(node, fmt::format("'{}': expected {{ from, to }}, got no '{}'", key.last(), end));
      }
    }
    return good;
  }

  bool integers(const Node& node, const Key& key) {
    return each(node.list(), [&](const Node& n) { return integer(n, key); });
  }

  bool vectors(const Node& node, const Key& key) {
    return each(node.list(), [&](const Node& v) { return vector(v, key); });
  }

  bool pixels(const Node& node, const Key& key) {
    return node.is_list() && node.list().size() == 2 ? integers(node, key) : mistyped(node, key);
  }

  bool count(const Node& node, const Key& key) {
    if (!node.is_list()) return node.is_number() ? integer(node, key) : mistyped(node, key);
    if (node.list().empty() || int(node.list().size()) > dimension())
      return instead(node, key, fmt::format("{} numbers", node.list().size()));
    return integers(node, key);
  }

  bool offset(const Node& node, const Key& key) {
    if (!node.is_list() || node.list().empty()) return mistyped(node, key);
    return node.list().front().is_list() ? vectors(node, key) : vector(node, key);
  }

  bool points(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (int(node.list().size()) < dimension() + 1)
      return instead(node, key, fmt::format("{}", node.list().size()));
    return vectors(node, key);
  }

  bool limits(const Node& node, const Key& key) {
    if (!node.is_list() || node.list().size() != 2) return mistyped(node, key);
    if (!components(node, key)) return false;
    const double low = node.list()[0].number(), high = node.list()[1].number();
    if (low > high)
      return wrong(node,
                   fmt::format("'{}': the lowest comes first, got {} before {}", key.last(), low, high));
    // of an axis: it starts nowhere
    if (key.last() == "range")
      return low < high ||
             wrong(node, fmt::format("'{}': expected two values, the lower one first", key.last()));
    return (low <= 0 && high >= 0) ||
           wrong(node, fmt::format("'{}' exclude where it starts: expected 0 between {} and {}", key.last(),
                                   low, high));
  }

  bool path(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (node.list().size() < 2) return instead(node, key, fmt::format("{}", node.list().size()));
    const Node* before = nullptr;
    return each(node.list(), [&](const Node& it) {
      if (!knot(it, key)) return false;
      const Node& time = it.list().front();
      bool good = rational(time, {.path = "time", .form = Form::rational, .unit = "s", .range = {0, 1e6}});
      if (before && time.number() <= before->number())
        good = wrong(time, fmt::format("times must increase along the path, got {} after {}", described(time),
                                       described(*before)));
      before = &time;
      return good;
    });
  }

  // places, arcs { through, to } and splines { spline }
  bool curve(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (node.list().size() < 2) return instead(node, key, fmt::format("{}", node.list().size()));
    const Key place{.path = key.path, .form = Form::vector, .unit = key.unit};
    return each(node.list(), [&](const Node& it) {
      if (it.is_list()) return vector(it, place);
      if (!it.is_table()) return mistyped(it, key);
      const bool spline = it.find("spline") != nullptr;
      bool good = each(it.table(), [&](const Entry& entry) {
        if (spline && entry.key == "spline") {
          if (!entry.node.is_list() || entry.node.list().empty() || !entry.node.list().front().is_list())
            return mistyped(entry.node, key, "a list of places");
          return each(entry.node.list(), [&](const Node& v) { return vector(v, place); });
        }
        if (!spline && (entry.key == "through" || entry.key == "to")) return vector(entry.node, place);
        return unknown(entry, "a piece of a track", ": expected through, to or spline");
      });
      if (!spline && !it.find("to"))
        good = wrong(
            it,
            "a piece of a track is { through = place, to = place }, { to = place } or { spline = places }");
      return good;
    });
  }

  // a time and a place
  bool knot(const Node& node, const Key& key) {
    const bool plane = dimension() == 2;
    if (!node.is_list() || node.list().empty())
      return mistyped(node, key, plane ? "a point in time [t, x, y]" : "a point in time [t, x, y, z]");
    if (!components(node, key)) return false;
    const std::size_t n = node.list().size() - 1;
    if (n != 2 && n != 3)
      return instead(node, key, plane ? "three numbers [t, x, y]" : "four numbers [t, x, y, z]",
                     fmt::format("{}", n + 1));
    return fits(node, "place after the time in path", n);
  }

  bool trails(const Node& node, const Key& key) {
    const Key seconds{.path = "trails", .form = Form::number, .unit = "s", .range = {0, 1e6}};
    if (node.is_number()) return number(node, seconds);
    if (!node.is_table()) return mistyped(node, key);
    return each(node.table(), [&](const Entry& entry) { return number(entry.node, seconds); });
  }

  bool name(const Node& node, const Key& key) {
    if (!node.is_text()) return mistyped(node, key);
    const std::string& text = node.text();
    const bool good =
        !text.empty() && text.size() <= 100 && letter(text[0]) &&
        std::all_of(text.begin(), text.end(), [](char c) { return letter(c) || digit(c) || c == '-'; });
    if (!good) return instead(node, key, "letters, digits, _ and -, a letter first", in_quotes(text));
    const auto taken = keys_of("");
    // "ball" may be the name of a [[ball]], and of anything else
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const Key* it) { return it->path == text && it->form != Form::tables; }))
      return wrong(node, fmt::format("'{}': {} is a word of the language; choose another", key.last(),
                                     in_quotes(text)));
    return true;
  }

  bool label(const Node& node, const Key& key) {
    if (!node.is_text()) return mistyped(node, key);
    return is_path_name(node.text()) || instead(node, key, kPathName, in_quotes(node.text()));
  }

  bool things(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    return each(node.list(), [&](const Node& it) {
      return it.is_text() || mistyped(it, key, "names of bodies such as \"plank[*]\"");
    });
  }

  bool expression(const Node& node, const Key& key) {
    if (node.is_number()) return number(node, key);
    return node.is_text() || mistyped(node, key);
  }

  bool expressions(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (int(node.list().size()) != dimension())
      return instead(node, key, fmt::format("{} of them", node.list().size()));
    return each(node.list(), [&](const Node& it) {
      return it.is_number() ? number(it, key) : it.is_text() || mistyped(it, key, "expressions");
    });
  }

  // names of their own
  bool numbers(const Node& node, const Key& key) {
    if (!node.is_table()) return mistyped(node, key);
    return each(node.table(), [&](const Entry& entry) {
      const std::string& text = entry.key;
      const bool good = !text.empty() && text.size() <= 100 && letter(text[0]) &&
                        std::all_of(text.begin(), text.end(), [](char c) { return letter(c) || digit(c); });
      if (!good) {
        complaints().add(entry.place,
                         fmt::format("a constant has a name of letters, digits and _, a letter first, got {}",
                                     in_quotes(text)));
        return false;
      }
      const Key own{.path = "constants." + text, .form = Form::expression};
      return expression(entry.node, own);
    });
  }

  bool pairs(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    return each(node.list(), [&](const Node& pair) {
      const bool two =
          pair.is_list() && pair.list().size() == 2 && pair.list()[0].is_text() && pair.list()[1].is_text();
      return two || mistyped(pair, key, "pairs of names such as [\"stones\", \"frame\"]");
    });
  }

  bool word(const Node& node, const Key& key) {
    const std::string& text = node.text();
    if (std::find(key.choices.begin(), key.choices.end(), text) != key.choices.end()) return true;
    const std::string known = fmt::format("{}", fmt::join(key.choices, ", "));
    if (std::find(key.later.begin(), key.later.end(), text) != key.later.end())
      return wrong(node, fmt::format("'{}': '{}' is not in this version of obscura yet, which has {}",
                                     key.last(), text, known));
    return instead(node, key, "one of " + known,
                   in_quotes(text) + did_you_mean(text, {key.choices.begin(), key.choices.end()}));
  }

  bool choices(const Node& node, const Key& key) {
    // one word without its list: right or wrong, it is told of alone
    if (node.is_text())
      return word(node, key) &&
             instead(node, key, "a list",
                     fmt::format("{0}; write it in brackets: [\"{1}\"]", described(node), node.text()));
    if (!node.is_list()) return mistyped(node, key);
    return each(node.list(),
                [&](const Node& it) { return it.is_text() ? word(it, key) : mistyped(it, key, "a string"); });
  }

  bool color(const Node& node, const Key& key) {
    if (node.is_table() && key.varies) {
      const bool good = each(node.table(), [&](const Entry& entry) {
        if (entry.key == "from" || entry.key == "to") return one_color(entry.node, key);
        return unknown(entry, fmt::format("'{}'", key.last()),
                       ": expected { from, to } over copies, or " + expected(key));
      });
      if (!good) return false;
      return (node.find("from") && node.find("to")) ||
             wrong(node, fmt::format("'{}': expected {{ from, to }}, two colours", key.last()));
    }
    if (!node.is_list()) return one_color(node, key);
    if (node.list().empty()) return wrong(node, fmt::format("'{}': expected a colour at least", key.last()));
    return each(node.list(), [&](const Node& it) { return one_color(it, key); });
  }

  bool one_color(const Node& node, const Key& key) {
    if (!node.is_text()) return mistyped(node, key);
    if (draw::color(node.text())) return true;
    const std::string hint = did_you_mean(node.text(), {std::begin(kColors), std::end(kColors)});
    return wrong(node, fmt::format("'{}': {} is no colour{}", key.last(), in_quotes(node.text()),
                                   hint.empty() ? fmt::format("; expected \"#rrggbb\" or one of {}",
                                                              fmt::join(kColors, ", "))
                                                : hint));
  }

  bool ends(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key);
    if (node.list().size() != 2) return instead(node, key, fmt::format("{} of them", node.list().size()));
    return each(node.list(), [&](const Node& it) { return end(it, key); });
  }

  bool end(const Node& node, const Key& key) {
    if (node.is_text()) return true;
    if (node.is_list()) return vector(node, key);
    const std::string what = expected({.path = key.path, .form = Form::place});
    if (!node.is_table()) return mistyped(node, key, what);
    const bool good = each(node.table(), [&](const Entry& entry) {
      if (entry.key == "body" || entry.key == "at")
        return entry.node.is_text() || mistyped(entry.node, {.path = entry.key, .form = Form::text});
      if (entry.key == "local")
        return vector(entry.node, {.path = "local", .form = Form::vector, .unit = "m"});
      return unknown(entry, "an end", did_you_mean(entry.key, {"body", "local", "at"}));
    });
    if (!node.find("body")) return instead(node, key, what, "a table without 'body'");
    if (node.find("local") && node.find("at"))
      return wrong(node, "'local' and 'at' both say where on the body; leave one out");
    return good;
  }
};

}  // namespace

bool check_value(const Node& node, const Key& key, const Reporter& faults) {
  return Values(faults).right(node, key);
}

}  // namespace obscura::scene
