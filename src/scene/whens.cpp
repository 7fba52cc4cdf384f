#include "scene/whens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>

#include "scene/path.h"
#include "sim/model/body_motion.h"
#include "sim/model/condition.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostSticking = 20'000;  // pairs
constexpr const char* kWalls[] = {"floor", "left", "right", "ceiling", "back", "front"};
constexpr std::string_view kTaken[] = {"end", "max", "min", "mean", "argmax", "argmin"};  // of --measure

struct Quantity {
  std::string_view word;
  sim::Reading::Of of;
};
constexpr Quantity kQuantities[] = {
    {"x", sim::Reading::Of::x},
    {"y", sim::Reading::Of::y},
    {"z", sim::Reading::Of::z},
    {"vx", sim::Reading::Of::vx},
    {"vy", sim::Reading::Of::vy},
    {"vz", sim::Reading::Of::vz},
    {"speed", sim::Reading::Of::speed},
    {"angle", sim::Reading::Of::angle},
    {"spin", sim::Reading::Of::spin},
    // as states and --measure say it
    {"position.x", sim::Reading::Of::x},
    {"position.y", sim::Reading::Of::y},
    {"position.z", sim::Reading::Of::z},
    {"velocity.x", sim::Reading::Of::vx},
    {"velocity.y", sim::Reading::Of::vy},
    {"velocity.z", sim::Reading::Of::vz},
    {"contact", sim::Reading::Of::contact},
    {"normal_force", sim::Reading::Of::normal_force},
    {"friction", sim::Reading::Of::friction},
    {"spring_force", sim::Reading::Of::spring_force},
    {"joint_force", sim::Reading::Of::joint_force},
    {"force", sim::Reading::Of::force},
    {"torque", sim::Reading::Of::torque},
};

bool in_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// a value as TOML
std::string toml(const Node& node) {
  if (node.is_text()) {
    std::string text = "\"";
    for (const char c : node.text()) {
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
    return text + "\"";
  }
  if (node.is_integer()) return fmt::format("{}", std::get<std::int64_t>(node.value));
  if (node.is_number()) {
    std::string text = fmt::format("{}", node.number());
    return text.find_first_of(".einf") == std::string::npos ? text + ".0" : text;
  }
  if (const bool* flag = std::get_if<bool>(&node.value)) return *flag ? "true" : "false";
  std::vector<std::string> parts;
  if (node.is_list()) {
    for (const Node& each : node.list()) parts.push_back(toml(each));
    return fmt::format("[{}]", fmt::join(parts, ", "));
  }
  if (!node.is_table()) return "\"\"";
  for (const Entry& each : node.table()) parts.push_back(each.key + " = " + toml(each.node));
  return fmt::format("{{{}}}", fmt::join(parts, ", "));
}

// what a path ends with, and what is before it: "gate[2]" of "gate[2].fixed"
std::optional<std::string> owner(const std::string& path, std::string_view key) {
  const std::string end = "." + std::string(key);
  if (path.size() <= end.size() || !path.ends_with(end)) return {};
  return path.substr(0, path.size() - end.size());
}

// whether a name means a body, without a complaint
bool is_body(const NameTable& roster, const std::string& text) {
  const auto its = reference(text);
  return roster.index.count(text) > 0 || (its && its->bracketed && roster.index.count(its->name) > 0);
}

// each action of each condition
template <class Act>
void each_action(const Node& top, Act&& act) {
  const Node* all = top.find("when");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Node* actions = all->list()[k].find("do");
    for (std::size_t i = 0; actions && actions->is_list() && i < actions->list().size(); ++i)
      act(actions->list()[i]);
  }
}

// the number of the drive of a body that is fixed or moved, or -1
template <int D>
int drive_of(const sim::Model<D>& model, int body) {
  for (std::size_t i = 0; i < model.drives.size(); ++i)
    if (model.drives[i].body == body) return int(i);
  return -1;
}

template <int D>
class WhenBuilder {
 public:
  WhenBuilder(const Node& top, const NameTable& roster, const std::vector<BondRange>& bonds,
              Constants& constants, const Rebuild<D>& rebuild, sim::World<D>& world, Diagnostics& complaints)
      : top_(top),
        roster_(roster),
        bonds_(bonds),
        constants_(constants),
        rebuild_(rebuild),
        world_(world),
        model_(world.model),
        complaints_(complaints) {}

  void build() {
    const Node* all = top_.find("when");
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Fields fields(all->list()[k], "when");
      When when;
      when.name = fields.given("name") ? fields.text("name") : fmt::format("when[{}]", k);
      when.again = fields.flag("again");
      const std::size_t wrong = complaints_.count();
      condition(fields, when);
      actions(fields, when);
      if (complaints_.count() == wrong) model_.whens.push_back(std::move(when));
    }
    refuse_never_made();
    for (const When& when : model_.whens)
      for (const Action& action : when.actions)
        model_.changed = model_.changed || !(action.what == Do::mark || action.what == Do::stop);
  }

 private:
  using When = sim::When<D>;
  using On = typename When::On;
  using Action = typename When::Action;
  using Do = typename Action::Do;
  using Change = sim::Change<D>;

  // joints that are not there at the start, and which no event makes
  void refuse_never_made() {
    const Node* all = top_.find("joint");
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Node &its = all->list()[k], *name = its.find("name");
      const std::vector<int> those = joints(name ? name->text() : fmt::format("joint[{}]", k));
      const bool made = std::all_of(those.begin(), those.end(), [&](int joint) {
        return !model_.joints[std::size_t(joint)].later ||
               std::any_of(model_.changes.begin(), model_.changes.end(),
                           [&](const Change& it) { return it.of == Change::Of::join && it.index == joint; });
      });
      if (made) continue;
      complaints_.add(its.find("joined")->place,
                      "no event makes this joint: [[when]] do = [{ join = \"...\" }]");
    }
  }

  void condition(const Fields& fields, When& when) {
    const Node* one = nullptr;
    int count = 0;
    for (const char* key : {"touches", "leaves", "crosses", "value", "time", "breaks"}) {
      const Node* it = fields.given(key);
      if (!it) continue;
      one = it, ++count;
    }
    if (count != 1) {
      complaints_.add(
          count == 0 ? fields.place() : one->place,
          fmt::format("{} has {} of touches, leaves, crosses, value, time and breaks: expected one",
                      when.name, count == 0 ? "none" : "several"));
      return;
    }
    if (!model_.bonds.empty() && model_.collision == sim::Collision::event && !fields.given("time"))
      complaints_.add(
          one->place,
          "under \"event\" a condition is found at its exact time, but in a scene with [[bond]]s only "
          "at the end of a step: write collision = \"contact\", or for the bond a [[joint]] of type "
          "\"weld\" with 'breaks'");
    if (const Node* it = fields.given("touches")) when.on = On::touches, pairs(*it, "touches", when);
    if (const Node* it = fields.given("leaves")) when.on = On::leaves, pairs(*it, "leaves", when);
    if (const Node* it = fields.given("crosses")) when.on = On::crosses, gate(*it, when);
    if (const Node* it = fields.given("value")) when.on = On::value, value(*it, when);
    if (const Node* it = fields.given("time")) when.on = On::time, when.time = exact(*it);
    if (const Node* it = fields.given("breaks")) when.on = On::breaks, breaks(*it, when);
  }

  // the bodies, or walls as -1 - wall, of one side of a pair
  std::vector<int> side(const Node& node) {
    const std::string& text = node.text();
    if (!is_body(roster_, text)) {
      const int walls = int(model_.walls.size());
      const Fields room = Fields::of(top_, "room");
      const Node* own = room.given("walls");
      const int listed = own && own->is_list() ? int(own->list().size()) : 0;
      for (int k = 0; k < std::min(6, walls - listed); ++k)
        if (text == kWalls[k]) return {-1 - k};
      if (const auto its = reference(text); its && its->bracketed && its->name == "wall") {
        const auto which = range(its->which, walls);
        if (!which) {
          complaints_.add(node.place, walls == 0
                                          ? "the room has no walls"
                                          : fmt::format("{}: the room has {} walls, wall[0] .. wall[{}]",
                                                        scene::quoted(text), walls, walls - 1));
          return {};
        }
        std::vector<int> all;
        for (const int wall : *which) all.push_back(-1 - wall);
        return all;
      }
      if (text == "ground" && walls > listed) {
        complaints_.add(node.place, "the ground is the wall \"floor\"");
        return {};
      }
      for (int k = walls - listed; k < 6; ++k) {
        if (text != kWalls[k]) continue;
        complaints_.add(node.place,
                        fmt::format("the room has no {}; its walls are wall[*]", scene::quoted(text)));
        return {};
      }
    }
    return roster_.bodies(text, node.place, complaints_);
  }

  void pairs(const Node& node, const char* key, When& when) {
    const std::vector<int> a = side(node.list()[0]), b = side(node.list()[1]);
    bool handout = false, points = false, ignored = false;
    for (const int one : a) {
      for (const int other : b) {
        if (one == other || (one < 0 && other < 0)) continue;
        const int first = one < 0 || (other >= 0 && other < one) ? other : one,
                  second = first == one ? other : one;
        const auto handout_body = [&](int body) {
          return model_.collision == sim::Collision::handout || model_.bodies[std::size_t(body)].handout;
        };
        if (second >= 0 && (handout_body(first) || handout_body(second))) {
          handout = true;
          continue;
        }
        const auto mere_point = [&](int body) {
          return is_point(model_.bodies[std::size_t(body)].shape) &&
                 std::none_of(model_.rails.begin(), model_.rails.end(),
                              [&](const auto& rail) { return rail.body == body; });
        };
        if (second >= 0 && mere_point(first) && mere_point(second)) {
          points = true;
          continue;
        }
        if (second >= 0 && ignores(first, second)) {
          ignored = true;
          continue;
        }
        when.pairs.emplace_back(first, second);
      }
    }
    std::sort(when.pairs.begin(), when.pairs.end());
    when.pairs.erase(std::unique(when.pairs.begin(), when.pairs.end()), when.pairs.end());
    if (a.empty() || b.empty() || !when.pairs.empty()) return;
    const std::string what = fmt::format("'{}': {} and {}", key, scene::quoted(node.list()[0].text()),
                                         scene::quoted(node.list()[1].text()));
    complaints_.add(node.place,
                    handout ? what +
                                  " do not touch in collision = \"handout\", which knows only walls; "
                                  "[physics] collision = \"contact\" or \"event\""
                    : points  ? what + " are points, which do not touch each other; [[ball]]s do"
                    : ignored ? what + " are of groups that [contact] ignore lets through each other"
                              : what + " are no two that can touch");
  }

  bool ignores(int a, int b) const {
    const int p = model_.bodies[std::size_t(a)].group, q = model_.bodies[std::size_t(b)].group;
    return std::any_of(model_.ignore.begin(), model_.ignore.end(), [&](const auto& it) {
      return (it.first == p && it.second == q) || (it.first == q && it.second == p);
    });
  }

  void gate(const Node& node, When& when) {
    const Fields fields(node, "when.crosses");
    if (!fields.given("body") || !fields.given("from") || !fields.given("to")) return;
    const Node& body = *fields.given("body");
    const auto add = [&](const Node& one) {
      const std::vector<int> some = roster_.bodies(one.text(), one.place, complaints_);
      when.those.insert(when.those.end(), some.begin(), some.end());
    };
    if (body.is_text())
      add(body);
    else
      for (const Node& one : body.list()) add(one);
    when.from = fields.vector<D>("from"), when.to = fields.vector<D>("to");
    int same = 0;
    for (int axis = 0; axis < D; ++axis) same += when.from[axis] == when.to[axis];
    if (D == 2 && same == 2)
      complaints_.add(node.place, "'from' and 'to' are one place; expected the two ends of a line");
    if (D == 3 && same != 1)
      complaints_.add(node.place,
                      "'from' and 'to' are opposite corners of a rectangle that lies along two axes of the "
                      "room: expected them to agree in one of x, y and z");
  }

  void value(const Node& node, When& when) {
    const std::string text = typed(node);
    constants_.read_by(text);
    // quantities of bodies where they stand in the text
    std::vector<std::string> words;
    std::vector<sim::Symbol> refused;
    for (std::size_t dot = text.find('.'); dot != std::string::npos; dot = text.find('.', dot + 1)) {
      std::size_t end = dot + 1;
      while (end < text.size() && (in_word(text[end]) || text[end] == '.')) ++end;
      const std::string quantity = text.substr(dot + 1, end - dot - 1);
      std::size_t begin = dot;
      if (begin > 0 && text[begin - 1] == ']')
        while (begin > 0 && text[begin - 1] != '[') --begin;
      if (begin != dot && begin > 0) --begin;
      while (begin > 0 && (in_word(text[begin - 1]) || text[begin - 1] == '-')) --begin;
      // a name may have dashes, and a minus may stand before it
      for (; begin < dot; ++begin) {
        const bool starts = begin == 0 || !in_word(text[begin - 1]);
        const std::string name = text.substr(begin, dot - begin);
        const std::vector<int> held = starts && !is_body(roster_, name) ? joints(name) : std::vector<int>();
        if (!starts || (!is_body(roster_, name) && held.empty())) continue;
        const std::string word = text.substr(begin, end - begin);
        if (std::find(words.begin(), words.end(), word) != words.end()) break;
        if (!held.empty()) {
          if (held.size() > 1) {
            complaints_.add(node.place,
                            fmt::format("'value': {} is {} joints; a condition reads one of them, {}",
                                        scene::quoted(name), held.size(),
                                        scene::quoted(model_.joints[std::size_t(held[0])].name)));
            return;
          }
          if (quantity != "force" && quantity != "torque") {
            refused.push_back({word, -1, "is not what conditions read of a joint: force and torque"});
            break;
          }
          words.push_back(word);
          when.reads.push_back(
              {held[0], quantity == "force" ? sim::Reading::Of::force : sim::Reading::Of::torque});
          break;
        }
        const std::vector<int> found = roster_.bodies(name, node.place, complaints_);
        if (found.empty()) return;
        if (found.size() > 1) {
          complaints_.add(node.place, fmt::format("'value': {} is {} bodies; a condition reads one of them",
                                                  scene::quoted(name), found.size()));
          return;
        }
        const std::string why = refusal(found[0], quantity);
        if (!why.empty()) {
          refused.push_back({word, -1, why});
          break;
        }
        words.push_back(word);
        const auto of = std::find_if(std::begin(kQuantities), std::end(kQuantities),
                                     [&](const Quantity& it) { return it.word == quantity; });
        when.reads.push_back({found[0], of->of});
        break;
      }
    }
    auto made = sim::condition_formula(text, words, refused, constants_.numbers());
    if (const auto* fault = std::get_if<sim::ExpressionFault>(&made)) {
      std::vector<std::string> names{"t"};
      for (const auto& [name, number] : constants_.numbers()) names.push_back(name);
      for (const Group& group : roster_.groups)
        for (const char* quantity : {"x", "y", "vx", "vy", "speed", "angle", "spin"})
          if (names.size() < 2000) names.push_back(group.name + "." + quantity);
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
      complain(node, "value", *fault, names, complaints_);
      return;
    }
    when.value = std::make_shared<const sim::Program>(std::get<sim::Program>(std::move(made)));
  }

  // why a condition cannot read a quantity of a body; empty: it can
  std::string refusal(int body, const std::string& quantity) const {
    const auto found = std::find_if(std::begin(kQuantities), std::end(kQuantities),
                                    [&](const Quantity& it) { return it.word == quantity; });
    if (found == std::end(kQuantities))
      return D == 2 ? "is not what conditions read: x, y, vx, vy, speed, angle, spin, contact, "
                      "normal_force, friction, spring_force and joint_force"
                    : "is not what conditions read: x, y, z, vx, vy, vz, speed, spin, contact, "
                      "normal_force, friction, spring_force and joint_force";
    using enum sim::Reading::Of;
    if (found->of == force || found->of == torque)
      return "is of a joint, and this is a body; joint_force is what joints give it";
    if (D == 2 && (found->of == z || found->of == vz)) return "is of space, and this scene is in the plane";
    if (D == 3 && found->of == angle) return "is of the plane, and this scene is in space";
    if ((found->of == angle || found->of == spin) && !model_.bodies[std::size_t(body)].turns())
      return "is of a body that turns, and this does not";
    return "";
  }

  void breaks(const Node& node, When& when) {
    when.those = joints(node.text());
    for (const BondRange& bond : bonds_)
      for (int k = bond.first; bond.name == node.text() && k < bond.end; ++k) when.those.push_back(-1 - k);
    if (when.those.empty()) {
      complaints_.add(node.place, unknown_joint(node.text()));
      return;
    }
    const bool may = std::any_of(when.those.begin(), when.those.end(), [&](int of) {
      return of < 0 ? model_.bonds[std::size_t(-1 - of)].strength < 1e299
                    : model_.joints[std::size_t(of)].breaks < 1e299 ||
                          model_.joints[std::size_t(of)].breaks_torque < 1e299;
    });
    if (!may && !parted(when.those))
      complaints_.add(node.place, fmt::format("{} never breaks: give it a 'breaks', the force that it bears",
                                              scene::quoted(node.text())));
  }

  // whether an event takes one of these joints away
  bool parted(const std::vector<int>& those) {
    bool any = false;
    each_action(top_, [&](const Node& action) {
      const Node* release = action.find("release");
      if (!release) return;
      for (const int joint : joints(release->text()))
        any = any || std::find(those.begin(), those.end(), joint) != those.end();
    });
    return any;
  }

  // joints of a name: one, those of a list of copies, or all pieces of a rope over wheels
  std::vector<int> joints(const std::string& text) const {
    const auto its = reference(text);
    const bool all = its && its->bracketed && its->which == "*";
    const std::string base = (all ? its->name : text) + "[";
    std::vector<int> found;
    for (int k = 0; k < int(model_.joints.size()); ++k) {
      const sim::Joint<D>& joint = model_.joints[std::size_t(k)];
      const bool piece = joint.name.starts_with(base) && joint.name.back() == ']' &&
                         joint.name.find('[', base.size()) == std::string::npos;
      if ((!all && joint.name == text) || (piece && (all || joint.rope >= 0))) found.push_back(k);
    }
    return found;
  }

  std::string unknown_joint(const std::string& text) const {
    std::vector<std::string_view> names;
    for (const sim::Joint<D>& joint : model_.joints) names.push_back(joint.name);
    for (const BondRange& bond : bonds_) names.push_back(bond.name);
    return fmt::format("no joint or bond is called {}{}", scene::quoted(text), did_you_mean(text, names));
  }

  void actions(const Fields& fields, When& when) {
    const Node* all = fields.given("do");
    if (!all || !all->is_list()) return;
    if (all->list().empty()) {
      complaints_.add(all->place, "'do' is empty; expected actions such as { mark = \"hit\" }");
      return;
    }
    for (const Node& node : all->list()) {
      const Node *release = node.find("release"), *mark = node.find("mark"), *set = node.find("set"),
                 *to = node.find("to"), *stop = node.find("stop"), *join = node.find("join"),
                 *stick = node.find("stick");
      const int given = (release != nullptr) + (mark != nullptr) + (set != nullptr) + (stop != nullptr) +
                        (join != nullptr) + (stick != nullptr);
      if (given != 1) {
        complaints_.add(
            node.place,
            fmt::format("an action does one thing, mark, release, join, stick, set or stop; this has {}",
                        given == 0 ? "none" : "several"));
        continue;
      }
      if (to && !set) {
        complaints_.add(to->place, "'to' is the value of a 'set'");
        continue;
      }
      if (mark) note(*mark, when);
      if (stop) halt(*stop, when);
      if (release) let_go(*release, release->text(), when);
      if (join) this->join(*join, when);
      if (stick) this->stick(*stick, when);
      if (set) this->set(*set, to, when);
    }
  }

  void note(const Node& mark, When& when) {
    for (const std::string_view word : kTaken) {
      if (mark.text() != word) continue;
      complaints_.add(mark.place, fmt::format("'mark': {} is a word of --measure; choose another",
                                              scene::quoted(mark.text())));
      return;
    }
    when.actions.push_back({Do::mark, mark.text(), {}});
  }

  void halt(const Node& stop, When& when) {
    if (!std::get<bool>(stop.value)) {
      complaints_.add(stop.place, "'stop' is true, or left out");
      return;
    }
    when.actions.push_back({Do::stop, "", {}});
  }

  bool bonded(Place place) {
    if (model_.bonds.empty()) return false;
    complaints_.add(place,
                    "events of a scene with [[bond]]s mark and stop; they do not release or set yet; a "
                    "[[joint]] of type \"weld\" with 'breaks' holds two bodies together");
    return true;
  }

  bool is_spring(const std::string& name) const {
    const Node* all = top_.find("spring");
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Node* its = all->list()[k].find("name");
      if (its && its->is_text() && its->text() == name) return true;
    }
    return false;
  }

  void let_go(const Node& node, const std::string& text, When& when) {
    if (bonded(node.place)) return;
    if (!is_body(roster_, text)) {
      Action action{Do::part, "", joints(text)};
      if (action.of.empty() && is_spring(text)) {
        complaints_.add(node.place,
                        "springs stay; a rope or a rod, or a [[force]] that is switched, lets go");
        return;
      }
      if (action.of.empty()) {
        std::vector<std::string_view> names;
        for (const Group& group : roster_.groups) names.push_back(group.name);
        for (const sim::Joint<D>& joint : model_.joints) names.push_back(joint.name);
        complaints_.add(node.place, fmt::format("no body or joint is called {}{}", scene::quoted(text),
                                                did_you_mean(text, names)));
        return;
      }
      for (const int joint : action.of) {
        if (!model_.joints[std::size_t(joint)].linked) continue;
        complaints_.add(node.place,
                        "the joints of a [[chain]] are never taken away; leave it out of the chain");
        return;
      }
      when.actions.push_back(std::move(action));
      return;
    }
    Action action{Do::let_go, "", {}};
    for (const int body : roster_.bodies(text, node.place, complaints_)) {
      const int drive = drive_of(model_, body);
      if (drive >= 0) action.of.push_back(drive);
    }
    if (!action.of.empty()) when.actions.push_back(std::move(action));
  }

  // makes joints of a name, or holds together two sides, one each or each with the one
  void join(const Node& node, When& when) {
    if (no_joining(node.place)) return;
    if (node.is_text()) {
      Action action{Do::change, "", {}};
      const std::vector<int> those = joints(node.text());
      if (those.empty()) complaints_.add(node.place, unknown_joint(node.text()));
      for (const int joint : those) {
        if (!model_.joints[std::size_t(joint)].later) {
          complaints_.add(
              node.place,
              fmt::format("{} holds from the start; an event makes it where it has joined = false",
                          scene::quoted(node.text())));
          return;
        }
        action.of.push_back(joining(joint));
      }
      when.actions.push_back(std::move(action));
      return;
    }
    if (node.list().size() != 2) {
      complaints_.add(node.place, "'join' holds two together: expected two names, or that of a joint");
      return;
    }
    const std::vector<int> a = held_side(node.list()[0]), b = held_side(node.list()[1]);
    if (a.empty() || b.empty()) return;
    if (a.size() != b.size() && a.size() != 1 && b.size() != 1) {
      complaints_.add(node.place, fmt::format("'join': {} are {} and {} are {}: expected as many, or one",
                                              scene::quoted(node.list()[0].text()), a.size(),
                                              scene::quoted(node.list()[1].text()), b.size()));
      return;
    }
    Action action{Do::change, "", {}};
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
      const int one = a[a.size() == 1 ? 0 : i], other = b[b.size() == 1 ? 0 : i];
      if (one == other || !(moves(one) || moves(other))) {
        complaints_.add(node.place,
                        one == other ? fmt::format("'join': both are {}", scene::quoted(named(one)))
                                     : fmt::format("'join': neither {} nor {} moves",
                                                   scene::quoted(named(one)), scene::quoted(named(other))));
        return;
      }
      action.of.push_back(joining(glued(one, other)));
    }
    when.actions.push_back(std::move(action));
  }

  // holds together the pair that has come to touch
  void stick(const Node& node, When& when) {
    if (!std::get<bool>(node.value)) {
      complaints_.add(node.place, "'stick' is true, or left out");
      return;
    }
    if (when.on != When::On::touches) {
      complaints_.add(node.place, "'stick' holds together what 'touches'; 'join' names two, or a joint");
      return;
    }
    if (no_joining(node.place)) return;
    if (when.pairs.size() > kMostSticking) {
      complaints_.add(node.place, fmt::format("{} pairs may come to touch; at most {} may stick",
                                              when.pairs.size(), kMostSticking));
      return;
    }
    Action action{Do::change, "", {}, true};
    for (const auto& [a, b] : when.pairs)
      action.of.push_back(moves(a) || moves(b) ? joining(glued(a, b)) : -1);
    when.actions.push_back(std::move(action));
  }

  bool no_joining(Place place) {
    if (bonded(place)) return true;
    if (model_.collision != sim::Collision::handout) return false;
    complaints_.add(place,
                    "collision = \"handout\" knows no joints; write collision = \"contact\" or \"event\"");
    return true;
  }

  // of a joint: bodies, walls as they are in side(), or the room
  std::vector<int> held_side(const Node& node) {
    if (node.text() == "room" && !is_body(roster_, "room")) return {-1};
    return side(node);
  }

  bool moves(int body) const {
    return body >= 0 && (!model_.bodies[std::size_t(body)].fixed || drive_of(model_, body) >= 0);
  }
  std::string named(int body) const { return body < 0 ? "the room" : model_.bodies[std::size_t(body)].name; }

  // A joint that an event makes of two, so that nothing moves between them: a weld; of what does not turn a
  // pin at its middle, of two particles, which turn about each other, a rod. One for each two.
  int glued(int a, int b) {
    if (a < 0) std::swap(a, b);
    b = std::max(b, -1);
    const auto turns = [&](int body) { return body < 0 || model_.bodies[std::size_t(body)].turns(); };
    if (b >= 0 && turns(a) && !turns(b)) std::swap(a, b);
    const auto known = glued_.emplace(std::pair(a, b), int(model_.joints.size()));
    if (!known.second) return known.first->second;
    sim::Joint<D> it;
    it.name = fmt::format("{}+{}", named(a), b < 0 ? "room" : named(b));
    const auto point = [&](int body) {
      return body >= 0 && is_point(model_.bodies[std::size_t(body)].shape);
    };
    it.kind = turns(a) && turns(b)   ? sim::JointKind::weld
              : point(a) && point(b) ? sim::JointKind::rod
                                     : sim::JointKind::pin;
    it.a.body = a, it.b.body = b, it.later = true;
    model_.joints.push_back(std::move(it));
    world_.state.broken.push_back(1);
    return int(model_.joints.size()) - 1;
  }

  // the number of the change that makes a joint
  int joining(int joint) {
    Change change;
    change.of = Change::Of::join, change.index = joint;
    return number(std::move(change));
  }

  void set(const Node& node, const Node* to, When& when) {
    const std::string& path = node.text();
    if (!to) {
      complaints_.add(node.place, fmt::format("'set' needs 'to', the new value of {}", scene::quoted(path)));
      return;
    }
    if (bonded(node.place)) return;
    if (const auto body = owner(path, "fixed"); body && is_body(roster_, *body))
      return fix(node, *body, *to, when);
    const auto steps = scene::path(path);
    const auto at = path.find(".motor");
    const std::string first = path.substr(0, path.find('.'));
    if (path == "room.gravity" || path.starts_with("room.gravity.")) {
      if (const auto made = model_with(node, *to)) {
        Change change;
        change.of = Change::Of::gravity, change.gravity = made->gravity;
        give(std::move(change), when);
        // the fluid's buoyancy follows from it by itself
      }
      return;
    }
    if (at != std::string::npos && (path.size() == at + 6 || path[at + 6] == '.'))
      return motor(node, path.substr(0, at), *to, when);
    const std::string name =
        first == "room" && steps && steps->size() > 1 ? "room." + (*steps)[1].name : first;
    if (steps && is_force(name)) return force(node, name, *to, when);
    std::vector<std::string_view> words;
    for (const sim::Joint<D>& joint : model_.joints)
      if (joint.motor) words.push_back(joint.name);
    complaints_.add(node.place,
                    fmt::format("'set': {} stays as it is while the room runs; events set motors "
                                "(JOINT.motor.speed), forces (FORCE.components, room.wind), room.gravity and "
                                "BODY.fixed",
                                scene::quoted(path)));
  }

  void fix(const Node& node, const std::string& text, const Node& to, When& when) {
    const bool* flag = std::get_if<bool>(&to.value);
    if (!flag) {
      complaints_.add(to.place, "'fixed' is true or false");
      return;
    }
    if (!*flag) return let_go(node, text, when);
    Action action{Do::change, "", {}};
    for (const int body : roster_.bodies(text, node.place, complaints_)) {
      if (model_.bodies[std::size_t(body)].linked) {
        complaints_.add(node.place, fmt::format("{} is a link of a [[chain]], which events do not fix",
                                                scene::quoted(model_.bodies[std::size_t(body)].name)));
        return;
      }
      Change change;
      change.index = body;
      action.of.push_back(number(std::move(change)));
    }
    if (!action.of.empty()) when.actions.push_back(std::move(action));
  }

  void motor(const Node& node, const std::string& text, const Node& to, When& when) {
    const std::vector<int> those = joints(text);
    if (those.empty()) {
      complaints_.add(node.place, unknown_joint(text));
      return;
    }
    const auto made = model_with(node, to);
    if (!made) return;
    Action action{Do::change, "", {}};
    for (const int joint : those) {
      const auto& its = made->joints[std::size_t(joint)].motor;
      if (!its) {
        complaints_.add(node.place, fmt::format("{} has no motor", scene::quoted(text)));
        return;
      }
      Change change;
      change.of = Change::Of::motor, change.index = joint, change.motor = *its;
      action.of.push_back(number(std::move(change)));
    }
    when.actions.push_back(std::move(action));
  }

  bool is_force(const std::string& name) const {
    if (name == "room.wind" || name == "room.electric" || name == "room.magnetic") return true;
    for (const char* kind : {"force", "attractor"}) {
      const Node* all = top_.find(kind);
      for (std::size_t k = 0; all && k < all->list().size(); ++k) {
        const Node* its = all->list()[k].find("name");
        if (name == (its ? its->text() : fmt::format("{}[{}]", kind, k))) return true;
      }
    }
    return false;
  }

  static const sim::Force<D>* force_called(const sim::Model<D>& model, const std::string& name) {
    for (const sim::Force<D>& force : model.forces)
      if (force.name == name) return &force;
    return nullptr;
  }

  void force(const Node& node, const std::string& name, const Node& to, When& when) {
    const auto made = model_with(node, to);
    if (!made) return;
    if (name == "room.wind" &&
        (force_called(model_, "quadratic_drag") || force_called(*made, "quadratic_drag"))) {
      complaints_.add(node.place,
                      "'set': without wind at the start drag is one force, and with it another; "
                      "start with a wind of next to nothing, such as [1e-9, 0]");
      return;
    }
    const sim::Force<D>* then = force_called(*made, name);
    if (!then && !force_called(model_, name)) return;  // of nothing, before and after
    Change change;
    change.of = Change::Of::force;
    if (!force_called(model_, name)) {
      // not there yet: on nothing
      sim::Force<D> none = *then;
      none.subjects.clear();
      model_.forces.push_back(std::move(none));
    }
    for (int k = 0; k < int(model_.forces.size()); ++k)
      if (model_.forces[std::size_t(k)].name == name) change.index = k;
    sim::Force<D> its = then ? *then : model_.forces[std::size_t(change.index)];
    if (!then) its.subjects.clear();
    change.force = std::make_shared<const sim::Force<D>>(std::move(its));
    give(std::move(change), when);
  }

  std::optional<sim::Model<D>> model_with(const Node& node, const Node& to) {
    return rebuild_(node.text() + "=" + toml(to), node.place, complaints_);
  }

  int number(Change change) {
    model_.changes.push_back(std::move(change));
    return int(model_.changes.size()) - 1;
  }
  void give(Change change, When& when) {
    when.actions.push_back({Do::change, "", {number(std::move(change))}});
  }

  const Node& top_;
  const NameTable& roster_;
  const std::vector<BondRange>& bonds_;
  Constants& constants_;
  const Rebuild<D>& rebuild_;
  sim::World<D>& world_;
  sim::Model<D>& model_;
  Diagnostics& complaints_;
  std::map<std::pair<int, int>, int> glued_;  // joints of two bodies
};

}  // namespace

template <int D>
void ready_to_let_go(const Node& top, const NameTable& roster, sim::World<D>& world,
                     Diagnostics& complaints) {
  sim::Model<D>& model = world.model;
  std::vector<int> held;  // that events fix
  each_action(top, [&](const Node& action) {
    const Node *set = action.find("set"), *to = action.find("to");
    if (!set || !to || !set->is_text()) return;
    const auto body = owner(set->text(), "fixed");
    const bool* flag = std::get_if<bool>(&to->value);
    if (!body || !is_body(roster, *body) || !flag || !*flag) return;
    const std::vector<int> some = roster.bodies(*body, set->place, complaints);
    held.insert(held.end(), some.begin(), some.end());
  });
  each_action(top, [&](const Node& action) {
    const Node *release = action.find("release"), *set = action.find("set"), *to = action.find("to");
    std::optional<std::string> text;
    if (release && release->is_text()) text = release->text();
    if (const bool* flag = set && to && set->is_text() ? std::get_if<bool>(&to->value) : nullptr;
        flag && !*flag)
      text = owner(set->text(), "fixed");
    if (!text || !is_body(roster, *text)) return;
    const Node& node = release ? *release : *set;
    for (const int body : roster.bodies(*text, node.place, complaints)) {
      if (const int known = drive_of(model, body); known >= 0) {
        model.drives[std::size_t(known)].by_event = true;
        continue;
      }
      const bool moves = !model.bodies[std::size_t(body)].fixed;
      if (moves && std::find(held.begin(), held.end(), body) == held.end()) {
        complaints.add(node.place, fmt::format("{} lets go what is 'fixed' or has a 'motion', and {} is free",
                                               release ? "'release'" : "fixed = false",
                                               scene::quoted(model.bodies[std::size_t(body)].name)));
        return;
      }
      sim::Drive<D> drive;
      drive.body = body, drive.by_event = true;
      drive.start = world.state.x[std::size_t(body)];
      drive.turn = turn_of(world, body);
      const auto after = std::find_if(model.drives.begin(), model.drives.end(),
                                      [&](const sim::Drive<D>& it) { return it.body > body; });
      model.drives.insert(after, std::move(drive));
    }
  });
}

template <int D>
void whens(const Node& top, const NameTable& roster, const std::vector<BondRange>& bonds,
           Constants& constants, const Rebuild<D>& rebuild, sim::World<D>& world, Diagnostics& complaints) {
  WhenBuilder<D>(top, roster, bonds, constants, rebuild, world, complaints).build();
}

#define OBSCURA_INSTANTIATE(D)                                                                     \
  template void ready_to_let_go<D>(const Node&, const NameTable&, sim::World<D>&, Diagnostics&);   \
  template void whens<D>(const Node&, const NameTable&, const std::vector<BondRange>&, Constants&, \
                         const Rebuild<D>&, sim::World<D>&, Diagnostics&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
