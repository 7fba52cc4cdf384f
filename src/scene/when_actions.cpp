#include "scene/when_actions.h"

#include <fmt/format.h>

#include <algorithm>

#include "scene/when_changes.h"
#include "sim/shape/shape.h"

namespace obscura::scene {

namespace {

constexpr std::size_t kMostSticking = 20'000;                                             // pairs
constexpr std::string_view kTaken[] = {"end", "max", "min", "mean", "argmax", "argmin"};  // of --measure

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
        complaints_(complaints),
        changes_(names, world, complaints) {}

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
      if (set) setting(*set, to, rebuild_, changes_, when);
    }
  }

 private:
  void note(const Node& mark, When& when) {
    for (const std::string_view word : kTaken) {
      if (mark.text() != word) continue;
      complaints_.add(mark.place, fmt::format("'mark': {} is a word of --measure; choose another",
                                              scene::in_quotes(mark.text())));
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

  void let_go(const Node& node, const std::string& text, When& when) {
    if (changes_.bonded(node.place)) return;
    if (!names_.is_body(text)) {
      Action action{Do::part, "", names_.joints(text)};
      if (action.of.empty() && loosen(names_.springs_called(text), true, when)) return;
      if (action.of.empty()) {
        std::vector<std::string_view> names;
        for (const Group& group : names_.roster.groups) names.push_back(group.name);
        for (const sim::Joint<D>& joint : model_.joints) names.push_back(joint.name);
        for (const NameRange& spring : names_.springs) names.push_back(spring.name);
        complaints_.add(node.place, fmt::format("no body, joint or spring is called {}{}",
                                                scene::in_quotes(text), did_you_mean(text, names)));
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
    changes_.let_go(node.place, text, when);
  }

  // lets go of springs, or joins them; false where there are none
  bool loosen(const std::vector<int>& those, bool loose, When& when) {
    std::vector<Change> all;
    for (const int spring : those) all.push_back(changes_.of(Change::Of::loose, spring, loose));
    return changes_.give(all, when);
  }

  // makes joints or joins springs of a name, or holds together two sides, one each or each with the one
  void join(const Node& node, When& when) {
    if (node.is_text() && names_.joints(node.text()).empty() && !changes_.bonded(node.place) &&
        loosen(names_.springs_called(node.text()), false, when))
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
                          scene::in_quotes(node.text())));
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
                                              scene::in_quotes(node.list()[0].text()), a.size(),
                                              scene::in_quotes(node.list()[1].text()), b.size()));
      return;
    }
    Action action{Do::change, "", {}};
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
      const int one = a[a.size() == 1 ? 0 : i], other = b[b.size() == 1 ? 0 : i];
      if (one == other || !(changes_.moves(one) || changes_.moves(other))) {
        complaints_.add(node.place,
                        one == other ? fmt::format("'join': both are {}", scene::in_quotes(named(one)))
                                     : fmt::format("'join': neither {} nor {} moves",
                                                   scene::in_quotes(named(one)), scene::in_quotes(named(other))));
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
      action.of.push_back(changes_.moves(a) || changes_.moves(b) ? joining(glued(a, b)) : -1);
    when.actions.push_back(std::move(action));
  }

  bool no_joining(Place place) {
    if (changes_.bonded(place)) return true;
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
  int joining(int joint) { return changes_.number(changes_.of(Change::Of::join, joint)); }

  const WhenNames<D>& names_;
  const Rebuild<D>& rebuild_;
  sim::World<D>& world_;
  sim::Model<D>& model_;
  Glued& glued_;
  Diagnostics& complaints_;
  Changes<D> changes_;
};

}  // namespace

template <int D>
void actions(const Fields& fields, const WhenNames<D>& names, const Rebuild<D>& rebuild, sim::World<D>& world,
             Glued& glued, sim::When<D>& when, Diagnostics& complaints) {
  ActionBuilder<D>(names, rebuild, world, glued, complaints).actions(fields, when);
}

template <int D>
void ready_to_let_go(const Node& top, const NameTable& roster, Constants& constants, sim::World<D>& world,
                     Diagnostics& complaints) {
  sim::Model<D>& model = world.model;
  const WhenNames<D> names{top, roster, {}, {}, model, constants, complaints};
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
                                               scene::in_quotes(model.bodies[std::size_t(body)].name)));
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

#define OBSCURA_INSTANTIATE(D)                                                                               \
  template void ready_to_let_go<D>(const Node&, const NameTable&, Constants&, sim::World<D>&, Diagnostics&); \
  template void actions<D>(const Fields&, const WhenNames<D>&, const Rebuild<D>&, sim::World<D>&, Glued&,    \
                           sim::When<D>&, Diagnostics&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::scene
