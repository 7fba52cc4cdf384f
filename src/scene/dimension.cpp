#include "scene/dimension.h"

#include <algorithm>
#include <optional>

#include "scene/table.h"

namespace obscura::scene {

namespace {

using Told = std::optional<Dimension>;

// the dimension that a list of numbers implies; `beside` of them are not components
Told list(const Node& node, const std::string& key, std::size_t beside = 0) {
  if (!node.is_list()) return {};
  const Node::List& all = node.list();
  const std::size_t n = all.size() - std::min(beside, all.size());
  if ((n != 2 && n != 3) || !std::all_of(all.begin(), all.end(), [](const Node& c) { return c.is_number(); }))
    return {};
  return Dimension{int(n), key, node.place};
}

Told table(const Node& node, const std::string& owner);

Told first(const Node& node, const std::string& key, std::size_t beside = 0) {
  if (!node.is_list()) return {};
  for (const Node& each : node.list())
    if (Told told = list(each, key, beside)) return told;
  return {};
}

// an end of a spring or joint: a place, or { body, local }
Told ends(const Node& node, const std::string& key) {
  if (!node.is_list()) return {};
  for (const Node& each : node.list()) {
    const Node* local = each.find("local");
    if (Told told = list(local ? *local : each, local ? "local" : key)) return told;
  }
  return {};
}

Told value(const Node& node, const Key& key) {
  switch (key.form) {
    case Form::table:
      return node.is_table() ? table(node, key.path) : Told{};
    case Form::cameras:
      if (node.is_table()) return table(node, key.path);
      [[fallthrough]];
    case Form::walls:
    case Form::tables:
      if (!node.is_list()) return {};
      for (const Node& each : node.list())
        if (each.is_table())
          if (Told told = table(each, key.path)) return told;
      return {};
    case Form::vector:
      for (const char* end : {"from", "to"})
        if (const Node* it = node.find(end))
          if (Told told = list(*it, key.path)) return told;
      return list(node, key.path);
    case Form::offset:
    case Form::points:
      if (Told told = first(node, key.path)) return told;
      return key.form == Form::offset ? list(node, key.path) : Told{};
    case Form::ends:
    case Form::places:
      return ends(node, key.path);
    case Form::curve:
      if (!node.is_list()) return {};
      for (const Node& each : node.list()) {
        for (const char* part : {"to", "through"})
          if (const Node* it = each.find(part))
            if (Told told = list(*it, key.path)) return told;
        if (const Node* it = each.find("spline"))
          if (Told told = first(*it, key.path)) return told;
        if (Told told = list(each, key.path)) return told;
      }
      return {};
    case Form::path:
      return first(node, "place after the time in path", 1);
    default:
      return {};
  }
}

Told table(const Node& node, const std::string& owner) {
  for (const Entry& entry : node.table()) {
    const Key* known = key(owner.empty() ? entry.key : owner + '.' + entry.key);
    if (!known) continue;
    if (Told told = value(entry.node, *known)) return told;
  }
  return {};
}

}  // namespace

Dimension dimension(const Node& top) {
  if (const Node* room = top.find("room"))
    if (const Node* size = room->find("size"))
      if (const Told told = list(*size, "room.size")) return *told;
  return table(top, "").value_or(Dimension{});
}

}  // namespace obscura::scene
