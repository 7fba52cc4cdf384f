#include "scene/overrides.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "scene/body_kinds.h"
#include "scene/dimension.h"
#include "scene/table.h"

namespace obscura::scene {

namespace {

// the tables whose names --set knows
std::vector<std::string_view> named_tables() {
  std::vector<std::string_view> all;
  for (const BodyKind& kind : body_kinds()) all.push_back(kind.name);
  for (const std::string_view other : {"spring", "net", "joint", "chain", "bond", "explosion", "force",
                                       "attractor", "mouse", "when", "track"})
    all.push_back(other);
  return all;
}

void settle(Node& node, Place place) {
  node.place = place;
  node.header = false;
  if (node.is_list())
    for (Node& each : node.list()) settle(each, place);
  if (node.is_table())
    for (Entry& each : node.table()) each.place = place, settle(each.node, place);
}

// the value as TOML; a bare word is a string
std::optional<Node> read_value(std::string_view text, Place place, Diagnostics& complaints) {
  std::string reason;
  if (text.empty()) {
    complaints.add(place, "expected a value after =");
    return {};
  }
  try {
    Node top = document("value = " + std::string(text), "");
    if (top.table().size() == 1 && top.table().front().key == "value" &&
        text.find('\n') == std::string_view::npos) {
      Node value = std::move(top.table().front().node);
      settle(value, place);
      return value;
    }
  } catch (const Error& error) {
    reason = error.complaints.front().message;
  }
  // brackets and quotes were meant as TOML; the rest are words
  if (std::string_view("[{\"'").find(text.front()) != std::string_view::npos ||
      text.find('\n') != std::string_view::npos) {
    complaints.add(place, reason.empty() ? "expected one value after =" : reason);
    return {};
  }
  Node word;
  word.value = std::string(text);
  settle(word, place);
  return word;
}

// x, y, z of a vector
std::optional<std::size_t> component(const std::string& name) {
  if (name == "x") return 0;
  if (name == "y") return 1;
  if (name == "z") return 2;
  return {};
}

struct NamedTable {
  std::string kind;
  int table = 0;
};

std::optional<NamedTable> named(const Node& top, const std::string& name) {
  for (const std::string_view kind : named_tables()) {
    const Node* all = top.find(kind);
    if (!all || !all->is_list()) continue;
    for (std::size_t i = 0; i < all->list().size(); ++i) {
      const Node* its = all->list()[i].find("name");
      if (its && its->is_text() && its->text() == name) return NamedTable{std::string(kind), int(i)};
    }
  }
  return {};
}

// the first words that a path may have
std::string starts(const Node& top, const std::string& word) {
  std::vector<std::string_view> words;
  for (const Key* each : keys_of("")) words.push_back(each->last());
  for (const std::string_view kind : named_tables())
    if (const Node* all = top.find(kind); all && all->is_list())
      for (const Node& each : all->list())
        if (const Node* its = each.find("name"); its && its->is_text()) words.push_back(its->text());
  return did_you_mean(word, words);
}

}  // namespace

void write(Node& table, const std::string& owner, const std::vector<Step>& path, Node value, Place place,
           int dimension, Diagnostics& complaints) {
  Node* here = &table;
  std::string at = owner;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Step& step = path[i];
    const bool last = i + 1 == path.size();

    // into a table by key, into a list of numbers by component
    if (here->is_list()) {
      const auto n = component(step.name);
      if (!n || !step.indices.empty() || *n >= here->list().size())
        return complaints.add(place, fmt::format("a list has no {}; expected {}", in_quotes(step.name),
                                                 dimension == 2 ? "x or y" : "x, y or z"));
      here = &here->list()[*n];
    } else if (here->is_table()) {
      at += (at.empty() ? "" : ".") + step.name;
      Node* next = here->find(step.name);
      if (!next) {
        const Key* known = key(at);
        const bool part = !(last && step.indices.empty());
        if (part && known && known->form == Form::vector && known->fallback.empty())
          return complaints.add(place, fmt::format("'{0}' is not set; give the whole, {0}={1}", step.name,
                                                   dimension == 2 ? "[x, y]" : "[x, y, z]"));
        Node fresh =
            part && known && !known->fallback.empty() ? fallback(at, dimension) : Node{place, Node::Table{}};
        settle(fresh, place);
        here->table().push_back({step.name, place, std::move(fresh)});
        next = &here->table().back().node;
      }
      if (last && step.indices.empty())
        for (Entry& each : here->table())
          if (each.key == step.name) each.place = place;
      here = next;
    } else {
      return complaints.add(
          place, fmt::format("{} is asked of {}, which is no table", in_quotes(step.name), described(*here)));
    }

    // into a list by index
    for (const std::int64_t index : step.indices) {
      if (!here->is_list()) return complaints.add(place, fmt::format("{} is no list", in_quotes(step.name)));
      if (index >= std::int64_t(here->list().size()))
        return complaints.add(place, fmt::format("{}[{}]: there are {}, numbered from 0", step.name, index,
                                                 here->list().size()));
      here = &here->list()[std::size_t(index)];
    }
  }
  *here = std::move(value);
}

std::vector<CopySet> apply(const std::vector<std::string>& sets, Node& top, Diagnostics& complaints) {
  std::vector<CopySet> later;
  const int dim = dimension(top).n;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    const Place place{int(k) + 1, 0, 0};
    const std::size_t equals = sets[k].find('=');
    if (equals == std::string::npos) {
      complaints.add(place, "expected KEY=VALUE, such as crate.elasticity=0.5");
      continue;
    }
    const auto steps = path(std::string_view(sets[k]).substr(0, equals));
    if (!steps) {
      complaints.add(
          place, "is not a path; expected one such as crate.elasticity, room.gravity or ball[3].position.y");
      continue;
    }
    std::string_view text = std::string_view(sets[k]).substr(equals + 1);
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    auto value = read_value(text, place, complaints);
    if (!value) continue;

    const Step& first = steps->front();
    const std::vector<Step> rest(steps->begin() + 1, steps->end());
    const Key* known = key(first.name);
    if (known && known->form != Form::tables) {
      write(top, "", *steps, std::move(*value), place, dim, complaints);
      continue;
    }

    // a thing: by its name, or by the place of its table in the file
    NamedTable found;
    std::optional<std::int64_t> copy;
    if (const auto it = named(top, first.name)) {
      found = *it;
      if (!first.indices.empty()) copy = first.indices[0];
    } else if (known) {
      const Node* all = top.find(first.name);
      const std::size_t n = all && all->is_list() ? all->list().size() : 0;
      if (first.indices.empty() || first.indices[0] >= std::int64_t(n)) {
        complaints.add(
            place, n == 0
                       ? fmt::format("the scene has no [[{}]]", first.name)
                       : fmt::format("which of them? The scene has {} [[{}]]: {}[0]{}", n, first.name,
                                     first.name, n > 1 ? fmt::format(" .. {}[{}]", first.name, n - 1) : ""));
        continue;
      }
      found = {first.name, int(first.indices[0])};
      if (first.indices.size() > 1) copy = first.indices[1];
    } else {
      complaints.add(place,
                     fmt::format("nothing here is called {}{}", in_quotes(first.name), starts(top, first.name)));
      continue;
    }
    if (rest.empty()) {
      complaints.add(place, fmt::format("expected a key of {}, such as {}.{}=...", in_quotes(first.name),
                                        first.name, keys_of(found.kind)[1]->last()));
      continue;
    }
    Node& table = top.find(found.kind)->list()[std::size_t(found.table)];
    if (!table.is_table()) continue;
    if (copy) {
      later.push_back({found.kind, found.table, int(std::min<std::int64_t>(*copy, 1'000'000'000)), rest,
                       std::move(*value), place});
    } else {
      // what says how heavy it is takes the place of what said so
      const std::string& set = rest.front().name;
      if (const char* other = set == "mass"      ? "density"
                              : set == "density" ? "mass"
                                                 : nullptr;
          other && rest.size() == 1)
        std::erase_if(table.table(), [&](const auto& entry) { return entry.key == other; });
      write(table, found.kind, rest, std::move(*value), place, dim, complaints);
    }
  }
  return later;
}

}  // namespace obscura::scene
