#include "scene/when_actions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>

#include "scene/path.h"
#include "sim/constraint/joints/joint.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostSticking = 20'000;                                             // pairs
constexpr std::string_view kTaken[] = {"end", "max", "min", "mean", "argmax", "argmin"};  // of --measure

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

// the number of the drive of a body that is fixed or moved, or -1
template <int D>
int drive_of(const sim::Model<D>& model, int body) {
  for (std::size_t i = 0; i < model.drives.size(); ++i)
    if (model.drives[i].body == body) return int(i);
  return -1;
}

template <int D>
class ActionBuilder {
 public:
  using When = sim::When<D>;
  using Action = typename When::Action;
  using Do = typename Action::Do;
  using Change = sim::Change<D>;

  ActionBuilder(const WhenNames<D>& names, const Rebuild<D>& rebuild, sim::World<D>& world, Glued& glued,
                Diagnostics& complaints)
      : names_(names),
        rebuild_(rebuild),
        world_(world),
        model_(world.model),
        glued_(glued),
        complaints_(complaints) {}

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

 private:
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

  void let_go(const Node& node, const std::string& text, When& when) {
    if (bonded(node.place)) return;
    if (!names_.is_body(text)) {
      Action action{Do::part, "", names_.joints(text)};
      if (action.of.empty() && changed_springs(Change::Of::loose, names_.springs_called(text), 1, when))
        return;
      if (action.of.empty()) {
        std::vector<std::string_view> names;
        for (const Group& group : names_.roster.groups) names.push_back(group.name);
        for (const sim::Joint<D>& joint : model_.joints) names.push_back(joint.name);
        for (const NameRange& spring : names_.springs) names.push_back(spring.name);
        complaints_.add(node.place, fmt::format("no body, joint or spring is called {}{}",
                                                scene::quoted(text), did_you_mean(text, names)));
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
    for (const int body : names_.roster.bodies(text, node.place, complaints_)) {
      const int drive = drive_of(model_, body);
      if (drive >= 0) action.of.push_back(drive);
    }
    if (!action.of.empty()) when.actions.push_back(std::move(action));
  }

  // gives springs a value each; false where there are none
  bool changed_springs(typename Change::Of of, const std::vector<int>& those, double value, When& when) {
    Action action{Do::change, "", {}};
    for (const int spring : those) {
      Change change;
      change.of = of, change.index = spring, change.value = value;
      action.of.push_back(number(std::move(change)));
    }
    if (!those.empty()) when.actions.push_back(std::move(action));
    return !those.empty();
  }

  // makes joints or joins springs of a name, or holds together two sides, one each or each with the one
  void join(const Node& node, When& when) {
    if (node.is_text() && names_.joints(node.text()).empty() && !bonded(node.place) &&
        changed_springs(Change::Of::loose, names_.springs_called(node.text()), 0, when))
      return;
    if (no_joining(node.place)) return;
    if (node.is_text()) {
      Action action{Do::change, "", {}};
      const std::vector<int> those = names_.joints(node.text());
      if (those.empty()) complaints_.add(node.place, names_.unknown_joint(node.text()));
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

  // of a joint: bodies, walls as they are in names_.side(), or the room
  std::vector<int> held_side(const Node& node) {
    if (node.text() == "room" && !names_.is_body("room")) return {-1};
    return names_.side(node);
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
    if (const auto body = owner(path, "fixed"); body && names_.is_body(*body))
      return fix(node, *body, *to, when);
    if (value_of_body(node, *to, when) || kick(node, *to, when)) return;
    if (spring(node, *to, when)) return;
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
    if (const auto joint = owner(path, "friction"); joint && !names_.joints(*joint).empty())
      return rub(node, *joint, *to, when);
    if (at != std::string::npos && (path.size() == at + 6 || path[at + 6] == '.'))
      return motor(node, path.substr(0, at), *to, when);
    const std::string name =
        first == "room" && steps && steps->size() > 1 ? "room." + (*steps)[1].name : first;
    if (steps && is_force(name)) return force(node, name, *to, when);
    std::vector<std::string_view> words;
    for (const sim::Joint<D>& joint : model_.joints)
      if (joint.motor) words.push_back(joint.name);
    complaints_.add(
        node.place,
        fmt::format("'set': {} stays as it is while the room runs; events set motors "
                    "(JOINT.motor.speed), JOINT.friction, forces (FORCE.components), room.wind, electric, "
                    "magnetic and gravity, SPRING.stiffness, damping and rest_length, BODY.fixed, "
                    "velocity, spin, mass, charge, drag and quadratic_drag",
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
    for (const int body : names_.roster.bodies(text, node.place, complaints_)) {
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

  // bodies that a key may be set of; none, and a complaint, where they are held, or links
  std::vector<int> free_bodies(const Node& node, const std::string& text, const char* what) {
    const std::vector<int> those = names_.roster.bodies(text, node.place, complaints_);
    for (const int body : those) {
      const sim::Body<D>& its = model_.bodies[std::size_t(body)];
      if (!its.linked && moves(body)) continue;
      complaints_.add(node.place, fmt::format("{} is {}, and {} stays", scene::quoted(its.name),
                                              its.linked ? "a link of a [[chain]]" : "fixed", what));
      return {};
    }
    return those;
  }

  // a number that bodies have; false: the key is another's
  bool value_of_body(const Node& node, const Node& to, When& when) {
    struct Key {
      const char* name;
      typename Change::Of of;
      double sim::Body<D>::*value;
      const char* what;
    };
    constexpr Key kKeys[] = {
        {"mass", Change::Of::mass, &sim::Body<D>::mass, "its mass"},
        {"charge", Change::Of::charge, &sim::Body<D>::charge, "its charge"},
        {"drag", Change::Of::drag, &sim::Body<D>::drag, "its drag"},
        {"quadratic_drag", Change::Of::quadratic_drag, &sim::Body<D>::quadratic_drag, "its drag"}};
    for (const Key& key : kKeys) {
      const auto name = owner(node.text(), key.name);
      if (!name || !names_.is_body(*name)) continue;
      const auto made = model_with(node, to);
      if (!made) return true;
      Action action{Do::change, "", {}};
      for (const int body : free_bodies(node, *name, key.what)) {
        Change change;
        change.of = key.of, change.index = body, change.value = made->bodies[std::size_t(body)].*key.value;
        action.of.push_back(number(std::move(change)));
      }
      if (!action.of.empty()) when.actions.push_back(std::move(action));
      return true;
    }
    return false;
  }

  // a velocity or a spin, from that instant on; false: the key is another's
  bool kick(const Node& node, const Node& to, When& when) {
    for (const bool turns : {false, true}) {
      const auto name = owner(node.text(), turns ? "spin" : "velocity");
      if (!name || !names_.is_body(*name)) continue;
      const bool number_alone = turns && D == 2;
      const bool good = number_alone ? to.is_number()
                                     : to.is_list() && to.list().size() == D &&
                                           std::all_of(to.list().begin(), to.list().end(),
                                                       [](const Node& it) { return it.is_number(); });
      if (!good) {
        complaints_.add(to.place, fmt::format("{}: expected {}", scene::quoted(node.text()),
                                              number_alone ? "degrees a second"
                                              : D == 2     ? "[x, y]"
                                                           : "[x, y, z]"));
        return true;
      }
      Change change;
      change.of = turns ? Change::Of::spin : Change::Of::velocity;
      if (!turns)
        change.velocity = vector<D>(to);
      else if constexpr (D == 2)
        change.spin[0] = to.number() * std::numbers::pi / 180;
      else
        change.spin = vector<D>(to) * (std::numbers::pi / 180);
      Action action{Do::change, "", {}};
      for (const int body : free_bodies(node, *name, "its velocity")) {
        change.index = body;
        action.of.push_back(this->number(change));
      }
      if (!action.of.empty()) when.actions.push_back(std::move(action));
      return true;
    }
    return false;
  }

  // the dry friction of a pin, in space of a hinge, or of a slider
  void rub(const Node& node, const std::string& text, const Node& to, When& when) {
    const auto made = model_with(node, to);
    if (!made) return;
    Action action{Do::change, "", {}};
    for (const int joint : names_.joints(text)) {
      const sim::Joint<D>& its = made->joints[std::size_t(joint)];
      if (!sim::has_free_row(its)) {
        complaints_.add(node.place,
                        fmt::format("'set': the friction of {} stays as it is while the room runs",
                                    scene::quoted(its.name)));
        return;
      }
      Change change;
      change.of = Change::Of::rub, change.index = joint, change.value = its.friction;
      action.of.push_back(number(std::move(change)));
    }
    when.actions.push_back(std::move(action));
  }

  // a key of springs; false: it is another's
  bool spring(const Node& node, const Node& to, When& when) {
    struct Key {
      const char* name;
      typename Change::Of of;
      double sim::Spring<D>::*value;
    };
    constexpr Key kKeys[] = {{"stiffness", Change::Of::stiffness, &sim::Spring<D>::stiffness},
                             {"damping", Change::Of::damping, &sim::Spring<D>::damping},
                             {"rest_length", Change::Of::rest_length, &sim::Spring<D>::rest_length}};
    for (const Key& key : kKeys) {
      const auto name = owner(node.text(), key.name);
      const std::vector<int> those = name ? names_.springs_called(*name) : std::vector<int>();
      if (those.empty()) continue;
      const auto made = model_with(node, to);
      for (const int spring : those)
        if (made) changed_springs(key.of, {spring}, made->springs[std::size_t(spring)].*key.value, when);
      return true;
    }
    return false;
  }

  void motor(const Node& node, const std::string& text, const Node& to, When& when) {
    const std::vector<int> those = names_.joints(text);
    if (those.empty()) {
      complaints_.add(node.place, names_.unknown_joint(text));
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
      const Node* all = names_.top.find(kind);
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

  const WhenNames<D>& names_;
  const Rebuild<D>& rebuild_;
  sim::World<D>& world_;
  sim::Model<D>& model_;
  Glued& glued_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void actions(const Fields& fields, const WhenNames<D>& names, const Rebuild<D>& rebuild, sim::World<D>& world,
             Glued& glued, sim::When<D>& when, Diagnostics& complaints) {
  ActionBuilder<D>(names, rebuild, world, glued, complaints).actions(fields, when);
}

template <int D>
void ready_to_let_go(const Node& top, const NameTable& roster, sim::World<D>& world,
                     Diagnostics& complaints) {
  sim::Model<D>& model = world.model;
  const WhenNames<D> names{top, roster, {}, {}, model, complaints};
  std::vector<int> held;  // that events fix
  each_action(top, [&](const Node& action) {
    const Node *set = action.find("set"), *to = action.find("to");
    if (!set || !to || !set->is_text()) return;
    const auto body = owner(set->text(), "fixed");
    const bool* flag = std::get_if<bool>(&to->value);
    if (!body || !names.is_body(*body) || !flag || !*flag) return;
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
    if (!text || !names.is_body(*text)) return;
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

#define OBSCURA_INSTANTIATE(D)                                                                            \
  template void ready_to_let_go<D>(const Node&, const NameTable&, sim::World<D>&, Diagnostics&);          \
  template void actions<D>(const Fields&, const WhenNames<D>&, const Rebuild<D>&, sim::World<D>&, Glued&, \
                           sim::When<D>&, Diagnostics&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
