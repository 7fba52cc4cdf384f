#include "scene/expressions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace obscura::scene {

namespace {

constexpr std::size_t kMostPlain = 30, kMostOfThings = 6;  // names that a message lists

// where a column of an expression is in the file, if that is known
Place column_of(const Node& node, int column) {
  Place place = node.place;
  if (node.inside > 0) place.column += node.inside + column - 1;
  return place;
}

// the names that an expression may read: all plain ones, and some of bodies and joints
std::string what_there_is(const std::vector<std::string>& names) {
  const auto functions = sim::expression_functions();
  std::vector<std::string_view> plain, of_things;
  for (const std::string& name : names) {
    if (name.find('.') != std::string::npos)
      of_things.push_back(name);
    else if (std::find(functions.begin(), functions.end(), name) == functions.end())
      plain.push_back(name);
  }
  if (plain.size() > kMostPlain) return "";
  const bool more = of_things.size() > kMostOfThings;
  if (more) of_things.resize(kMostOfThings);
  plain.insert(plain.end(), of_things.begin(), of_things.end());
  return plain.empty() ? "" : fmt::format("; there are {}{}", fmt::join(plain, ", "), more ? ", ..." : "");
}

}  // namespace

std::string typed(const Node& node) {
  return node.is_text() ? node.text() : fmt::format("{:.17g}", node.number());
}

void complain(const Node& node, std::string_view key, const sim::ExpressionFault& fault,
              const std::vector<std::string>& names, Diagnostics& complaints) {
  std::vector<std::string_view> words;
  for (const std::string& name : names) {
    const auto all = sim::expression_functions();
    const bool function = std::find(all.begin(), all.end(), name) != all.end();
    if (function == fault.function) words.push_back(name);
  }
  // a name that is called may be meant as a number, and the other way round
  std::string hint = fault.word.empty() ? "" : did_you_mean(fault.word, words);
  if (hint.empty() && !fault.word.empty())
    hint = did_you_mean(fault.word, std::vector<std::string_view>(names.begin(), names.end()));
  if (hint.empty() && !fault.word.empty() && !fault.function) hint = what_there_is(names);
  complaints.add(column_of(node, fault.column),
                 fmt::format("'{}', column {}: {}{}", key, fault.column, fault.message, hint));
}

Constants::Constants(const Node& top, Diagnostics& complaints) : top_(top), complaints_(complaints) {
  const Node* all = top_.find("constants");
  if (!all) return;
  const std::vector<std::string> taken = sim::expression_names();
  for (const Entry& entry : all->table()) {
    if (std::find(taken.begin(), taken.end(), entry.key) != taken.end()) {
      complaints_.add(entry.place,
                      fmt::format("'{}' is a word of expressions; choose another name", entry.key));
      continue;
    }
    sim::ExpressionGraph graph;
    std::vector<sim::Symbol> symbols;
    std::vector<std::string> names;
    for (const auto& [name, value] : numbers_)
      symbols.push_back({name, graph.number(value)}), names.push_back(name);
    for (const std::string& name : taken)
      symbols.push_back({name, -1, "changes in the run, and a constant does not"});
    const std::string text = typed(entry.node);
    texts_.push_back(text);
    const auto node = sim::parse_expression(text, symbols, graph);
    if (const auto* fault = std::get_if<sim::ExpressionFault>(&node)) {
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      complain(entry.node, entry.key, *fault, names, complaints_);
      continue;
    }
    const double value = graph[std::get<int>(node)].value;
    if (!std::isfinite(value)) {
      complaints_.add(entry.node.place, fmt::format("'{}' is no finite number", entry.key));
      continue;
    }
    numbers_.emplace_back(entry.key, value);
  }
}

void Constants::refuse_unused() const {
  const Node* all = top_.find("constants");
  if (!all) return;
  std::vector<std::string_view> names;
  for (const Entry& entry : all->table())
    if (entry.place.set == 0) names.push_back(entry.key);
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  for (const Entry& entry : all->table()) {
    if (entry.place.set == 0) continue;
    bool used = false;
    for (const std::string& text : texts_) {
      for (std::size_t at = 0; (at = text.find(entry.key, at)) != std::string::npos; ++at) {
        const std::size_t end = at + entry.key.size();
        used = used || ((at == 0 || !letter(text[at - 1])) && (end == text.size() || !letter(text[end])));
      }
    }
    if (!used)
      complaints_.add(entry.place, fmt::format("no expression reads the constant {}{}", in_quotes(entry.key),
                                               did_you_mean(entry.key, names)));
  }
}

}  // namespace obscura::scene
