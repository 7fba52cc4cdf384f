// Each preset is a force written as an expression, but for pairs of all bodies and for the fluid.

#include "scene/forces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "scene/fields.h"
#include "scene/links.h"
#include "scene/when_names.h"
#include "sim/force/formula.h"

namespace obscura::scene {

namespace {

constexpr double kMostPairs = 20'000'000;

// the forces of one scene on their way into its world
template <int D>
class ForceBuilder {
 public:
  ForceBuilder(const Node& top, Constants& constants, const Seating<D>& roster, sim::World<D>& world,
               Diagnostics& complaints)
      : top_(top), constants_(constants), roster_(roster), world_(world), complaints_(complaints) {
    for (const sim::Drive<D>& drive : world.model.drives)
      if (drive.release || drive.by_event) released_.insert(drive.body);
    each_action(top, [&](const Node& action) { note_set(action); });
  }

  void build() {
    each("force", [&](const Fields& fields, const std::string& name) { of_expressions(fields, name); });
    each("attractor", [&](const Fields& fields, const std::string& name) { attractor(fields, name); });
    room();
  }

 private:
  using Force = sim::Force<D>;
  using Subject = sim::Subject<D>;
  using On = typename Force::On;

  // a body whose charge or drag an event sets: fields act on it though it may have none at the start
  void note_set(const Node& action) {
    const Node* set = action.find("set");
    if (!set || !set->is_text()) return;
    for (auto& [key, those] : given_later_) {
      const std::string& text = set->text();
      if (!text.ends_with(key)) continue;
      Diagnostics elsewhere("", {});  // the condition tells of it
      for (const int body : roster_.bodies(text.substr(0, text.size() - key.size()), set->place, elsewhere))
        those.insert(body);
    }
  }
  bool gets(const char* key, int body) const { return given_later_.at(key).count(body) > 0; }

  template <class Build>
  void each(const std::string& kind, Build&& build) {
    const Node* all = top_.find(kind);
    for (std::size_t k = 0; all && k < all->list().size(); ++k) {
      const Fields fields(all->list()[k], kind);
      build(fields, fields.given("name") ? fields.text("name") : fmt::format("{}[{}]", kind, k));
    }
  }

  Subject subject(int body) const {
    const sim::Body<D>& it = world_.model.bodies[std::size_t(body)];
    Subject made;
    made.body = body, made.mass = it.mass, made.charge = it.charge, made.copy = it.copy;
    made.drag = it.drag, made.quadratic_drag = it.quadratic_drag;
    return made;
  }

  // the bodies of a reference or a list of them, each once; none where something is wrong
  std::vector<int> named(const Node& node) {
    std::vector<int> all;
    const auto add = [&](const Node& one) {
      const std::vector<int> found = roster_.bodies(one.text(), one.place, complaints_);
      all.insert(all.end(), found.begin(), found.end());
      return !found.empty();
    };
    if (node.is_text()) {
      add(node);
      return all;
    }
    for (const Node& one : node.list())
      if (!add(one)) return {};
    std::set<int> once;
    for (const int body : all) {
      if (once.insert(body).second) continue;
      complaints_.add(node.place,
                      fmt::format("'{}' is in the list twice", world_.model.bodies[std::size_t(body)].name));
      return {};
    }
    return all;
  }

  // the bodies that it acts on, all of them but its centre where `of` is left out
  std::vector<int> acted_on(const Fields& fields, int center) {
    if (const Node* of = fields.given("of")) {
      std::vector<int> all = named(*of);
      if (center >= 0 && std::find(all.begin(), all.end(), center) != all.end()) {
        complaints_.add(of->place, fmt::format("'{}' is both the centre and a body that the force acts on",
                                               world_.model.bodies[std::size_t(center)].name));
        return {};
      }
      return all;
    }
    std::vector<int> all;
    for (int body = 0; body < int(world_.model.bodies.size()); ++body)
      if (body != center) all.push_back(body);
    return all;
  }

  std::optional<Subject> center(const Node& node) {
    const std::vector<sim::End<D>> ends = scene::ends<D>(node, roster_, world_, complaints_);
    if (ends.empty()) return {};
    if (ends.size() > 1) {
      complaints_.add(node.place, fmt::format("'center': expected one body, got {}", ends.size()));
      return {};
    }
    Subject made;
    if (ends[0].body >= 0) made = subject(ends[0].body);
    made.local = ends[0].local;
    return made;
  }

  void give(Force force) {
    if (force.on == On::each)
      std::erase_if(force.subjects, [&](const Subject& it) {
        return world_.model.bodies[std::size_t(it.body)].fixed && !released_.count(it.body) &&
               !(force.center && force.center->body >= 0);
      });
    if (!force.subjects.empty()) world_.model.forces.push_back(std::move(force));
  }

  void of_expressions(const Fields& fields, const std::string& name) {
    Force force;
    force.name = name;
    const Node *among = fields.given("among"), *between = fields.given("between"), *of = fields.given("of"),
               *middle = fields.given("center");
    const Node *potential = fields.given("potential"), *components = fields.given("components"),
               *torque = fields.given("torque"), *at = fields.given("at");
    if (int(of != nullptr) + int(among != nullptr) + int(between != nullptr) > 1) {
      complaints_.add(
          fields.place(),
          fmt::format("{}: 'of', 'among' and 'between' each say what it acts on; give one", name));
      return;
    }
    if ((potential != nullptr) == (components || torque)) {
      const char* says = potential ? "{}: a 'potential' is all of its force and torque; leave the others out"
                                   : "{} needs one of 'potential' and 'components', or a 'torque'";
      complaints_.add(fields.place(), fmt::format(fmt::runtime(says), name));
      return;
    }
    const bool pair = among || between;
    if (pair && torque) {
      complaints_.add(torque->place,
                      "'torque' is of forces on each body; what two give each other is a joint's");
      return;
    }
    if (pair && middle) {
      complaints_.add(
          middle->place,
          "'center' is of forces on each body; between two, d is the way from the first to the second");
      return;
    }
    if (pair && at) {
      complaints_.add(at->place, "'at' is of forces on each body; between two they act at centres of mass");
      return;
    }
    if (among) {
      force.on = On::among;
      for (const int body : named(*among)) force.subjects.push_back(subject(body));
      if (force.subjects.size() == 1)
        complaints_.add(among->place, "'among' is one body; a force between bodies needs two");
      if (too_many(force.subjects.size(), among->place) || force.subjects.size() < 2) return;
    } else if (between) {
      force.on = On::between;
      if (!pairs(*between, force)) return;
    } else {
      if (middle && !(force.center = center(*middle))) return;
      for (const int body : acted_on(fields, force.center ? force.center->body : -1))
        force.subjects.push_back(subject(body));
      if (torque && !turned_by(*torque, of != nullptr, force)) return;
      if (at && !turned_by(*at, of != nullptr, force)) return;
      for (Subject& it : force.subjects)
        if (at && turns(it)) it.local = roster_.seats[std::size_t(it.body)].seen(vector<D>(*at));
    }

    sim::ForceText text;
    text.pair = pair, text.centered = force.center.has_value();
    if (potential) text.potential = typed(*potential), constants_.read_by(text.potential);
    for (int k = 0; components && k < D; ++k)
      text.components.push_back(typed(components->list()[std::size_t(k)])),
          constants_.read_by(text.components.back());
    for (int k = 0; torque && k < sim::kAngular<D>; ++k)
      text.torque.push_back(typed(D == 2 ? *torque : torque->list()[std::size_t(k)])),
          constants_.read_by(text.torque.back());
    const auto made = sim::force_formula<D>(text, constants_.numbers());
    if (const auto* fault = std::get_if<sim::ForceFault>(&made)) {
      std::vector<std::string> names = sim::force_names<D>(pair);
      for (const auto& [constant, value] : constants_.numbers()) names.push_back(constant);
      const Node& wrong = fault->component < 0 ? *potential : fault->torque ? *torque : *components;
      complain(wrong.is_list() ? wrong.list()[std::size_t(fault->component)] : wrong,
               potential       ? "potential"
               : fault->torque ? "torque"
                               : "components",
               fault->fault, names, complaints_);
      return;
    }
    force.formula = std::make_shared<sim::ForceFormula>(std::get<sim::ForceFormula>(made));
    if (potential && force.formula->torque && !turned_by(*potential, of != nullptr, force)) return;
    give(std::move(force));
  }

  bool turns(const Subject& it) const { return world_.model.bodies[std::size_t(it.body)].turns(); }

  // whether all that are named turn
  bool turned_by(const Node& by, bool named, const Force& force) {
    if (force.center && force.center->body >= 0) {
      complaints_.add(by.place,
                      "what turns a body needs a 'center' that is a place: no body would feel the opposite");
      return false;
    }
    for (const Subject& it : force.subjects) {
      if (!named || turns(it)) continue;
      complaints_.add(by.place,
                      fmt::format("'{}' does not turn", world_.model.bodies[std::size_t(it.body)].name));
      return false;
    }
    return true;
  }

  bool pairs(const Node& between, Force& force) {
    std::vector<int> sides[2];
    for (std::size_t k = 0; k < 2; ++k) {
      const Node& end = between.list()[k];
      if (!end.is_text()) {
        complaints_.add(end.place, "'between': expected the name of a body; a force acts at centres of mass");
        return false;
      }
      sides[k] = roster_.bodies(end.text(), end.place, complaints_);
      if (sides[k].empty()) return false;
    }
    const std::size_t a = sides[0].size(), b = sides[1].size();
    if (a != b && a != 1 && b != 1) {
      complaints_.add(
          between.place,
          fmt::format("'between' has {} bodies on one side and {} on the other: expected as many, or one", a,
                      b));
      return false;
    }
    for (std::size_t i = 0; i < std::max(a, b); ++i) {
      const int first = sides[0][a == 1 ? 0 : i], second = sides[1][b == 1 ? 0 : i];
      if (first == second) {
        complaints_.add(between.place,
                        fmt::format("'{}' is on both sides", world_.model.bodies[std::size_t(first)].name));
        return false;
      }
      force.subjects.push_back(subject(first)), force.subjects.push_back(subject(second));
    }
    return true;
  }

  bool too_many(std::size_t n, Place place) {
    const double pairs = 0.5 * double(n) * (double(n) - 1);
    if (pairs <= kMostPairs) return false;
    complaints_.add(
        place, fmt::format("{} bodies are {:.0f} pairs, and {:.0f} is the most that a force may act between",
                           n, pairs, kMostPairs));
    return true;
  }

  // the formula of a preset, which has no faults
  static std::shared_ptr<const sim::ForceFormula> formula(const sim::ForceText& text,
                                                          const sim::NamedNumbers& numbers) {
    auto made = sim::force_formula<D>(text, numbers);
    assert(std::holds_alternative<sim::ForceFormula>(made));
    return std::make_shared<sim::ForceFormula>(std::move(std::get<sim::ForceFormula>(made)));
  }

  void attractor(const Fields& fields, const std::string& name) {
    const Node* middle = fields.given("center");
    if (!middle || !fields.given("strength")) return;
    Force force;
    force.name = name;
    if (!(force.center = center(*middle))) return;
    for (const int body : acted_on(fields, force.center->body)) force.subjects.push_back(subject(body));
    const double softening = fields.number("softening");
    sim::ForceText text;
    text.potential = softening > 0 ? "-S*m/sqrt(r^2 + s^2)" : "-S*m/r";
    text.centered = true;
    force.strength = -fields.number("strength"), force.softening = softening;
    force.formula = formula(text, {{"S", fields.number("strength")}, {"s", softening}});
    give(std::move(force));
  }

  template <class Takes>
  std::vector<Subject> all_that(Takes&& takes) const {
    std::vector<Subject> all;
    for (int body = 0; body < int(world_.model.bodies.size()); ++body) {
      Subject one = subject(body);
      if (takes(one)) all.push_back(one);
    }
    return all;
  }

  // what the room has everywhere
  void room() {
    const Fields fields = Fields::of(top_, "room");
    const auto charged = [&](const Subject& it) { return it.charge != 0 || gets(".charge", it.body); };
    for (const bool masses : {true, false}) {
      const char* key = masses ? "gravitation" : "coulomb";
      if (fields.number(key) == 0) continue;
      Force force;
      force.name = fmt::format("room.{}", key);
      force.on = On::among, force.law = masses ? Force::Law::gravitation : Force::Law::coulomb;
      force.strength = fields.number(key), force.softening = fields.number("softening");
      force.subjects = all_that([&](const Subject& it) { return masses || charged(it); });
      if (!too_many(force.subjects.size(), fields.place(key)) && force.subjects.size() > 1)
        give(std::move(force));
    }
    const sim::Vec<D> E = fields.vector<D>("electric"), wind = fields.vector<D>("wind");
    if (!E.isZero(0)) {
      Force force;
      force.name = "room.electric", force.subjects = all_that(charged);
      sim::ForceText text;
      text.potential = D == 2 ? "-charge*(a*x + b*y)" : "-charge*(a*x + b*y + c*z)";
      force.formula = formula(text, {{"a", E[0]}, {"b", E[1]}, {"c", E[D - 1]}});
      give(std::move(force));
    }
    magnetic(fields.node("magnetic", D), all_that(charged));
    air(wind, all_that([&](const Subject& it) {
          return it.quadratic_drag > 0 || gets(".quadratic_drag", it.body) ||
                 ((it.drag > 0 || gets(".drag", it.body)) && !wind.isZero(0));
        }));
    if (const Node* fluid = fields.given("fluid")) float_in(Fields(*fluid, "room.fluid"));
  }

  void magnetic(const Node& node, std::vector<Subject> subjects) {
    double B[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k)
      B[k] = D == 3 ? node.list()[std::size_t(k)].number() : k == 2 ? node.number() : 0;
    if (B[0] == 0 && B[1] == 0 && B[2] == 0) return;
    Force force;
    force.name = "room.magnetic", force.subjects = std::move(subjects);
    sim::ForceText text;
    if (D == 2)
      text.components = {"charge*c*vy", "-charge*c*vx"};
    else
      text.components = {"charge*(c*vy - b*vz)", "charge*(a*vz - c*vx)", "charge*(b*vx - a*vy)"};
    auto its = std::make_shared<sim::ForceFormula>(*formula(text, {{"a", B[0]}, {"b", B[1]}, {"c", B[2]}}));
    its->works = its->feeds = its->resting = false;
    force.formula = std::move(its);
    give(std::move(force));
  }

  // quadratic drag, and the wind on both kinds of drag: -c v itself is the integrators'
  void air(const sim::Vec<D>& wind, std::vector<Subject> subjects) {
    if (subjects.empty()) return;
    Force force;
    force.name = wind.isZero(0) ? "quadratic_drag" : "room.wind", force.subjects = std::move(subjects);
    force.drag = true;
    sim::ForceText text;
    const std::string u[] = {"(vx - a)", "(vy - b)", "(vz - c)"}, w[] = {"a", "b", "c"};
    std::string squares;
    for (int k = 0; k < D; ++k) squares += (k > 0 ? " + " : "") + u[k] + "^2";
    for (int k = 0; k < D; ++k)
      text.components.push_back("_drag*" + w[k] + " - _quadratic_drag*sqrt(" + squares + ")*" + u[k]);
    auto its = std::make_shared<sim::ForceFormula>(
        *formula(text, {{"a", wind[0]}, {"b", wind[1]}, {"c", wind[D - 1]}}));
    its->feeds = its->resting = !wind.isZero(0);
    force.formula = std::move(its);
    give(std::move(force));
  }

  void float_in(const Fields& fields) {
    if (!fields.given("level") || !fields.given("density")) return;
    const sim::Vec<D>& g = world_.model.gravity;
    sim::Vec<D> level_part = g;
    level_part[1] = 0;
    if (!level_part.isZero(0) || g[1] > 0) {
      complaints_.add(fields.place(),
                      "'fluid' needs gravity that points down, along -y: its surface is level");
      return;
    }
    Force force;
    force.name = "room.fluid", force.law = Force::Law::buoyancy;
    force.level = fields.number("level"), force.density = fields.number("density");
    force.subjects = all_that([](const Subject&) { return true; });
    if (force.density > 0) give(std::move(force));
  }

  const Node& top_;
  Constants& constants_;
  const Seating<D>& roster_;
  sim::World<D>& world_;
  Diagnostics& complaints_;
  std::set<int> released_;  // bodies that are fixed until they are let go
  std::map<std::string, std::set<int>> given_later_{{".charge", {}}, {".drag", {}}, {".quadratic_drag", {}}};
};

}  // namespace

template <int D>
void forces(const Node& top, Constants& constants, const Seating<D>& roster, sim::World<D>& world,
            Diagnostics& complaints) {
  ForceBuilder<D>(top, constants, roster, world, complaints).build();
}

template void forces<2>(const Node&, Constants&, const Seating<2>&, sim::World<2>&, Diagnostics&);
template void forces<3>(const Node&, Constants&, const Seating<3>&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
