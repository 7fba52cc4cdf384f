#include "scene/joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "scene/fields.h"
#include "scene/links.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;
using End = sim::End<2>;
using sim::JointKind;

constexpr std::size_t kMostJoints = 1'000'000;
constexpr double kRounding = 1e-9;  // of the room's size: places this near are one

JointKind type(const std::string& word) {
  using enum JointKind;
  return word == "weld"     ? weld
         : word == "slider" ? slider
         : word == "rod"    ? rod
         : word == "rope"   ? rope
                            : pin;
}

// the angle of an end's body at the start, rad
double angle(const sim::World<2>& world, int body) {
  const int k = body - int(world.state.x.size() - world.state.turn.size());
  return body < 0 || k < 0 ? 0 : world.state.turn[std::size_t(k)][0];
}

// a place of the room as an end of a body
End on(const sim::World<2>& world, int body, const Vec& at) {
  if (body < 0) return {-1, at};
  const Vec away = at - world.state.x[std::size_t(body)];
  const double its = angle(world, body);
  return {body, its == 0 ? away : turned(away, -its)};
}

// one side of `between`: what it means, and whether it says where
struct Side {
  std::vector<End> ends;
  bool says_where = false;

  const End& operator[](int i) const { return ends[ends.size() == 1 ? 0 : std::size_t(i)]; }
};

Side side(const Node& node, const Roster& roster, const sim::World<2>& world, Complaints& complaints) {
  if (node.is_text() && node.text() == "room") return {{End{}}, false};
  return {ends(node, roster, world, complaints),
          node.is_list() || node.find("local") != nullptr || node.find("at") != nullptr};
}

// keys of some kinds of joint only
void refuse_others(const Fields& fields, JointKind kind, Complaints& complaints) {
  const bool far = kind == JointKind::rod || kind == JointKind::rope;
  const bool moves = kind == JointKind::pin || kind == JointKind::slider;
  const auto only = [&](const char* key, bool good, const char* whose) {
    if (!good && fields.given(key))
      complaints.add(fields.place(key),
                     fmt::format("'{}' is that of {}; a {} has none", key, whose, fields.text("type")));
  };
  only("at", !far, "a pin, a weld or a slider");
  only("axis", kind == JointKind::slider, "a slider");
  only("length", far, "a rod or a rope");
  for (const char* key : {"limits", "motor", "friction"}) only(key, moves, "a pin or a slider");
}

class Joining {
 public:
  Joining(const Fields& fields, JointKind kind, const Side& a, const Side& b, sim::World<2>& world,
          Complaints& complaints)
      : fields_(fields), kind_(kind), a_(a), b_(b), world_(world), complaints_(complaints) {
    for (const sim::Wall<2>& wall : world.model.walls)
      size_ = std::max(size_, wall.point.cwiseAbs().maxCoeff());
    for (const Vec& x : world.state.x) size_ = std::max(size_, x.cwiseAbs().maxCoeff());
  }

  // the i-th joint; none, and a complaint, where it cannot be
  std::optional<sim::Joint<2>> joint(const std::string& name, int i) {
    sim::Joint<2> it;
    it.name = name;
    it.kind = kind_;
    it.a = a_[i], it.b = b_[i];
    bool a_says = a_.says_where, b_says = b_.says_where;
    // against the room it is the body that moves
    if (it.a.body < 0) std::swap(it.a, it.b), std::swap(a_says, b_says);
    const Place place = fields_.place("between");
    if (it.a.body < 0) return refuse(place, "'between' names no body: it would hold nothing");
    const sim::Body<2>& body = world_.model.bodies[std::size_t(it.a.body)];
    if (it.a.body == it.b.body) return refuse(place, fmt::format("both ends are on '{}'", body.name));
    const bool far = kind_ == JointKind::rod || kind_ == JointKind::rope;
    if (!far && !meet(it, a_says, b_says)) return {};
    if (far && !stretch(it, b_says)) return {};
    if (kind_ == JointKind::weld || kind_ == JointKind::slider) {
      for (const End& end : {it.a, it.b})
        if (end.body >= 0 && !world_.model.bodies[std::size_t(end.body)].turns())
          return refuse(place,
                        fmt::format("'{}' is a particle, which does not turn: a {} needs a [[ball]]",
                                    world_.model.bodies[std::size_t(end.body)].name, fields_.text("type")));
    }
    if (body.fixed && (it.b.body < 0 || world_.model.bodies[std::size_t(it.b.body)].fixed))
      return refuse(place,
                    fmt::format("'{}' is fixed, and so is the other end: nothing could move", body.name));

    it.turn << angle(world_, it.a.body) - angle(world_, it.b.body);
    if (kind_ == JointKind::slider) {
      const Vec axis = fields_.vector("axis");
      if (axis.isZero(0))
        return refuse(fields_.place("axis"), "'axis' is zero: expected a direction such as [1, 0]");
      it.axis = turned(axis.stableNormalized(), -angle(world_, it.b.body));
    }
    const auto own = [&](double x) { return kind_ == JointKind::pin ? radians(x) : x; };
    if (const Node* limits = fields_.given("limits"))
      it.lower = own(limits->list()[0].number()), it.upper = own(limits->list()[1].number());
    if (const Node* motor = fields_.given("motor"); motor && motor->find("speed") && motor->find("most"))
      it.motor = {own(motor->find("speed")->number()), motor->find("most")->number()};
    it.friction = fields_.number("friction");
    if (const Node* breaks = fields_.given("breaks")) it.breaks = breaks->number();
    it.touching = fields_.flag("touching");
    return it;
  }

 private:
  std::optional<sim::Joint<2>> refuse(Place place, std::string message) {
    complaints_.add(place, std::move(message));
    return {};
  }

  // pin, weld, slider: one place of both
  bool meet(sim::Joint<2>& it, bool a_says, bool b_says) {
    const Vec from_a = start(world_, it.a), from_b = start(world_, it.b);
    if (const Node* at = fields_.given("at")) {
      if (a_says || b_says) {
        complaints_.add(at->place, "'at' and a point in 'between' both say where; leave one out");
        return false;
      }
      it.a = on(world_, it.a.body, vector(*at)), it.b = on(world_, it.b.body, vector(*at));
      return true;
    }
    if (a_says && b_says) {
      const double apart = (from_a - from_b).norm();
      if (apart <= kRounding * (1 + size_)) return true;
      complaints_.add(fields_.place("between"),
                      fmt::format("the two points of this {} are {:.3g} m apart at the start",
                                  fields_.text("type"), apart));
      return false;
    }
    // the one that says where; a body against the room, and bodies that lie on each other, have a place
    if (b_says) {
      it.a = on(world_, it.a.body, from_b);
    } else if (a_says || it.b.body < 0 || kind_ != JointKind::pin ||
               (from_a - from_b).norm() <= kRounding * (1 + size_)) {
      it.b = on(world_, it.b.body, from_a);
    } else {
      complaints_.add(fields_.place(),
                      "a pin between two bodies needs 'at', the place in the room where it is, or a "
                      "point of one in 'between'");
      return false;
    }
    return true;
  }

  // rod, rope: two places, and how far apart
  bool stretch(sim::Joint<2>& it, bool b_says) {
    if (it.b.body < 0 && !b_says) {
      complaints_.add(fields_.place("between"),
                      fmt::format("where in the room? A {} needs a place [x, y]", fields_.text("type")));
      return false;
    }
    const double apart = (start(world_, it.a) - start(world_, it.b)).norm();
    it.length = apart;
    const Node* length = fields_.given("length");
    if (!length && apart == 0) {
      complaints_.add(fields_.place("between"),
                      fmt::format("the two points of this {} are one place", fields_.text("type")));
      return false;
    }
    if (!length) return true;
    const double slack = length->number() - apart, rounding = kRounding * (1 + size_);
    if (slack < -rounding || (kind_ == JointKind::rod && slack > rounding)) {
      complaints_.add(length->place,
                      fmt::format("'length' is {} m and its ends are {:.6g} m apart at the start",
                                  length->number(), apart));
      return false;
    }
    it.length = length->number();
    return true;
  }

  const Fields& fields_;
  JointKind kind_;
  const Side &a_, &b_;
  sim::World<2>& world_;
  Complaints& complaints_;
  double size_ = 0;
};

}  // namespace

void joints(const Node& top, const Roster& roster, sim::World<2>& world, Complaints& complaints) {
  const Node* all = top.find("joint");
  for (std::size_t k = 0; all && k < all->list().size(); ++k) {
    const Fields fields(all->list()[k], "joint");
    const Node* between = fields.given("between");
    if (!between || !fields.given("type")) continue;
    const JointKind kind = type(fields.text("type"));
    refuse_others(fields, kind, complaints);
    const Side a = side(between->list()[0], roster, world, complaints);
    const Side b = side(between->list()[1], roster, world, complaints);
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
    const std::string own = fields.given("name") ? fields.text("name") : fmt::format("joint[{}]", k);
    Joining joining(fields, kind, a, b, world, complaints);
    for (int i = 0; i < n; ++i) {
      auto it = joining.joint(n == 1 ? own : fmt::format("{}[{}]", own, i), i);
      if (!it) break;
      world.model.joints.push_back(std::move(*it));
      world.state.broken.push_back(0);
    }
  }
}

}  // namespace obscura::scene
