#include "scene/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "draw/color.h"
#include "sim/rational.h"

namespace obscura::scene {

namespace {

constexpr std::int64_t kFinest = 1'000'000;  // of exact times: sums and differences of them fit 64 bits
constexpr double kLargest = 1e100;           // beyond it squares overflow

constexpr const char* kColors[] = {"orange", "sky",    "green", "blue",  "vermilion",
                                   "purple", "yellow", "grey",  "black", "white"};

bool letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

// a string that is a number: what was meant, but said otherwise
bool looks_like_a_number(const std::string& text) { return sim::parse_rational(text).has_value(); }

std::string owner_text(const std::string& owner) {
  if (owner.empty()) return "a scene";
  const Key* it = key(owner);
  if (owner.find('.') != std::string::npos)
    return (it->form == Form::tables || it->form == Form::walls ? "each of '" : "'") +
           std::string(it->last()) + "'";
  return it->form == Form::tables ? "[[" + owner + "]]" : "[" + owner + "]";
}

// where else a key of this name lives
std::string elsewhere(std::string_view last) {
  for (const Key& each : keys())
    if (each.last() == last && each.owner().find('.') == std::string_view::npos)
      return each.owner().empty() ? "it belongs at the top, before the first [table]"
                                  : "it belongs in " + owner_text(std::string(each.owner()));
  return "";
}

class Checker {
 public:
  Checker(const Dimension& told, Complaints& complaints) : told_(told), complaints_(complaints) {}

  // takes out of a table what is wrong with it
  void table(Node& node, const std::string& owner) {
    std::vector<std::string_view> met;
    std::erase_if(node.table(), [&](Entry& entry) {
      const std::string path = owner.empty() ? entry.key : owner + '.' + entry.key;
      const Key* known = key(path);
      if (!known) {
        met.push_back(unknown(entry, owner, path));
        return true;
      }
      met.push_back(known->last());
      if (known->dimension != 0 && known->dimension != told_.n) {
        of_the_other(entry, *known);
        return true;
      }
      return !value(entry.node, *known);
    });
    for (const Key* each : keys_of(owner))
      if (each->required && std::find(met.begin(), met.end(), each->last()) == met.end())
        complaints_.add(node.place, fmt::format("{} needs '{}': {}", owner_text(owner), each->last(),
                                                expected(*each, told_.n)));
  }

 private:
  static std::string last(const std::string& path) { return path.substr(path.rfind('.') + 1); }

  // "and 'size' at a.toml:2:8 has three numbers", where that is why
  std::string because() const {
    if (told_.key.empty()) return "no place of this scene has three numbers";
    return fmt::format("'{}' at {} has {}", last(told_.key), complaints_.text(told_.place), told_.n);
  }

  // a key of the plane in space, or the other way around
  void of_the_other(const Entry& entry, const Key& key) {
    const std::string here = told_.n == 2 ? "in the plane" : "in space",
                      there = told_.n == 2 ? "of space" : "of the plane";
    complaints_.add(
        entry.place,
        fmt::format("{} is {}, and {}{}",
                    key.form == Form::tables ? "[[" + key.path + "]]" : "'" + entry.key + "'", there,
                    because(), key.instead.empty() ? "" : "; " + here + " " + key.instead));
  }

  // a place with as many numbers as the others have
  bool fits(const Node& node, const std::string& key, std::size_t numbers) {
    if (int(numbers) == told_.n) return true;
    return wrong(node, fmt::format("'{}' has {} numbers and {}: a scene is planar or in space, not both",
                                   last(key), numbers, because()));
  }

  bool wrong(const Node& node, std::string message) {
    complaints_.add(node.place, std::move(message));
    return false;
  }

  bool mistyped(const Node& node, const Key& key, const std::string& what) {
    std::string hint;
    const bool wants_number = key.form == Form::number || key.form == Form::integer ||
                              key.form == Form::vector || key.form == Form::pixels ||
                              key.form == Form::count || key.form == Form::path || key.form == Form::spin;
    if (wants_number && node.is_text() && looks_like_a_number(node.text()))
      hint = "; write it without the quotes";
    return wrong(node, fmt::format("'{}': expected {}, got {}{}", key.last(), what, described(node), hint));
  }

  // complains of a key nobody knows, and says which of the table's keys was probably meant
  std::string_view unknown(const Entry& entry, const std::string& owner, const std::string& path) {
    const bool several = entry.node.is_list() && entry.node.header;
    const std::string shown = several                                      ? "[[" + entry.key + "]]"
                              : entry.node.is_table() && entry.node.header ? "[" + entry.key + "]"
                                                                           : "'" + entry.key + "'";
    const auto later = later_keys();
    if (std::find(later.begin(), later.end(), path) != later.end()) {
      complaints_.add(entry.place, shown + " is not in this version of obscura yet");
      return {};
    }
    if (complaints_.enough()) {
      complaints_.add(entry.place, "unknown key " + quoted(entry.key));
      return {};
    }
    std::vector<std::string_view> words;
    for (const Key* each : keys_of(owner))
      if (each->dimension == 0 || each->dimension == told_.n) words.push_back(each->last());
    const std::string_view near = nearest(entry.key, words);
    std::string hint;
    if (const std::string plural = entry.key + 's'; owner.empty() && !elsewhere(plural).empty()) {
      hint = "; '" + plural + "': " + elsewhere(plural);
    } else if (!near.empty()) {
      hint = fmt::format("; did you mean '{}'?", near);
    } else if (const std::string other = elsewhere(entry.key); !other.empty()) {
      hint = "; " + other;
    } else if (words.size() <= 8) {
      hint = fmt::format("; it has {}", fmt::join(words, ", "));
    } else if (owner.empty() && several) {
      std::vector<std::string> tables;
      for (const Key* each : keys_of(owner))
        if (each->form == Form::tables && (each->dimension == 0 || each->dimension == told_.n))
          tables.push_back("[[" + std::string(each->last()) + "]]");
      hint = fmt::format("; there are {}", fmt::join(tables, ", "));
    }
    complaints_.add(entry.place, fmt::format("unknown key {}{}{}", quoted(entry.key),
                                             owner.empty() ? "" : " in " + owner_text(owner), hint));
    return near;
  }

  bool value(Node& node, const Key& key) {
    switch (key.form) {
      case Form::table:
        return node.is_table() ? (table(node, key.path), true) : mistyped(node, key, expected(key, told_.n));
      case Form::tables:
        return tables(node, key);
      case Form::number:
        return key.varies && !node.is_number() ? varied(node, key) : number(node, key);
      case Form::integer:
        return integer(node, key);
      case Form::boolean:
        return std::holds_alternative<bool>(node.value) || mistyped(node, key, expected(key, told_.n));
      case Form::text:
        return node.is_text() || mistyped(node, key, expected(key, told_.n));
      case Form::thing:
        return node.is_text() || mistyped(node, key, expected(key, told_.n));
      case Form::things:
        return things(node, key);
      case Form::name:
        return name(node, key);
      case Form::rational:
        return rational(node, key);
      case Form::choice:
        return choice(node, key);
      case Form::choices:
        return choices(node, key);
      case Form::color:
        return color(node, key);
      case Form::vector:
        return key.varies && node.is_table() ? varied(node, key) : vector(node, key);
      case Form::spin:
        return spin(node, key);
      case Form::turn:
        return turn(node, key);
      case Form::cameras:
        if (node.is_table()) return table(node, key.path), true;
        if (told_.n == 2 && node.is_list())
          return wrong(node, "[[camera]]s beside each other are of space, and " + because() +
                                 "; in the plane it is one [camera]");
        return tables(node, key);
      case Form::walls:
        return node.is_text() ? choice(node, key) : tables(node, key);
      case Form::pixels:
        return pixels(node, key);
      case Form::count:
        return count(node, key);
      case Form::offset:
        return offset(node, key);
      case Form::which:
        return std::holds_alternative<bool>(node.value) || node.is_text() ||
               mistyped(node, key, expected(key, told_.n));
      case Form::points:
        return points(node, key);
      case Form::pairs:
        return pairs(node, key);
      case Form::limits:
        return limits(node, key);
      case Form::ends:
        return ends(node, key);
      case Form::place:
        return end(node, key);
      case Form::times:
        return times(node, key);
      case Form::path:
        return path(node, key);
      case Form::trails:
        return trails(node, key);
    }
    return false;
  }

  bool tables(Node& node, const Key& key) {
    const bool list = node.is_list() && std::all_of(node.list().begin(), node.list().end(),
                                                    [](const Node& n) { return n.is_table(); });
    if (!list) {
      if (node.is_table() && node.header && key.owner().empty())
        return wrong(node, fmt::format("[{}] stands for one of many; write [[{}]]", key.path, key.path));
      return mistyped(node, key, expected(key, told_.n));
    }
    for (Node& each : node.list()) table(each, key.path);
    return true;
  }

  bool number(const Node& node, const Key& key) {
    if (!node.is_number()) return mistyped(node, key, expected(key, told_.n));
    const double x = node.number();
    if (!std::isfinite(x)) return wrong(node, fmt::format("'{}' must be finite, got {}", key.last(), x));
    if (!key.range.has(x))
      return wrong(node, fmt::format("'{}' {}, got {}", key.last(),
                                     bounds(key.range, key.unit, node.number()), described(node)));
    if (std::abs(x) > kLargest) return wrong(node, fmt::format("'{}' is too large, got {}", key.last(), x));
    return true;
  }

  bool integer(const Node& node, const Key& key) {
    if (!node.is_integer()) return mistyped(node, key, expected(key, told_.n));
    if (key.path == "version" && !key.range.has(node.number()))
      return wrong(node,
                   fmt::format("version {} of the language is newer than this obscura, which reads version 1",
                               described(node)));
    return key.range.has(node.number()) ||
           wrong(node, fmt::format("'{}' {}, got {}", key.last(), bounds(key.range, key.unit, node.number()),
                                   described(node)));
  }

  bool name(const Node& node, const Key& key) {
    if (!node.is_text()) return mistyped(node, key, expected(key, told_.n));
    const std::string& text = node.text();
    const bool good =
        !text.empty() && text.size() <= 100 && letter(text[0]) &&
        std::all_of(text.begin(), text.end(), [](char c) { return letter(c) || digit(c) || c == '-'; });
    if (!good)
      return wrong(node, fmt::format("'{}': expected letters, digits, _ and -, a letter first, got {}",
                                     key.last(), quoted(text)));
    const auto taken = keys_of("");
    // "ball" may be the name of a [[ball]], and of anything else
    if (std::any_of(taken.begin(), taken.end(),
                    [&](const Key* each) { return each->path == text && each->form != Form::tables; }))
      return wrong(
          node, fmt::format("'{}': {} is a word of the language; choose another", key.last(), quoted(text)));
    return true;
  }

  bool rational(const Node& node, const Key& key) {
    std::optional<sim::Rational> exact;
    if (node.is_text()) {
      exact = sim::parse_rational(node.text());
      if (!exact)
        return wrong(node, fmt::format("'{}': expected {}, got {}", key.last(), expected(key, told_.n),
                                       quoted(node.text())));
    } else {
      if (!number(node, key)) return false;
      exact = node.is_integer() ? sim::Rational{std::get<std::int64_t>(node.value), 1}
                                : sim::from_double(node.number());
    }
    const std::string got = node.is_text() ? quoted(node.text()) : described(node);
    if (exact && !key.range.has(sim::value(*exact)))
      return wrong(node, fmt::format("'{}' {}, got {}", key.last(),
                                     bounds(key.range, key.unit, sim::value(*exact)), got));
    const bool fits = exact && exact->den <= kFinest && (key.unit == "s" || exact->num <= kFinest);
    if (!fits)
      return wrong(
          node, fmt::format("'{}' is kept exactly and {} has too many digits: expected {}", key.last(), got,
                            key.unit == "s" ? "microseconds at the finest"
                                            : "a fraction of whole numbers up to a million"));
    return true;
  }

  bool word(const Node& node, const Key& key) {
    const std::string& text = node.text();
    if (std::find(key.choices.begin(), key.choices.end(), text) != key.choices.end()) return true;
    const std::string known = fmt::format("{}", fmt::join(key.choices, ", "));
    if (std::find(key.later.begin(), key.later.end(), text) != key.later.end())
      return wrong(node, fmt::format("'{}': '{}' is not in this version of obscura yet, which has {}",
                                     key.last(), text, known));
    return wrong(node, fmt::format("'{}': expected one of {}, got {}{}", key.last(), known, quoted(text),
                                   did_you_mean(text, {key.choices.begin(), key.choices.end()})));
  }

  bool choice(const Node& node, const Key& key) {
    return node.is_text() ? word(node, key) : mistyped(node, key, expected(key, told_.n));
  }

  bool choices(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Node& each : node.list())
      good = (each.is_text() ? word(each, key) : mistyped(each, key, "a string")) && good;
    return good;
  }

  bool color(const Node& node, const Key& key) {
    if (node.is_list()) {
      if (node.list().empty())
        return wrong(node, fmt::format("'{}': expected a colour at least", key.last()));
      bool good = true;
      for (const Node& each : node.list()) good = one_color(each, key) && good;
      return good;
    }
    return one_color(node, key);
  }

  bool one_color(const Node& node, const Key& key) {
    if (!node.is_text()) return mistyped(node, key, expected(key, told_.n));
    if (draw::color(node.text())) return true;
    const std::string hint = did_you_mean(node.text(), {std::begin(kColors), std::end(kColors)});
    return wrong(node, fmt::format("'{}': {} is no colour{}", key.last(), quoted(node.text()),
                                   hint.empty() ? fmt::format("; expected \"#rrggbb\" or one of {}",
                                                              fmt::join(kColors, ", "))
                                                : hint));
  }

  // every component of a list of numbers
  bool components(const Node& node, const Key& key) {
    bool good = true;
    for (const Node& each : node.list())
      good = (each.is_number() ? number(each, key) : mistyped(each, key, "numbers")) && good;
    return good;
  }

  bool vector(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    if (!components(node, key)) return false;
    const std::size_t n = node.list().size();
    if (n != 2 && n != 3)
      return wrong(node,
                   fmt::format("'{}': expected {}, got {} of them", key.last(), expected(key, told_.n), n));
    if (!fits(node, key.path, n)) return false;
    if (key.last() == "normal" && zero(node))
      return wrong(node, fmt::format("'normal' is zero: expected the direction into the room, such as {}",
                                     told_.n == 2 ? "[0, 1]" : "[0, 1, 0]"));
    return true;
  }

  static bool zero(const Node& node) {
    return std::all_of(node.list().begin(), node.list().end(), [](const Node& c) { return c.number() == 0; });
  }

  // a number in the plane, a vector in space
  bool spin(Node& node, const Key& key) {
    if (told_.n == 2) return node.is_number() ? number(node, key) : varied(node, key);
    if (node.is_number())
      return wrong(node, fmt::format("'{}' is one number, as in the plane, and {}: expected {}", key.last(),
                                     because(), expected(key, told_.n)));
    const Key whole{.path = key.path, .form = Form::vector, .unit = key.unit, .varies = key.varies};
    return value(node, whole);
  }

  // three turns, or an axis and an angle
  bool turn(Node& node, const Key& key) {
    if (node.is_list())
      return node.list().size() == 3
                 ? components(node, key)
                 : wrong(node, fmt::format("'{}': expected {}, got {} numbers", key.last(),
                                           expected(key, told_.n), node.list().size()));
    if (!node.is_table()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (Entry& entry : node.table()) {
      if (entry.key == "axis") {
        good = vector(entry.node, {.path = "axis", .form = Form::vector}) && good;
        if (good && zero(entry.node))
          good = wrong(entry.node, "'axis' is zero: expected a direction such as [0, 1, 0]");
      } else if (entry.key == "angle") {
        good = number(entry.node, {.path = "angle", .form = Form::number, .unit = "deg"}) && good;
      } else {
        complaints_.add(entry.place, fmt::format("unknown key {} in an orientation{}", quoted(entry.key),
                                                 did_you_mean(entry.key, {"axis", "angle"})));
        good = false;
      }
    }
    if (good && (!node.find("axis") || !node.find("angle")))
      return wrong(node, fmt::format("'{}': expected {}", key.last(), expected(key, told_.n)));
    return good;
  }

  // over copies: { from = a, to = b }, or a list with one for each
  bool varied(Node& node, const Key& key) {
    if (node.is_list()) return components(node, key);
    if (!node.is_table()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Entry& entry : node.table()) {
      if (entry.key == "from" || entry.key == "to") continue;
      complaints_.add(entry.place,
                      fmt::format("unknown key {} in '{}': expected {{ from, to }} over copies, or {}",
                                  quoted(entry.key), key.last(), expected(key, told_.n)));
      good = false;
    }
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

  bool pixels(const Node& node, const Key& key) {
    if (!node.is_list() || node.list().size() != 2) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Node& each : node.list()) good = integer(each, key) && good;
    return good;
  }

  bool count(const Node& node, const Key& key) {
    if (!node.is_list())
      return node.is_number() ? integer(node, key) : mistyped(node, key, expected(key, told_.n));
    if (node.list().empty() || int(node.list().size()) > told_.n)
      return wrong(node, fmt::format("'{}': expected {}, got {} numbers", key.last(), expected(key, told_.n),
                                     node.list().size()));
    bool good = true;
    for (const Node& each : node.list()) good = integer(each, key) && good;
    return good;
  }

  bool offset(const Node& node, const Key& key) {
    if (!node.is_list() || node.list().empty()) return mistyped(node, key, expected(key, told_.n));
    if (!node.list().front().is_list()) return vector(node, key);
    bool good = true;
    for (const Node& each : node.list()) good = vector(each, key) && good;
    return good;
  }

  bool points(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    if (int(node.list().size()) < told_.n + 1)
      return wrong(node, fmt::format("'{}': expected {}, got {}", key.last(), expected(key, told_.n),
                                     node.list().size()));
    bool good = true;
    for (const Node& each : node.list()) good = vector(each, key) && good;
    return good;
  }

  bool pairs(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Node& pair : node.list()) {
      const bool two =
          pair.is_list() && pair.list().size() == 2 && pair.list()[0].is_text() && pair.list()[1].is_text();
      if (!two) good = mistyped(pair, key, "pairs of names such as [\"stones\", \"frame\"]");
    }
    return good;
  }

  bool things(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Node& each : node.list())
      if (!each.is_text()) good = mistyped(each, key, "names of bodies such as \"plank[*]\"");
    return good;
  }

  bool limits(const Node& node, const Key& key) {
    if (!node.is_list() || node.list().size() != 2) return mistyped(node, key, expected(key, told_.n));
    if (!components(node, key)) return false;
    const double low = node.list()[0].number(), high = node.list()[1].number();
    if (low > high)
      return wrong(node,
                   fmt::format("'{}': the lowest comes first, got {} before {}", key.last(), low, high));
    return (low <= 0 && high >= 0) ||
           wrong(node, fmt::format("'{}' leave out where it starts: expected 0 between {} and {}", key.last(),
                                   low, high));
  }

  bool ends(Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    if (node.list().size() != 2)
      return wrong(node, fmt::format("'{}': expected {}, got {} of them", key.last(), expected(key, told_.n),
                                     node.list().size()));
    bool good = true;
    for (Node& each : node.list()) good = end(each, key) && good;
    return good;
  }

  bool end(Node& node, const Key& key) {
    if (node.is_text()) return true;
    if (node.is_list()) return vector(node, key);
    const std::string what = fmt::format("a body's name, {{ body = \"name\", local = {0} }} or a place {0}",
                                         told_.n == 2 ? "[x, y]" : "[x, y, z]");
    if (!node.is_table()) return mistyped(node, key, what);
    bool good = true;
    for (Entry& entry : node.table()) {
      if (entry.key == "body" || entry.key == "at") {
        if (!entry.node.is_text())
          good = mistyped(entry.node, {.path = entry.key, .form = Form::text}, "a string");
      } else if (entry.key == "local") {
        good = vector(entry.node, {.path = "local", .form = Form::vector, .unit = "m"}) && good;
      } else {
        complaints_.add(entry.place, fmt::format("unknown key {} in an end{}", quoted(entry.key),
                                                 did_you_mean(entry.key, {"body", "local", "at"})));
        good = false;
      }
    }
    if (!node.find("body"))
      return wrong(node, fmt::format("'{}': expected {}, got a table without 'body'", key.last(), what));
    if (node.find("local") && node.find("at"))
      return wrong(node, "'local' and 'at' both say where on the body; leave one out");
    return good;
  }

  bool times(const Node& node, const Key& key) {
    if (!node.is_list()) return rational(node, key);
    if (node.list().empty()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Node& each : node.list()) good = rational(each, key) && good;
    return good;
  }

  bool path(const Node& node, const Key& key) {
    if (!node.is_list()) return mistyped(node, key, expected(key, told_.n));
    if (node.list().size() < 2)
      return wrong(node, fmt::format("'{}': expected {}, got {}", key.last(), expected(key, told_.n),
                                     node.list().size()));
    bool good = true;
    const Node* before = nullptr;
    for (const Node& knot : node.list()) {
      if (!knot.is_list() || knot.list().empty()) {
        good =
            mistyped(knot, key, told_.n == 2 ? "a point in time [t, x, y]" : "a point in time [t, x, y, z]");
        continue;
      }
      if (!components(knot, key)) {
        good = false;
        continue;
      }
      const std::size_t n = knot.list().size() - 1;
      if (n != 2 && n != 3) {
        good = wrong(
            knot, fmt::format("'{}': expected {}, got {}", key.last(),
                              told_.n == 2 ? "three numbers [t, x, y]" : "four numbers [t, x, y, z]", n + 1));
        continue;
      }
      if (!fits(knot, "place after the time in path", n)) {
        good = false;
        continue;
      }
      const Node& time = knot.list().front();
      good = rational(time, {.path = "time", .form = Form::rational, .unit = "s", .range = {0, 1e6}}) && good;
      if (before && time.number() <= before->number())
        good = wrong(time, fmt::format("times must increase along the path, got {} after {}", described(time),
                                       described(*before)));
      before = &time;
    }
    return good;
  }

  bool trails(const Node& node, const Key& key) {
    const Key seconds{.path = "trails", .form = Form::number, .unit = "s", .range = {0, 1e6}};
    if (node.is_number()) return number(node, seconds);
    if (!node.is_table()) return mistyped(node, key, expected(key, told_.n));
    bool good = true;
    for (const Entry& entry : node.table()) good = number(entry.node, seconds) && good;
    return good;
  }

  const Dimension& told_;
  Complaints& complaints_;
};

}  // namespace

void check(Node& top, const Dimension& told, Complaints& complaints) {
  Checker(told, complaints).table(top, "");
}

void check(Node& table, const std::string& owner, const Dimension& told, Complaints& complaints) {
  Checker(told, complaints).table(table, owner);
}

std::string quoted(std::string_view word) {
  // cut where a code point ends
  std::size_t most = std::min<std::size_t>(word.size(), 64);
  while (most > 0 && most < word.size() && (static_cast<unsigned char>(word[most]) & 0xC0) == 0x80) --most;
  std::string text = "'";
  for (const char c : word.substr(0, most)) text += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  return text + (word.size() > most ? "...'" : "'");
}

}  // namespace obscura::scene
