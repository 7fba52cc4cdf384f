#include "scene/difference.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/overrides.h"

namespace obscura::scene {

namespace {

// a value as TOML
std::string literal(const Node& node) {
  if (node.is_text()) return "\"" + node.text() + "\"";
  if (const double* real = std::get_if<double>(&node.value)) return fmt::format("{}", *real);
  if (node.is_list()) {
    std::string text = "[";
    for (const Node& each : node.list()) text += (text.size() > 1 ? ", " : "") + literal(each);
    return text + "]";
  }
  if (node.is_table()) {
    std::string text = "{";
    for (const Entry& each : node.table())
      text += (text.size() > 1 ? ", " : " ") + each.key + " = " + literal(each.node);
    return text + " }";
  }
  return described(node);
}

// enough of it, on one line, to be known again
std::string cut(const std::string& value) {
  constexpr std::size_t kMost = 60;
  const std::string text = one_line(value);
  return text.size() <= kMost ? text : text.substr(0, kMost) + "...";
}

const std::string* name(const Node& table) {
  const Node* its = table.find("name");
  return its && its->is_text() ? &its->text() : nullptr;
}

bool tables(const Node& node) {
  return node.is_list() && !node.list().empty() &&
         std::all_of(node.list().begin(), node.list().end(), [](const Node& n) { return n.is_table(); });
}

void compare(const std::string& path, const Node* a, const Node* b, std::vector<KeyDifference>& found);

std::string under(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

void compare_tables(const std::string& path, const Node& a, const Node& b,
                    std::vector<KeyDifference>& found) {
  for (const Entry& each : a.table()) compare(under(path, each.key), &each.node, b.find(each.key), found);
  for (const Entry& each : b.table())
    if (!a.find(each.key)) compare(under(path, each.key), nullptr, &each.node, found);
}

// compares lists of tables such as [[box]]: by name, those without one by their position
void compare_lists(const std::string& path, const Node& a, const Node& b, std::vector<KeyDifference>& found) {
  const auto twin = [](const Node& of, std::size_t place, const Node& in) -> const Node* {
    if (const std::string* its = name(of)) {
      for (const Node& each : in.list())
        if (const std::string* other = name(each); other && *other == *its) return &each;
      return nullptr;
    }
    return place < in.list().size() && !name(in.list()[place]) ? &in.list()[place] : nullptr;
  };
  const auto called = [&](const Node& of, std::size_t place) {
    const std::string* its = name(of);
    return its ? *its : fmt::format("{}[{}]", path, place);
  };
  for (std::size_t i = 0; i < a.list().size(); ++i) {
    const Node& each = a.list()[i];
    compare(called(each, i), &each, twin(each, i, b), found);
  }
  for (std::size_t i = 0; i < b.list().size(); ++i)
    if (const Node& each = b.list()[i]; !twin(each, i, a)) compare(called(each, i), nullptr, &each, found);
}

void compare(const std::string& path, const Node* a, const Node* b, std::vector<KeyDifference>& found) {
  if (a && b) {
    if (a->is_table() && b->is_table()) return compare_tables(path, *a, *b, found);
    if (tables(*a) && tables(*b)) return compare_lists(path, *a, *b, found);
    // 2 and 2.0 are one number
    if (a->is_number() && b->is_number() && a->number() == b->number()) return;
  } else if (const Node& one = a ? *a : *b; one.is_table() && !name(one)) {
    const Node none{one.place, Node::Table{}};
    return compare_tables(path, a ? *a : none, b ? *b : none, found);
  }
  const std::string left = a ? cut(literal(*a)) : "", right = b ? cut(literal(*b)) : "";
  if (a && b ? literal(*a) != literal(*b) : a != b) found.push_back({one_line(path), left, right});
}

Node read_source(const Source& source, Diagnostics& complaints) {
  Node top = document(source.text, "");
  apply(source.sets, top, complaints);
  return top;
}

}  // namespace

std::vector<KeyDifference> differences(const Source& a, const Source& b) {
  Diagnostics complaints("", {});
  std::vector<KeyDifference> found;
  const Node left = read_source(a, complaints), right = read_source(b, complaints);
  compare_tables("", left, right, found);
  return found;
}

}  // namespace obscura::scene
