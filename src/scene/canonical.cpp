#include "scene/canonical.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/complaints.h"
#include "scene/overrides.h"

namespace obscura::scene {

namespace {

// the length comes first, so that no text can be taken for another
void put_text(const std::string& words, std::string& out) {
  out += fmt::format("{}'{}", words.size(), words);
}

void put(const Node& node, std::string& out) {
  if (node.is_number()) {
    // 2 and 2.0 are one number, and so are 0 and -0.0
    out += fmt::format("{} ", node.number() == 0 ? 0.0 : node.number());
  } else if (const bool* flag = std::get_if<bool>(&node.value)) {
    out += *flag ? "t" : "f";
  } else if (node.is_text()) {
    put_text(node.text(), out);
  } else if (node.is_list()) {
    out += '[';
    for (const Node& each : node.list()) put(each, out);
    out += ']';
  } else if (node.is_table()) {
    std::vector<const Entry*> entries;
    for (const Entry& each : node.table()) entries.push_back(&each);
    std::sort(entries.begin(), entries.end(), [](const Entry* a, const Entry* b) { return a->key < b->key; });
    out += '{';
    for (const Entry* each : entries) put_text(each->key, out), put(each->node, out);
    out += '}';
  } else {
    out += 'd';
  }
}

}  // namespace

Node with_sets(const Source& source) {
  Diagnostics complaints("", source.sets);
  Node top = document(source.text, "");
  apply(source.sets, top, complaints);
  return top;
}

std::string canonical(const Source& source) {
  Diagnostics complaints("", source.sets);
  Node top = document(source.text, "");
  const std::vector<CopySet> copies = apply(source.sets, top, complaints);
  std::string out;
  put(top, out);
  // what is set on one of several copies
  for (const CopySet& each : copies) {
    out += fmt::format("{}[{}][{}]", each.kind, each.table, each.copy);
    for (const Step& step : each.path) {
      put_text(step.name, out);
      for (const std::int64_t index : step.indices) out += fmt::format("#{}", index);
    }
    put(each.value, out);
  }
  return out;
}

}  // namespace obscura::scene
