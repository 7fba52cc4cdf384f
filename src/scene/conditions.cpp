#include "scene/conditions.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/readings.h"
#include "sim/model/condition.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

template <int D>
class ConditionBuilder {
 public:
  using When = sim::When<D>;
  using On = typename When::On;

  ConditionBuilder(const WhenNames<D>& names, Diagnostics& complaints)
      : names_(names), constants_(names.constants), model_(names.model), complaints_(complaints) {}

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
    const std::string what = fmt::format("'{}': {} and {}", key, scene::in_quotes(node.list()[0].text()),
                                         scene::in_quotes(node.list()[1].text()));
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
    Readings<D> found(names_);
    if (!found.read(node, "value", text)) return;
    auto made = sim::condition_formula(text, found.words(), found.refused(), constants_.numbers());
    if (const auto* fault = std::get_if<sim::ExpressionFault>(&made))
      return complain(node, "value", *fault, found.known(), complaints_);
    when.value = std::make_shared<const sim::Program>(std::get<sim::Program>(std::move(made)));
    when.reads = found.all();
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
                                              scene::in_quotes(node.text())));
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
  const Constants& constants_;
  const sim::Model<D>& model_;
  Diagnostics& complaints_;
};

}  // namespace

template <int D>
void condition(const Fields& fields, const WhenNames<D>& names, sim::When<D>& when, Diagnostics& complaints) {
  ConditionBuilder<D>(names, complaints).condition(fields, when);
}

template void condition<2>(const Fields&, const WhenNames<2>&, sim::When<2>&, Diagnostics&);
template void condition<3>(const Fields&, const WhenNames<3>&, sim::When<3>&, Diagnostics&);

}  // namespace obscura::scene
