#include "app/run/variation.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "draw/page/measure.h"
#include "sim/math/rational.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kMostValues = 1'000'000;  // of a key
constexpr std::size_t kLongNumber = 10;          // characters: a longer one is rounded where it is shown
constexpr int kDigits = 9;
constexpr std::string_view kFlag = "--set ";  // as complaints name it

// "0.3" as a person types it, "1/3" as the nearest number
std::string typed(sim::Rational r) {
  return r.den == 1 ? fmt::format("{}", r.num) : fmt::format("{}", sim::value(r));
}

// "0:1:0.1", "1:100": a range with both ends; nothing where it is another value
std::optional<std::vector<std::string>> range(std::string_view value, std::string_view text) {
  std::vector<sim::Rational> parts;
  for (std::string_view rest = value;;) {
    const auto colon = rest.find(':');
    const auto part = sim::parse_rational(rest.substr(0, colon));
    if (!part) return {};
    parts.push_back(*part);
    if (colon == rest.npos) break;
    rest.remove_prefix(colon + 1);
  }
  if (parts.size() == 1) return {};
  if (parts.size() > 3)
    throw UsageError(fmt::format("--vary {}: a range is from:to or from:to:stride", text));
  const sim::Rational from = parts[0], to = parts[1], by = parts.size() == 3 ? parts[2] : sim::rational(1);
  if (by.num == 0) throw UsageError(fmt::format("--vary {}: a range's stride must not be 0", text));
  const double n = (sim::value(to) - sim::value(from)) / sim::value(by);
  if (n < 0)
    throw UsageError(fmt::format("--vary {}: {} runs backwards: with a stride {} 0 it would not", text, value,
                                 by.num < 0 ? "above" : "below"));
  if (parts.size() == 2 && n != std::floor(n))
    throw UsageError(fmt::format("--vary {}: {} goes by 1, and so not to {}: give a stride, as in {}:{}",
                                 text, value, typed(to), value, typed((to - from) / sim::rational(10))));
  if (n > double(kMostValues))
    throw UsageError(
        fmt::format("--vary {}: {} has {:.0f} values, more than {}", text, value, n, kMostValues));
  std::vector<std::string> values;
  for (std::int64_t i = 0, last = sim::floor((to - from) / by); i <= last; ++i)
    values.push_back(typed(from + sim::rational(i) * by));
  return values;
}

}  // namespace

Variation::Variation(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == text.npos || equals + 1 == text.size())
    throw UsageError(
        fmt::format("--vary {}: expected PATH=VALUES, as in crate.elasticity=0,0.5,1 or seed=1:100", text));
  path = text.substr(0, equals);
  const std::string_view list = text.substr(equals + 1);
  // commas within brackets are a value's own
  std::size_t depth = 0, from = 0;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size() && list[i] == '[') ++depth;
    if (i < list.size() && list[i] == ']' && depth > 0) --depth;
    if (i < list.size() && (list[i] != ',' || depth > 0)) continue;
    const std::string_view value = list.substr(from, i - from);
    if (const auto several = range(value, text))
      values.insert(values.end(), several->begin(), several->end());
    else
      values.emplace_back(value);
    from = i + 1;
  }
}

Variations::Variations(const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    const Variation one(text);
    for (const Variation& other : keys)
      if (other.path == one.path) throw UsageError(fmt::format("--vary {}: it is varied twice", one.path));
    if (one.values.empty()) throw UsageError(fmt::format("--vary {}: it has no values", text));
    if (size > kMostRuns / std::int64_t(one.values.size()))
      throw UsageError(fmt::format("--vary: more than {} runs", kMostRuns));
    size *= std::int64_t(one.values.size());
    keys.push_back(one);
  }
}

std::vector<std::string> Variations::operator[](std::int64_t run) const {
  std::vector<std::string> values(keys.size());
  for (std::size_t k = keys.size(); k-- > 0;) {
    const auto n = std::int64_t(keys[k].values.size());
    values[k] = keys[k].values[std::size_t(run % n)];
    run /= n;
  }
  return values;
}

std::vector<std::string> Variations::sets(std::int64_t run, std::vector<std::string> sets) const {
  const std::vector<std::string> values = (*this)[run];
  for (std::size_t k = 0; k < keys.size(); ++k) {
    for (const std::string& set : sets) {
      // the same key, or a part of it
      std::string path = set.substr(0, set.find('='));
      path.erase(path.find_last_not_of(' ') + 1).erase(0, path.find_first_not_of(' '));
      if (path == keys[k].path || path.starts_with(keys[k].path + "."))
        throw UsageError(fmt::format("--set {}: it is varied", path));
    }
    sets.push_back(keys[k].path + "=" + values[k]);
  }
  return sets;
}

bool Variations::alone(const Variation& key) const {
  return std::count_if(keys.begin(), keys.end(),
                       [&](const Variation& other) { return other.name() == key.name(); }) == 1;
}

std::string Variations::words(std::int64_t run) const {
  const std::vector<std::string> values = (*this)[run];
  std::string text;
  for (std::size_t k = 0; k < keys.size(); ++k)
    text += (k ? ", " : "") + keys[k].words(values[k], !alone(keys[k]));
  return text;
}

std::string Variations::formula(std::int64_t run) const {
  const std::vector<std::string> values = (*this)[run];
  std::string text;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const bool number = sim::parse_rational(values[k]).has_value();
    const bool whose = !alone(keys[k]);
    text += k ? ", " : "";
    text += number ? keys[k].symbol(whose) + " = " + Variation::shown(values[k])
                   : '"' + keys[k].words(values[k], whose) + '"';
  }
  return text;
}

std::string Variation::spoken(const std::string& value) {
  static constexpr std::pair<std::string_view, const char*> kSpoken[] = {
      {"euler", "Euler"}, {"rk4", "Runge-Kutta"}, {"true", "yes"}, {"false", "no"}};
  for (const auto& [word, said] : kSpoken)
    if (value == word) return said;
  return draw::in_words(value);
}

std::string Variation::shown(const std::string& value) {
  const auto number = sim::parse_rational(value);
  return number && value.size() > kLongNumber ? fmt::format("{:.{}g}", sim::value(*number), kDigits) : value;
}

std::string Variation::words(const std::string& value, bool whose) const {
  const std::string key = spoken(whose ? path : name());
  if (value == "true") return key;
  if (value == "false") return "no " + key;
  const bool word = std::all_of(value.begin(), value.end(),
                                [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; }) &&
                    !value.empty() && std::isalpha(static_cast<unsigned char>(value[0]));
  return word ? spoken(value) : key + " = " + shown(value);
}

std::string Variation::name() const {
  auto dot = path.rfind('.');
  // a component, with what it is of
  if (dot != path.npos && dot > 0 && dot + 2 == path.size() && std::string_view("xyz").find(path.back()) < 3)
    dot = path.rfind('.', dot - 1);
  return dot == path.npos ? path : path.substr(dot + 1);
}

std::string Variation::symbol(bool whose) const {
  static constexpr std::pair<std::string_view, const char*> kSymbols[] = {
      {"angle", "\\theta"},  {"friction", "\\mu"},   {"elasticity", "e"},  {"mass", "m"},
      {"stiffness", "k"},    {"rest_length", "l_0"}, {"length", "l"},      {"radius", "r"},
      {"density", "\\rho"},  {"charge", "q"},        {"speed", "v"},       {"static_friction", "\\mu_s"},
      {"position.x", "x"},   {"position.y", "y"},    {"position.z", "z"},  {"velocity.x", "v_x"},
      {"velocity.y", "v_y"}, {"velocity.z", "v_z"},  {"gravity.x", "g_x"}, {"gravity.y", "g_y"},
      {"gravity.z", "g_z"}};
  static constexpr std::string_view kSections[] = {"physics", "room", "contact", "film", "look", "camera"};
  const std::string key = name();
  std::string of = path.substr(0, path.size() > key.size() ? path.size() - key.size() - 1 : 0);
  const auto quoted = [](const std::string& text) { return '"' + spoken(text) + '"'; };
  const auto found = std::find_if(std::begin(kSymbols), std::end(kSymbols),
                                  [&](const auto& each) { return each.first == key; });
  if (found == std::end(kSymbols)) return quoted(key);
  const std::string symbol = found->second;
  const bool section = std::find(std::begin(kSections), std::end(kSections), of) != std::end(kSections);
  if (!whose || of.empty() || section || symbol.find('_') != symbol.npos) return symbol;
  return symbol + "_{" + quoted(of) + "}";
}

double Variation::number(const std::string& value) const {
  const auto found = sim::parse_rational(value);
  if (!found) throw UsageError(fmt::format("a plot over {}: {} is no number", path, value));
  return sim::value(*found);
}

bool is_of(const scene::Complaint& it, const std::string& set) {
  constexpr std::string_view kCut = "...";
  std::string_view named = it.file;
  if (!named.starts_with(kFlag)) return false;
  named.remove_prefix(kFlag.size());
  if (named == set) return true;
  return named.ends_with(kCut) && set.starts_with(named.substr(0, named.size() - kCut.size()));
}

std::string of_range(const std::string& set) {
  const std::string_view value = std::string_view(set).substr(std::min(set.find('='), set.size() - 1) + 1);
  const std::size_t dots = value.find("..");
  if (dots == value.npos) return {};
  const std::string_view from = value.substr(0, dots), to = value.substr(dots + 2);
  if (!sim::parse_rational(from) || !sim::parse_rational(to)) return {};
  return fmt::format("; a range is from:to or from:to:stride, as in {}:{}", from, to);
}

scene::Error of_vary(const scene::Error& error, const std::vector<std::string>& values) {
  std::vector<scene::Complaint> all = error.complaints;
  for (scene::Complaint& each : all)
    for (const std::string& set : values) {
      if (!is_of(each, set)) continue;
      each.file.replace(0, kFlag.size(), "--vary "), each.message += of_range(set);
    }
  return scene::Error(std::move(all));
}

}  // namespace obscura::app
