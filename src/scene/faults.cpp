#include "scene/faults.h"

#include <fmt/format.h>

#include "sim/math/rational.h"

namespace obscura::scene {

namespace {

bool takes_numbers(Form form) {
  return form == Form::number || form == Form::integer || form == Form::vector || form == Form::pixels ||
         form == Form::count || form == Form::path || form == Form::spin;
}

// for a formula of what does not change as it says
std::string_view instead_of_formula(std::string_view key, std::string_view text) {
  if (text != "t" && text.find_first_of("+-*/^(") == text.npos) return "";
  if (key == "mass") return "; a mass stays the same in a run: what it would change can be a [[force]]";
  if (key == "position" || key == "velocity" || key == "angle" || key == "spin")
    return "; what moves by a formula has a 'motion'";
  return "";
}

}  // namespace

bool Reporter::wrong(const Node& node, std::string message) {
  complaints_.add(node.place, std::move(message));
  return false;
}

bool Reporter::mistyped(const Node& node, const Key& key, const std::string& what) {
  // a number in quotes: the value was right, its form was not
  const bool in_quotes = takes_numbers(key.form) && node.is_text() && sim::parse_rational(node.text());
  // [[contact]] for [contact]
  const bool doubled = what == "a table" && node.is_list() && node.header;
  const std::string_view formula =
      node.is_text() && takes_numbers(key.form) ? instead_of_formula(key.last(), node.text()) : "";
  return instead(node, key, what,
                 described(node) + (in_quotes ? "; write it without the quotes"
                                    : doubled ? fmt::format("; write [{}], once", key.path)
                                              : std::string(formula)));
}

bool Reporter::instead(const Node& node, const Key& key, const std::string& what, const std::string& got) {
  return wrong(node, fmt::format("'{}': expected {}, got {}", key.last(), what, got));
}

bool Reporter::unknown(const Entry& entry, const std::string& in, const std::string& hint) {
  complaints_.add(entry.place, fmt::format("unknown key {} in {}{}", in_quotes(entry.key), in, hint));
  return false;
}

std::string Reporter::because() const {
  if (told_.key.empty()) return "no position in this scene has three numbers";
  return fmt::format("'{}' at {} has {}", told_.key.substr(told_.key.rfind('.') + 1),
                     complaints_.text(told_.place), told_.n);
}

}  // namespace obscura::scene
