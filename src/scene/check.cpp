#include "scene/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scene/check_value.h"
#include "scene/faults.h"
#include "scene/other_words.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostWords = 12;  // that are listed where no key is near

std::string owner_text(const std::string& owner) {
  if (owner.empty()) return "a scene";
  const Key* it = key(owner);
  if (owner.find('.') != std::string::npos)
    return (it->form == Form::tables || it->form == Form::walls || it->form == Form::speeds ? "each of '"
                                                                                            : "'") +
           std::string(it->last()) + "'";
  return it->form == Form::tables ? "[[" + owner + "]]" : "[" + owner + "]";
}

// other tables with a key of this name; `table` tells whether a table is meant, which is looked for first
std::string elsewhere(std::string_view last, bool table) {
  const Key* found = nullptr;
  for (const Key& each : keys()) {
    const bool is_table = each.form == Form::tables || each.form == Form::table;
    if (each.last() != last || each.owner().find('.') != std::string_view::npos) continue;
    if (!table && each.owner().empty() && is_table) continue;
    if (!found || (table && is_table && found->form != Form::tables && found->form != Form::table))
      found = &each;
  }
  if (!found) return "";
  return found->owner().empty() ? "it belongs at the top, before the first [table]"
                                : "it belongs in " + owner_text(std::string(found->owner()));
}

// a kind of one of the tables, where it is written as a table of its own: "[[joint]], type = \"rod\""
std::string kind_of(std::string_view word) {
  for (const Key& each : keys())
    if (each.last() == "type" &&
        std::find(each.choices.begin(), each.choices.end(), word) != each.choices.end())
      return fmt::format("{}, type = \"{}\"", owner_text(std::string(each.owner())), word);
  return "";
}

// the tables of a scene: which keys each has, and that it has those it needs
class Tables : private Reporter {
 public:
  Tables(const Dimension& told, Diagnostics& complaints) : Reporter(told, complaints) {}

  // takes out of a table what is wrong with it
  void table(Node& node, const std::string& owner) {
    std::vector<std::string_view> met;
    std::erase_if(node.table(), [&](Entry& entry) {
      const std::string path = owner.empty() ? entry.key : owner + '.' + entry.key;
      const Key* known = key(path);
      if (!known) {
        met.push_back(unknown_key(entry, owner, path));
        return true;
      }
      met.push_back(known->last());
      if (!has(*known)) {
        of_the_other(entry, *known);
        return true;
      }
      return !right(entry.node, *known);
    });
    for (const Key* each : keys_of(owner))
      if (each->required && std::find(met.begin(), met.end(), each->last()) == met.end())
        wrong(node, fmt::format("{} needs '{}': {}", owner_text(owner), each->last(), expected(*each)));
  }

 private:
  bool right(Node& node, const Key& key) {
    switch (key.form) {
      case Form::table:
        return node.is_table() ? (table(node, key.path), true) : mistyped(node, key);
      case Form::tables:
        return tables(node, key);
      case Form::cameras:
        if (node.is_table()) return table(node, key.path), true;
        if (dimension() == 2 && node.is_list())
          return wrong(node, "[[camera]]s beside each other are of space, and " + because() +
                                 "; in the plane it is one [camera]");
        return tables(node, key);
      case Form::walls:
        return node.is_text() ? check_value(node, key, *this) : tables(node, key);
      case Form::speeds:
        return node.is_list() ? tables(node, key) : check_value(node, key, *this);
      default:
        return check_value(node, key, *this);
    }
  }

  bool tables(Node& node, const Key& key) {
    const bool list = node.is_list() && std::all_of(node.list().begin(), node.list().end(),
                                                    [](const Node& n) { return n.is_table(); });
    if (!list) {
      if (!node.is_table() || !node.header || !key.owner().empty()) return mistyped(node, key);
      wrong(node, fmt::format("[{}] stands for one of many; write [[{}]]", key.path, key.path));
      // and is read as one, or all that names it would be wrong too
      Node one = node;
      node.value = Node::List{std::move(one)};
    }
    for (Node& each : node.list()) table(each, key.path);
    return true;
  }

  // a key of the plane in space, or the other way around
  void of_the_other(const Entry& entry, const Key& key) {
    const std::string here = dimension() == 2 ? "in the plane" : "in space",
                      there = dimension() == 2 ? "of space" : "of the plane";
    complaints().add(
        entry.place,
        fmt::format("{} is {}, and {}{}",
                    key.form == Form::tables ? "[[" + key.path + "]]" : "'" + entry.key + "'", there,
                    because(), key.instead.empty() ? "" : "; " + here + " " + key.instead));
  }

  // reports an unknown key with the most similar key of the table
  std::string_view unknown_key(const Entry& entry, const std::string& owner, const std::string& path) {
    const bool several = entry.node.is_list() && entry.node.header;
    const auto later = later_keys();
    if (std::find(later.begin(), later.end(), path) != later.end()) {
      const std::string shown = several                                      ? "[[" + entry.key + "]]"
                                : entry.node.is_table() && entry.node.header ? "[" + entry.key + "]"
                                                                             : "'" + entry.key + "'";
      complaints().add(entry.place, shown + " is not in this version of obscura yet");
      return {};
    }
    if (complaints().enough()) {
      complaints().add(entry.place, "unknown key " + in_quotes(entry.key));
      return {};
    }
    std::vector<std::string_view> words;
    std::vector<std::string> many;
    for (const Key* each : keys_of(owner)) {
      if (!has(*each)) continue;
      words.push_back(each->last());
      if (each->form == Form::tables) many.push_back("[[" + std::string(each->last()) + "]]");
    }
    const std::string_view near = nearest(entry.key, words);
    const bool is_table = several || entry.node.is_table();
    std::string hint;
    if (const std::string_view ours = other_word(entry.key, owner); !ours.empty()) {
      hint = ours;
    } else if (const std::string plural = entry.key + 's';
               owner.empty() && !elsewhere(plural, true).empty()) {
      hint = "; '" + plural + "': " + elsewhere(plural, true);
    } else if (const std::string kind = kind_of(entry.key); owner.empty() && !kind.empty()) {
      hint = "; did you mean " + kind + "?";
    } else if (!near.empty()) {
      hint = fmt::format("; did you mean '{}'?", near);
    } else if (const std::string other = elsewhere(entry.key, is_table); !other.empty()) {
      hint = "; " + other;
    } else if (words.size() <= kMostWords) {
      hint = fmt::format("; it has {}", fmt::join(words, ", "));
    } else if (owner.empty() && several) {
      hint = fmt::format("; there are {}", fmt::join(many, ", "));
    }
    complaints().add(entry.place, fmt::format("unknown key {}{}{}", in_quotes(entry.key),
                                              owner.empty() ? "" : " in " + owner_text(owner), hint));
    return near;
  }
};

}  // namespace

void check(Node& top, const Dimension& told, Diagnostics& complaints) {
  Tables(told, complaints).table(top, "");
}

void check(Node& table, const std::string& owner, const Dimension& told, Diagnostics& complaints) {
  Tables(told, complaints).table(table, owner);
}

}  // namespace obscura::scene
