#include "scene/run_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "scene/fields.h"
#include "scene/table.h"

namespace obscura::scene {

namespace {

bool names_mark(const Node& node) {
  if (!node.is_text() || node.text().empty()) return false;
  const char c = node.text()[0];
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

// a time as a scene would have it
void put(Node& node, sim::Rational t) {
  node.value = t.den == 1 ? std::to_string(t.num) : fmt::format("{}/{}", t.num, t.den);
}

class Putting {
 public:
  Putting(const RunMarks* marks, std::vector<std::string> declared, Diagnostics& complaints)
      : marks_(marks), declared_(std::move(declared)), complaints_(complaints) {}

  std::vector<std::string> used;

  // of a mark by its name; none where the run does not come to it
  std::optional<sim::Rational> instant(const Node& node) {
    if (names_mark(node)) return found(node);
    complaints_.add(node.place, "'mark': expected the name of a mark, such as \"hit\" or \"hit[2]\"");
    return {};
  }

  // every time of a table; false: what it belongs to waits for a mark that is not made
  bool table(Node& node, const std::string& owner) {
    bool comes = true;
    for (Entry& entry : node.table()) {
      const std::string path = owner.empty() ? entry.key : owner + "." + entry.key;
      const Key* known = key(path);
      if (!known) continue;
      switch (known->form) {
        case Form::table:
        case Form::cameras:
          if (entry.node.is_table()) table(entry.node, path);
          break;
        case Form::tables:
        case Form::speeds:
          if (!entry.node.is_list()) break;
          std::erase_if(entry.node.list(), [&](Node& each) { return each.is_table() && !table(each, path); });
          break;
        case Form::moment:
          comes = time(entry.node) && comes;
          break;
        default:
          break;
      }
    }
    cues(node, owner);
    return comes;
  }

 private:
  // the time of a mark in the place of its name
  bool time(Node& node) {
    if (!names_mark(node)) return true;
    const auto at = found(node);
    if (at) put(node, *at);
    return at.has_value();
  }

  std::optional<sim::Rational> found(const Node& node) {
    const std::string text = node.text();
    const auto parsed = parse_mark(text);
    if (!parsed || std::find(declared_.begin(), declared_.end(), parsed->first) == declared_.end()) {
      complaints_.add(node.place, fmt::format("no [[when]] makes a mark {}{}", scene::in_quotes(text),
                                              did_you_mean(parsed ? parsed->first : text,
                                                           {declared_.begin(), declared_.end()})));
      return {};
    }
    if (std::find(used.begin(), used.end(), text) == used.end()) used.push_back(text);
    return marks_ ? marks_->at(text) : std::nullopt;
  }

  // from when to when something is shown
  void cues(Node& table, const std::string& owner) {
    const auto cue = [&](const char* name) -> Node* {
      const Key* known = key(owner + "." + name);
      if (!known || known->form != Form::cue) return nullptr;
      Node* it = table.find(name);
      return it && it->is_table() ? it->find("time") : it;
    };
    Node *start = cue("start"), *end = cue("end");
    const bool marked = (start && names_mark(*start)) || (end && names_mark(*end));
    if (!marked) return;
    const bool starts = !start || time(*start), ends = !end || time(*end);
    if (!starts) put(*table.find("start"), {kNever, 1});
    if (end && (!starts || !ends)) {
      std::erase_if(table.table(), [](const Entry& entry) { return entry.key == "end"; });
      return;
    }
    // over before it begins: never shown
    if (start && end && exact(*end) < exact(*start)) end->value = start->value;
  }

  const RunMarks* marks_;
  std::vector<std::string> declared_;
  Diagnostics& complaints_;
};

// what was to be at the end is at the stop, and what came after it is left out
void cut_at(Node& top, sim::Rational stop) {
  const sim::Rational duration = Fields(top, "").rational("duration");
  if (duration <= stop) return;
  if (Node* it = top.find("duration")) {
    put(*it, stop);
  } else {
    Node node{top.place, std::string()};
    put(node, stop);
    top.table().insert(top.table().begin(), Entry{"duration", top.place, std::move(node)});
  }
  Node* film = top.find("film");
  Node* captions = film && film->is_table() ? film->find("caption") : nullptr;
  if (captions && captions->is_list())
    std::erase_if(captions->list(), [&](Node& each) {
      Node* start = each.find("start");
      if (start && start->is_table()) start = start->find("time");
      return start && stop < exact(*start);
    });
  for (const char* key : {"speed", "card"}) {
    Node* all = film && film->is_table() ? film->find(key) : nullptr;
    if (!all || !all->is_list()) continue;
    std::erase_if(all->list(), [&](Node& each) {
      Node* time = each.find("time");
      if (!time) return false;
      if (exact(*time) == duration) put(*time, stop);
      return stop < exact(*time);
    });
  }
}

}  // namespace

std::optional<sim::Rational> RunMarks::at(const std::string& mark) const {
  const auto parsed = parse_mark(mark);
  if (!parsed) return {};
  const auto found = instants.find(parsed->first);
  if (found == instants.end() || std::size_t(parsed->second) > found->second.size()) return {};
  return found->second[std::size_t(parsed->second) - 1];
}

std::optional<std::pair<std::string, int>> parse_mark(const std::string& text) {
  const auto bracket = text.find('[');
  if (bracket == text.npos) return std::pair(text, 1);
  int number = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + bracket + 1, end, number);
  if (read.ec != std::errc() || read.ptr + 1 != end || *read.ptr != ']' || number < 1) return {};
  return std::pair(text.substr(0, bracket), number);
}

std::vector<std::string> declared_marks(const Node& top) {
  std::vector<std::string> all;
  const Node* whens = top.find("when");
  for (const Node& when : whens && whens->is_list() ? whens->list() : Node::List{}) {
    const Node* actions = when.find("do");
    for (const Node& action : actions && actions->is_list() ? actions->list() : Node::List{}) {
      const Node* mark = action.find("mark");
      if (mark && mark->is_text() && std::find(all.begin(), all.end(), mark->text()) == all.end())
        all.push_back(mark->text());
    }
  }
  return all;
}

MarksPut put_marks(Node& top, const RunMarks* marks, Diagnostics& complaints) {
  Putting putting(marks, declared_marks(top), complaints);
  putting.table(top, "");
  if (marks && marks->stop) cut_at(top, *marks->stop);

  // the instant of a figure, to which its others are relative
  Node* figure = top.find("figure");
  Node* mark = figure && figure->is_table() ? figure->find("mark") : nullptr;
  if (!mark) return {putting.used};
  Node wanted = *mark;
  std::erase_if(figure->table(), [](const Entry& entry) { return entry.key == "mark"; });
  if (figure->find("impact")) {
    complaints.add(wanted.place, "'mark' and 'impact' both say which instant it is; leave one out");
    return {putting.used};
  }
  Node::List instants;
  const Node::List one{wanted};
  for (const Node& each : wanted.is_list() ? wanted.list() : one) {
    const auto t = putting.instant(each);
    if (!t) continue;
    std::vector<sim::Rational> after{{0, 1}};
    if (const Node* at = figure->find("at")) {
      after.clear();
      const Node::List single{*at};
      for (const Node& each_at : at->is_list() ? at->list() : single) after.push_back(exact(each_at));
    }
    for (const sim::Rational more : after) {
      Node node = each;
      put(node, *t + more);
      instants.push_back(std::move(node));
    }
  }
  std::erase_if(figure->table(), [](const Entry& entry) { return entry.key == "at"; });
  if (!instants.empty()) figure->table().push_back({"at", wanted.place, Node{wanted.place, instants}});
  return {putting.used, instants.empty()};
}

}  // namespace obscura::scene
