// What events set. Most keys are read by the model of the same scene with the key set, as --set has it.

#include "scene/when_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "scene/path.h"
#include "scene/readings.h"
#include "sim/constraint/joints/joint.h"
#include "sim/model/condition.h"

namespace obscura::scene {

namespace {

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

template <int D>
class SettingReader {
 public:
  using When = sim::When<D>;
  using Change = sim::Change<D>;

  SettingReader(const Rebuild<D>& rebuild, Changes<D>& changes)
      : names_(changes.names),
        rebuild_(rebuild),
        changes_(changes),
        model_(changes.model),
        complaints_(changes.complaints) {}

  void set(const Node& node, const Node* to, When& when) {
    const std::string& path = node.text();
    if (!to) {
      complaints_.add(node.place, fmt::format("'set' needs 'to', the new value of {}", scene::in_quotes(path)));
      return;
    }
    if (changes_.bonded(node.place)) return;
    if (const auto body = owner(path, "fixed"); body && names_.is_body(*body))
      return fix(node, *body, *to, when);
    if (value_of_body(node, *to, when) || kick(node, *to, when) || belt(node, *to, when)) return;
    if (spring(node, *to, when)) return;
    const auto steps = scene::path(path);
    const auto at = path.find(".motor");
    const std::string first = path.substr(0, path.find('.'));
    if (path == "room.gravity" || path.starts_with("room.gravity.")) {
      if (const auto made = model_with(node, *to)) {
        Change change = changes_.of(Change::Of::gravity, -1);
        change.gravity = made->gravity;
        changes_.give({change}, when);
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
    complaints_.add(
        node.place,
        fmt::format("'set': {} stays as it is while the room runs; events set motors "
                    "(JOINT.motor.speed), JOINT.friction, forces (FORCE.components), room.wind, electric, "
                    "magnetic and gravity, SPRING.stiffness, damping and rest_length, BODY.fixed, "
                    "velocity, spin, mass, charge, drag, quadratic_drag and surface_speed",
                    scene::in_quotes(path)));
  }

 private:
  void fix(const Node& node, const std::string& text, const Node& to, When& when) {
    const bool* flag = std::get_if<bool>(&to.value);
    if (!flag) {
      complaints_.add(to.place, "'fixed' is true or false");
      return;
    }
    if (!*flag) return changes_.let_go(node.place, text, when);
    std::vector<Change> all;
    for (const int body : names_.roster.bodies(text, node.place, complaints_)) {
      if (model_.bodies[std::size_t(body)].linked) {
        complaints_.add(node.place, fmt::format("{} is a link of a [[chain]], which events do not fix",
                                                scene::in_quotes(model_.bodies[std::size_t(body)].name)));
        return;
      }
      all.push_back(changes_.of(Change::Of::hold, body));
    }
    changes_.give(all, when);
  }

  // bodies that a key may be set of; none, and a complaint, where they are held, or links
  std::vector<int> free_bodies(const Node& node, const std::string& text, const char* what) {
    const std::vector<int> those = names_.roster.bodies(text, node.place, complaints_);
    for (const int body : those) {
      const sim::Body<D>& its = model_.bodies[std::size_t(body)];
      if (!its.linked && changes_.moves(body)) continue;
      complaints_.add(node.place, fmt::format("{} is {}, and {} stays", scene::in_quotes(its.name),
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
      std::vector<Change> all;
      for (const int body : free_bodies(node, *name, key.what)) {
        all.push_back(changes_.of(key.of, body, made->bodies[std::size_t(body)].*key.value));
      }
      changes_.give(all, when);
      return true;
    }
    return false;
  }

  // a velocity or a spin, from that instant on: numbers, or expressions of what was; false: the key is
  // another's
  bool kick(const Node& node, const Node& to, When& when) {
    for (const bool turns : {false, true}) {
      const auto name = owner(node.text(), turns ? "spin" : "velocity");
      if (!name || !names_.is_body(*name)) continue;
      const bool alone = turns && D == 2;
      const auto good = [](const Node& it) { return it.is_number() || it.is_text(); };
      std::vector<const Node*> components;
      if (alone && good(to)) components.push_back(&to);
      for (std::size_t k = 0; !alone && to.is_list() && k < to.list().size(); ++k)
        if (good(to.list()[k])) components.push_back(&to.list()[k]);
      if (components.size() != (alone ? 1 : D) || (!alone && to.list().size() != D)) {
        complaints_.add(to.place, fmt::format("{}: expected {}", scene::in_quotes(node.text()),
                                              alone    ? "degrees a second, or an expression"
                                              : D == 2 ? "[x, y]"
                                                       : "[x, y, z]"));
        return true;
      }
      Change change;
      change.of = turns ? Change::Of::spin : Change::Of::velocity;
      const double unit = turns ? std::numbers::pi / 180 : 1;
      if (std::any_of(components.begin(), components.end(), [](const Node* it) { return it->is_text(); })) {
        if (!kick_formula(components, unit, change)) return true;
      } else {
        for (std::size_t k = 0; k < components.size(); ++k)
          (turns ? change.spin[Eigen::Index(k)] : change.velocity[Eigen::Index(k)]) =
              components[k]->number() * unit;
      }
      std::vector<Change> all;
      for (const int body : free_bodies(node, *name, "its velocity")) {
        change.index = body;
        all.push_back(change);
      }
      changes_.give(all, when);
      return true;
    }
    return false;
  }

  bool kick_formula(const std::vector<const Node*>& components, double unit, Change& change) {
    Readings<D> found(names_);
    std::vector<std::string> texts;
    for (const Node* each : components) {
      texts.push_back(typed(*each));
      if (!found.read(*each, "to", texts.back())) return false;
    }
    auto made = sim::value_formulas(texts, unit, found.words(), found.refused(), names_.constants.numbers());
    if (const auto* fault = std::get_if<std::pair<int, sim::ExpressionFault>>(&made)) {
      complain(*components[std::size_t(fault->first)], "to", fault->second, found.known(), complaints_);
      return false;
    }
    change.formula = std::make_shared<const sim::Program>(std::get<sim::Program>(std::move(made)));
    change.reads = found.all();
    return true;
  }

  // the speed of a surface; false: the key is another's
  bool belt(const Node& node, const Node& to, When& when) {
    const auto name = owner(node.text(), "surface_speed");
    if (!name || !names_.is_body(*name)) return false;
    const auto made = model_with(node, to);
    if (!made) return true;
    std::vector<Change> all;
    for (const int body : names_.roster.bodies(*name, node.place, complaints_)) {
      all.push_back(changes_.of(Change::Of::belt, body));
      all.back().spin = made->bodies[std::size_t(body)].belt;
    }
    changes_.give(all, when);
    return true;
  }

  // the dry friction of a pin, in space of a hinge, or of a slider
  void rub(const Node& node, const std::string& text, const Node& to, When& when) {
    const auto made = model_with(node, to);
    if (!made) return;
    std::vector<Change> all;
    for (const int joint : names_.joints(text)) {
      const sim::Joint<D>& its = made->joints[std::size_t(joint)];
      if (!sim::has_free_row(its)) {
        complaints_.add(node.place,
                        fmt::format("'set': the friction of {} stays as it is while the room runs",
                                    scene::in_quotes(its.name)));
        return;
      }
      all.push_back(changes_.of(Change::Of::rub, joint, its.friction));
    }
    changes_.give(all, when);
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
      std::vector<Change> all;
      for (const int spring : those)
        if (made) all.push_back(changes_.of(key.of, spring, made->springs[std::size_t(spring)].*key.value));
      changes_.give(all, when);
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
    std::vector<Change> all;
    for (const int joint : those) {
      const auto& its = made->joints[std::size_t(joint)].motor;
      if (!its) {
        complaints_.add(node.place, fmt::format("{} has no motor", scene::in_quotes(text)));
        return;
      }
      all.push_back(changes_.of(Change::Of::motor, joint));
      all.back().motor = *its;
    }
    changes_.give(all, when);
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
    Change change = changes_.of(Change::Of::force, -1);
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
    changes_.give({change}, when);
  }

  std::optional<sim::Model<D>> model_with(const Node& node, const Node& to) {
    return rebuild_(node.text() + "=" + toml(to), node.place, complaints_);
  }

  const WhenNames<D>& names_;
  const Rebuild<D>& rebuild_;
  Changes<D>& changes_;
  sim::Model<D>& model_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void setting(const Node& set, const Node* to, const Rebuild<D>& rebuild, Changes<D>& changes,
             sim::When<D>& when) {
  SettingReader<D>(rebuild, changes).set(set, to, when);
}

template void setting<2>(const Node&, const Node*, const Rebuild<2>&, Changes<2>&, sim::When<2>&);
template void setting<3>(const Node&, const Node*, const Rebuild<3>&, Changes<3>&, sim::When<3>&);

}  // namespace obscura::scene
