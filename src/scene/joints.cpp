#include "scene/joints.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <variant>
#include <vector>

#include "scene/body_kinds.h"
#include "scene/expressions.h"
#include "scene/fields.h"
#include "scene/joint_words.h"
#include "scene/links.h"
#include "scene/mechanisms.h"
#include "sim/constraint/joints/joint.h"
#include "sim/math/orientation.h"
#include "sim/model/drives.h"

namespace obscura::scene {

namespace {

using sim::JointKind;

constexpr std::size_t kMostJoints = 1'000'000;
// the longest lever, as a multiple of the largest coordinate of a room or a body
constexpr double kLongest = 100;

constexpr double kSamePlace = 1e-9;  // of the room's size: places this near are one

template <int D>
JointKind type(const std::string& word) {
  const auto found = std::ranges::find(kJointWords, word, &JointWord::word);
  return found == std::end(kJointWords) ? JointKind::pin : found->kind(D);
}

// "a pin, a weld or a slider": the kinds of joint for which `its` is true
template <int D>
std::string kinds(const std::function<bool(const sim::JointEquations<D>&)>& its) {
  std::vector<std::string> all;
  std::set<JointKind> known;
  for (const JointWord& each : kJointWords)
    if (known.insert(each.kind(D)).second && !sim::equations<D>(each.kind(D)).mechanism &&
        (D == 3 || each.kind(D) != JointKind::screw) && its(sim::equations<D>(each.kind(D))))
      all.push_back(fmt::format("a {}", each.word));
  std::string last = all.back();
  all.pop_back();
  return all.empty() ? last : fmt::format("{} or {}", fmt::join(all, ", "), last);
}

// a direction of the room as the body at an end sees it
template <int D>
sim::Vec<D> as_seen(const sim::World<D>& world, int body, const sim::Vec<D>& direction) {
  const sim::Orientation<D> turn = turn_of(world, body);
  return turn == sim::no_rotation<D>() ? direction : turned<D>(direction, sim::inverse<D>(turn));
}

// a place of the room as an end of a body
template <int D>
sim::End<D> on(const sim::World<D>& world, int body, const sim::Vec<D>& at) {
  if (body < 0) return {-1, at};
  return {body, as_seen<D>(world, body, at - world.state.x[std::size_t(body)])};
}

// one side of `between`: its meaning, and whether it gives a place
template <int D>
struct JointSide {
  std::vector<sim::End<D>> ends;
  bool says_where = false;

  const sim::End<D>& operator[](int i) const { return ends[ends.size() == 1 ? 0 : std::size_t(i)]; }
};

template <int D>
JointSide<D> side(const Node& node, const Seating<D>& roster, const sim::World<D>& world,
                  Diagnostics& complaints) {
  if (node.is_text() && node.text() == "room") return {{sim::End<D>{}}, false};
  return {ends(node, roster, world, complaints),
          node.is_list() || node.find("local") != nullptr || node.find("at") != nullptr};
}

// keys of some kinds of joint only
template <int D>
void refuse_others(const Fields& fields, JointKind kind, Diagnostics& complaints) {
  using Its = sim::JointEquations<D>;
  const auto only = [&](const char* key, bool (*may)(const Its&)) {
    if (fields.given(key) && !may(sim::equations<D>(kind)))
      complaints.add(fields.place(key), fmt::format("'{}' is that of {}; a {} has none", key, kinds<D>(may),
                                                    fields.text("type")));
  };
  only("at", [](const Its& its) { return !its.apart; });
  only("axis", [](const Its& its) { return its.axis; });
  only("length", [](const Its& its) { return its.apart; });
  for (const char* key : {"limits", "motor", "friction", "spring"})
    only(key, [](const Its& its) { return its.coordinate != nullptr; });
}

// those of pulleys and gears in others
void refuse_keys_of_mechanisms(const Fields& fields, JointKind kind, Diagnostics& complaints) {
  const auto only = [&](const char* key, JointKind its, const char* name) {
    if (kind != its && fields.given(key))
      complaints.add(fields.place(key),
                     fmt::format("'{}' is that of a {}; a {} has none", key, name, fields.text("type")));
  };
  only("over", JointKind::pulley, "pulley");
  only("joints", JointKind::gear, "gear"), only("ratio", JointKind::gear, "gear");
  only("pitch", JointKind::screw, "screw");
  only("turns", JointKind::pulley, "pulley");
  only("wound", JointKind::pulley, "pulley");
}

template <int D>
class Joining {
 public:
  using Vec = sim::Vec<D>;
  using End = sim::End<D>;

  Joining(const Fields& fields, JointKind kind, const JointSide<D>& a, const JointSide<D>& b,
          Constants& constants, sim::World<D>& world, Diagnostics& complaints)
      : fields_(fields),
        kind_(kind),
        its_(sim::equations<D>(kind)),
        a_(a),
        b_(b),
        constants_(constants),
        world_(world),
        complaints_(complaints) {
    for (const sim::Wall<D>& wall : world.model.walls)
      size_ = std::max(size_, wall.point.cwiseAbs().maxCoeff());
    for (const Vec& x : world.state.x) size_ = std::max(size_, x.cwiseAbs().maxCoeff());
  }

  // the i-th joint; none, and a complaint, where it cannot be
  std::optional<sim::Joint<D>> joint(const std::string& name, int i) {
    sim::Joint<D> it;
    it.name = name;
    it.kind = kind_;
    it.later = !fields_.flag("joined");
    it.a = a_[i], it.b = b_[i];
    bool a_says = a_.says_where, b_says = b_.says_where;
    // against the room it is the body that moves
    if (it.a.body < 0) std::swap(it.a, it.b), std::swap(a_says, b_says);
    const Place place = fields_.place("between");
    if (it.a.body < 0) return refuse(place, "'between' names no body: it would hold nothing");
    const sim::Body<D>& body = world_.model.bodies[std::size_t(it.a.body)];
    if (it.a.body == it.b.body) return refuse(place, fmt::format("both ends are on '{}'", body.name));
    if (!(its_.apart ? stretch(it, b_says) : meet(it, a_says, b_says))) return {};
    // a lever out of all proportion makes motion of rounding
    for (const End& end : {it.a, it.b}) {
      const double lever = end.body < 0 ? 0 : end.local.stableNorm();
      if (!(lever <= kLongest * (1 + size_)))
        return refuse(fields_.given("at") ? fields_.place("at") : place,
                      fmt::format("this is {:.3g} m from the middle of '{}': expected at most {:.3g}", lever,
                                  world_.model.bodies[std::size_t(end.body)].name, kLongest * (1 + size_)));
    }
    if (its_.turning) {
      for (const End& end : {it.a, it.b})
        if (end.body >= 0 && !world_.model.bodies[std::size_t(end.body)].turns())
          return refuse(
              place,
              fmt::format(
                  fmt::runtime(kind_of<D>(world_.model.bodies[std::size_t(end.body)]).called == "particle"
                                   ? "'{}' is a particle, which does not turn: a {} needs a [[ball]]"
                                   : "'{}' has rotation = false, and a {} is of bodies that turn"),
                  world_.model.bodies[std::size_t(end.body)].name, fields_.text("type")));
    }
    const auto held = [&](int end) {
      if (end < 0) return true;
      for (const sim::Drive<D>& drive : world_.model.drives)
        if (drive.body == end && (drive.release || drive.by_event)) return false;
      return world_.model.bodies[std::size_t(end)].fixed;
    };
    if (held(it.a.body) && held(it.b.body)) {
      const auto moved = [&](int end) { return end >= 0 && world_.model.bodies[std::size_t(end)].driven; };
      const bool any = moved(it.a.body) || moved(it.b.body);
      return refuse(
          place,
          any ? fmt::format("'{}' goes as its 'motion' says, and the other end stays: a joint would hold "
                            "nothing. A wheel that drives a gear has a joint with a 'motor', and no 'motion'",
                            moved(it.a.body) ? body.name : world_.model.bodies[std::size_t(it.b.body)].name)
              : fmt::format("'{}' is fixed, and so is the other end: nothing could move", body.name));
    }

    it.turn = sim::as_it_stands(it, world_.state, world_.model.joints.size()).turn;
    if (its_.axis) {
      const Vec axis = fields_.given("axis") ? fields_.vector<D>("axis")
                       : its_.angle          ? Vec(Vec::Unit(D - 1))
                                             : Vec(Vec::Unit(0));
      if (axis.isZero(0))
        return refuse(fields_.place("axis"), fmt::format("'axis' is zero: expected a direction such as {}",
                                                         D == 2 ? "[1, 0]" : "[1, 0, 0]"));
      it.axis = as_seen<D>(world_, it.b.body, axis.stableNormalized());
    }
    const auto own = [&](double x) { return its_.angle ? radians(x) : x; };
    if (const Node* limits = fields_.given("limits"))
      it.lower = own(limits->list()[0].number()), it.upper = own(limits->list()[1].number());
    if (const Node* limits = fields_.given("limits");
        limits && D == 3 && its_.angle && std::max(-it.lower, it.upper) > std::numbers::pi)
      return refuse(limits->place,
                    "limits of a hinge in space lie from -180 to 180 degrees, for its angle counts no whole "
                    "turns; in the plane they may "
                    "be wider");
    if (const Node* given = fields_.given("motor"); given && !motor(*given, it)) return {};
    if (const Node* given = fields_.given("spring"); given && !coil(*given, it)) return {};
    if (kind_ == JointKind::screw) {
      const Node* pitch = fields_.given("pitch");
      if (!pitch || pitch->number() == 0)
        return refuse(pitch ? pitch->place : fields_.place(),
                      "a screw needs a 'pitch', how far it goes in one turn, m");
      it.ratio = pitch->number() / (2 * std::numbers::pi);
    }
    it.friction = fields_.number("friction");
    if (const Node* breaks = fields_.given("breaks")) it.breaks = breaks->number();
    if (const Node* breaks = fields_.given("breaks_torque")) {
      if (kind_ == JointKind::rod || kind_ == JointKind::rope || kind_ == JointKind::wire)
        return refuse(breaks->place, fmt::format("a {} bears no torque; 'breaks' is the force that breaks it",
                                                 fields_.given("type")->text()));
      it.breaks_torque = breaks->number();
    }
    it.touching = fields_.flag("touching");
    return it;
  }

 private:
  std::optional<sim::Joint<D>> refuse(Place place, std::string message) {
    complaints_.add(place, std::move(message));
    return {};
  }

  // a key that is that of angles, where the joint has none, or of ways
  bool contrary(const Node& table, const char* angle, const char* way) {
    const Node* wrong = table.find(its_.angle ? way : angle);
    if (!wrong) return false;
    complaints_.add(wrong->place, fmt::format("'{}' is that of a {}; a {} has '{}'", its_.angle ? way : angle,
                                              its_.angle ? "slider" : "pin", fields_.text("type"),
                                              its_.angle ? angle : way));
    return true;
  }

  // a motor, whose aim is a number or an expression of the time
  bool motor(const Node& table, sim::Joint<D>& it) {
    if (contrary(table, "angle", "position")) return false;
    const Node *speed = table.find("speed"), *follows = table.find(its_.angle ? "angle" : "position"),
               *most = table.find("most");
    if (!most) return false;
    if (!speed == !follows) {
      complaints_.add(table.place, fmt::format("a motor needs {} 'speed' or '{}'", speed ? "one of" : "",
                                               its_.angle ? "angle" : "position"));
      return false;
    }
    const Node& aim = speed ? *speed : *follows;
    const double unit = its_.angle ? std::numbers::pi / 180 : 1;
    it.motor = {0, most->number()};
    if (speed && speed->is_number()) {
      it.motor->speed = its_.angle ? radians(speed->number()) : speed->number();
      return true;
    }
    sim::MotionText text;
    text.angle = typed(aim), text.angle_unit = unit;
    constants_.read_by(text.angle);
    auto made = sim::drive_formula<2>(text, constants_.numbers());
    if (const auto* fault = std::get_if<sim::MotionFault>(&made)) {
      std::vector<std::string> names{"t"};
      for (const auto& [name, value] : constants_.numbers()) names.push_back(name);
      for (const std::string_view name : sim::expression_functions()) names.emplace_back(name);
      for (const std::string_view name : sim::expression_numbers()) names.emplace_back(name);
      complain(aim, speed ? "speed" : its_.angle ? "angle" : "position", fault->fault, names, complaints_);
      return false;
    }
    it.motor->aim = std::make_shared<const sim::Program>(std::get<sim::Program>(std::move(made)));
    it.motor->follows = follows != nullptr;
    return true;
  }

  bool coil(const Node& table, sim::Joint<D>& it) {
    if (contrary(table, "rest_angle", "rest_position")) return false;
    const Node *stiffness = table.find("stiffness"), *damping = table.find("damping"),
               *rest = table.find(its_.angle ? "rest_angle" : "rest_position");
    if (!stiffness) return false;
    it.coil = {stiffness->number(), damping ? damping->number() : 0,
               rest ? its_.angle ? radians(rest->number()) : rest->number() : 0};
    return true;
  }

  // The place of a pin or a hinge between two bodies matters: they turn about it. A weld or a slider is the
  // same joint wherever it is.
  bool turns_about_place() const { return !its_.turning || its_.angle; }

  // its ends are at one place. An event takes that of the first end on the second body when it joins them.
  bool meet(sim::Joint<D>& it, bool a_says, bool b_says) {
    const Vec from_a = start(world_, it.a), from_b = start(world_, it.b);
    if (it.later && b_says && !a_says) {
      complaints_.add(
          fields_.place("between"),
          "an event makes this joint where its first end is then; put that which says where first");
      return false;
    }
    if (it.later && a_says && !fields_.given("at")) {
      it.b = on<D>(world_, it.b.body, from_a);
      return true;
    }
    if (const Node* at = fields_.given("at")) {
      if (a_says || b_says) {
        complaints_.add(at->place, "'at' and a point in 'between' both say where; leave one out");
        return false;
      }
      it.a = on<D>(world_, it.a.body, vector<D>(*at)), it.b = on<D>(world_, it.b.body, vector<D>(*at));
      return true;
    }
    if (a_says && b_says) {
      const double apart = (from_a - from_b).norm();
      if (apart <= kSamePlace * (1 + size_)) return true;
      complaints_.add(fields_.place("between"),
                      fmt::format("the two points of this {} are {:.3g} m apart at the start",
                                  fields_.text("type"), apart));
      return false;
    }
    // the one that says where; a body against the room, and bodies that lie on each other, have a place
    if (b_says) {
      it.a = on<D>(world_, it.a.body, from_b);
    } else if (a_says || it.b.body < 0 || !turns_about_place() ||
               (from_a - from_b).norm() <= kSamePlace * (1 + size_)) {
      it.b = on<D>(world_, it.b.body, from_a);
    } else {
      complaints_.add(
          fields_.place(),
          fmt::format("a {} between two bodies needs 'at', the place in the room where it is, or a "
                      "point of one in 'between'",
                      fields_.text("type")));
      return false;
    }
    return true;
  }

  // its ends are a length apart
  bool stretch(sim::Joint<D>& it, bool b_says) {
    if (it.b.body < 0 && !b_says) {
      complaints_.add(fields_.place("between"),
                      fmt::format("where in the room? A {} needs a place {}", fields_.text("type"),
                                  D == 2 ? "[x, y]" : "[x, y, z]"));
      return false;
    }
    const double apart = (start(world_, it.a) - start(world_, it.b)).norm();
    const Node* length = fields_.given("length");
    if (it.later) {
      if (length && !its_.one_sided)
        return complaints_.add(length->place, "a rod that an event makes is as long as it is then"), false;
      it.length = length ? length->number() : 0;
      return true;
    }
    it.length = apart;
    if (!length && apart == 0) {
      complaints_.add(fields_.place("between"),
                      fmt::format("the two points of this {} are one place", fields_.text("type")));
      return false;
    }
    if (!length) return true;
    const double slack = length->number() - apart, rounding = kSamePlace * (1 + size_);
    if (slack < -rounding || (!its_.one_sided && slack > rounding)) {
      complaints_.add(
          length->place,
          fmt::format("'length' is {} m and its ends are {:.6g} m apart at the start; move an end",
                      length->number(), apart));
      return false;
    }
    it.length = length->number();
    return true;
  }

  const Fields& fields_;
  JointKind kind_;
  const sim::JointEquations<D>& its_;
  const JointSide<D>&a_, &b_;
  Constants& constants_;
  sim::World<D>& world_;
  Diagnostics& complaints_;
  double size_ = 0;
};

}  // namespace

template <int D>
void joints(const Node& top, const Seating<D>& roster, Constants& constants, sim::World<D>& world,
            Diagnostics& complaints) {
  const Node* all = top.find("joint");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "joint");
    const Node* between = fields.given("between");
    if (!fields.given("type")) continue;
    const JointKind kind = type<D>(fields.text("type"));
    const std::string own = fields.given("name") ? fields.text("name") : fmt::format("joint[{}]", k);
    refuse_keys_of_mechanisms(fields, kind, complaints);
    if (kind == JointKind::gear) continue;  // later: it holds other joints
    if (D == 2 && kind == JointKind::screw) {
      complaints.add(fields.place("type"),
                     "a screw is of space; in the plane a slider goes along a line, and a gear "
                     "with a pin makes it turn");
      continue;
    }
    if (kind == JointKind::pulley) {
      pulley(fields, own, roster, world, complaints);
      continue;
    }
    if (!between) {
      complaints.add(fields.place(), fmt::format("a {} needs 'between', its two ends", fields.text("type")));
      continue;
    }
    refuse_others<D>(fields, kind, complaints);
    const JointSide<D> a = side(between->list()[0], roster, world, complaints);
    const JointSide<D> b = side(between->list()[1], roster, world, complaints);
    if (a.ends.empty() || b.ends.empty()) continue;
    if (a.ends.size() != b.ends.size() && a.ends.size() != 1 && b.ends.size() != 1) {
      complaints.add(
          between->place,
          fmt::format("'between' has {} ends on one side and {} on the other: expected as many, or one",
                      a.ends.size(), b.ends.size()));
      continue;
    }
    const int n = int(std::max(a.ends.size(), b.ends.size()));
    if (world.model.joints.size() + std::size_t(n) > kMostJoints) {
      complaints.add(between->place,
                     fmt::format("{} joints in all are more than {}, the most a scene may have",
                                 world.model.joints.size() + std::size_t(n), kMostJoints));
      continue;
    }
    Joining<D> joining(fields, kind, a, b, constants, world, complaints);
    for (int i = 0; i < n; ++i) {
      auto it = joining.joint(n == 1 ? own : fmt::format("{}[{}]", own, i), i);
      if (!it) break;
      world.model.joints.push_back(std::move(*it));
      world.state.broken.push_back(world.model.joints.back().later);
    }
  }
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "joint");
    if (!fields.given("type") || type<D>(fields.text("type")) != JointKind::gear) continue;
    gear(top, fields, fields.given("name") ? fields.text("name") : fmt::format("joint[{}]", k), world,
         complaints);
  }
}

template void joints<2>(const Node&, const Seating<2>&, Constants&, sim::World<2>&, Diagnostics&);
template void joints<3>(const Node&, const Seating<3>&, Constants&, sim::World<3>&, Diagnostics&);

}  // namespace obscura::scene
