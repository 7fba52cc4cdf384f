#include "scene/conditions.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/model/condition.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

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

template <int D>
class ConditionBuilder {
 public:
  using When = sim::When<D>;
  using On = typename When::On;

  ConditionBuilder(const WhenNames<D>& names, Constants& constants, Diagnostics& complaints)
      : names_(names), constants_(constants), model_(names.model), complaints_(complaints) {}

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

 private:
  void pairs(const Node& node, const char* key, When& when) {
    const std::vector<int> a = names_.side(node.list()[0]), b = names_.side(node.list()[1]);
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
      const std::vector<int> some = names_.roster.bodies(one.text(), one.place, complaints_);
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
        const std::vector<int> held =
            starts && !names_.is_body(name) ? names_.joints(name) : std::vector<int>();
        if (!starts || (!names_.is_body(name) && held.empty())) continue;
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
        const std::vector<int> found = names_.roster.bodies(name, node.place, complaints_);
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
      for (const Group& group : names_.roster.groups)
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
    when.those = names_.joints(node.text());
    for (const NameRange& bond : names_.bonds)
      for (int k = bond.first; bond.name == node.text() && k < bond.end; ++k) when.those.push_back(-1 - k);
    if (when.those.empty()) {
      complaints_.add(node.place, names_.unknown_joint(node.text()));
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
    each_action(names_.top, [&](const Node& action) {
      const Node* release = action.find("release");
      if (!release) return;
      for (const int joint : names_.joints(release->text()))
        any = any || std::find(those.begin(), those.end(), joint) != those.end();
    });
    return any;
  }

  const WhenNames<D>& names_;
  Constants& constants_;
  const sim::Model<D>& model_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void condition(const Fields& fields, const WhenNames<D>& names, Constants& constants, sim::When<D>& when,
               Diagnostics& complaints) {
  ConditionBuilder<D>(names, constants, complaints).condition(fields, when);
}

template void condition<2>(const Fields&, const WhenNames<2>&, Constants&, sim::When<2>&, Diagnostics&);
template void condition<3>(const Fields&, const WhenNames<3>&, Constants&, sim::When<3>&, Diagnostics&);

}  // namespace obscura::scene
