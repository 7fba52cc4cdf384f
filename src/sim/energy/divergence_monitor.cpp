// Energy without a source. Kinetic energy, springs, and gravity's potential above its start stay below the
// budget
//   budget = their start, with that of fields, + work of displacing and of pushing out of walls
//          + sum over bodies of m g L + m u^2 + sum over joints' springs of k / 2, a radian of each
//          + sum over springs of k (L/10)^2 / 2 + sum over hands of k (4 L + way)^2 / 2
//     L  room's height, u  speed of the fastest hand, but L/10 a second at least
// unless the integration adds energy. A hundred times the budget is proof; four times, if the step is longer
// than the integrator's limit.

#include "sim/energy/divergence_monitor.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "sim/constraint/joints/joint.h"
#include "sim/energy/energy.h"
#include "sim/math/lie_step.h"
#include "sim/math/limits.h"
#include "sim/motion/stability.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kProof = 100, kSuspect = 4;
constexpr double kOpen = 0.01;       // of a joint's size, or rad
constexpr double kLong = 0.1;        // the same of a rope, which joints beside it may hardly let be put back
constexpr double kSqueezed = 0.1;    // of a body's width
constexpr double kOpposite = -0.5;   // of two normals: they press against each other
constexpr double kOpenPoint = 1e-3;  // of the scene's size, for joints of points without a length

template <int D>
bool apart(const Eigen::Matrix<double, D, 1>& numbers, double limit) {
  return within(numbers.data(), D, limit) < 0;
}

template <int D>
std::string fate(const Eigen::Matrix<double, D, 1>& numbers, const char* limit, double t) {
  for (int i = 0; i < D; ++i) {
    if (std::isnan(numbers[i])) return "is not a number";
  }
  for (int i = 0; i < D; ++i) {
    if (std::isinf(numbers[i])) return "is infinite";
  }
  return std::string(t == 0 ? "is beyond " : "grew past ").append(limit);
}

}  // namespace

template <int D>
DivergenceMonitor<D>::DivergenceMonitor(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), paths_(paths), too_long_(stability_warnings(model)) {
  for (std::size_t i = 0; D == 3 && i < model.joints.size(); ++i)
    if (model.joints[i].coil && model.joints[i].kind == JointKind::hinge) coils_.push_back(int(i));
  drives_ =
      std::any_of(model.bodies.begin(), model.bodies.end(), [](const Body<D>& body) { return body.driven; });
}

template <int D>
std::optional<Trouble> DivergenceMonitor<D>::check_bounds(const State<D>& state, double t) const {
  const double limit = kFarthest * model_.scale;
  for (int body = 0; body < int(model_.bodies.size()); ++body) {
    const auto trouble = [&](const char* quantity, std::string what) {
      return Trouble{t, named(model_, body), quantity, std::move(what), likely(state, body)};
    };
    if (apart<D>(state.x[body], limit))
      return trouble("position", fate<D>(state.x[body], "1e6 room heights", t));
    if (apart<D>(state.v[body], limit))
      return trouble("velocity", fate<D>(state.v[body], "1e6 room heights a second", t));
    const int k = turning(state, body);
    if (k < 0) continue;
    const double fastest = limit / bounding_radius(model_.bodies[body].shape);
    constexpr int kSpin = kAngular<D>;
    if (apart<kSpin>(state.spin[k], fastest)) {
      return trouble("spin", fate<kSpin>(state.spin[k], "1e6 room heights a second at a corner", t));
    }
    if (const double most = kFarthestTurn * value(model_.rate);
        wobbles<D>(model_.bodies[body].inertia) && apart<kSpin>(state.spin[k], most)) {
      return Trouble{t, named(model_, body), "spin", "grew past 100 radians a step",
                     "it turns too fast for the steps: raise physics.rate"};
    }
    constexpr int kTurn = Orientation<D>::RowsAtCompileTime;
    if (apart<kTurn>(state.turn[k], kFarthest * kFarthest)) {
      return trouble(D == 2 ? "angle" : "orientation", fate<kTurn>(state.turn[k], "1e12 radians", t));
    }
  }
  return {};
}

template <int D>
void DivergenceMonitor<D>::start(State<D>& state, double t) const {
  const Energies e = energies(model_, state, paths_, t);
  double energy_budget = e.kinetic + e.springs + e.hand + std::fabs(e.fields);
  const double little = 0.1 * model_.scale;
  double fastest = little;
  for (const Mouse<D>& mouse : model_.mice) {
    double way = 4 * model_.scale;
    for (std::size_t i = 1; i < mouse.path.size(); ++i) {
      const Knot<D>&from = mouse.path[i - 1], &to = mouse.path[i];
      const double piece = std::sqrt((to.place - from.place).squaredNorm());
      way += piece;
      fastest = std::max(fastest, piece / (value(to.time) - value(from.time)));
    }
    energy_budget += 0.5 * mouse.stiffness * way * way;
  }
  for (const Spring<D>& spring : model_.springs) energy_budget += 0.5 * spring.stiffness * little * little;
  // a radian of a hinge
  for (const Joint<D>& joint : model_.joints)
    if (joint.coil) energy_budget += 0.5 * joint.coil->stiffness * std::max(1.0, little * little);
  const double g = std::sqrt(model_.gravity.squaredNorm());
  for (const Body<D>& body : model_.bodies) {
    if (!body.fixed) energy_budget += body.mass * (g * model_.scale + fastest * fastest);
  }
  state.energy_budget = {e.gravity + e.fields + state.ledger.displacement, energy_budget, e.work};
}

template <int D>
std::optional<Trouble> DivergenceMonitor<D>::check_energy(const State<D>& state, double t) const {
  const Energies e = energies(model_, state, paths_, t);
  // where the step is too long, the work of pushing bodies out of walls is not to be trusted
  const double pushed = too_long_.empty() ? std::max(0.0, state.ledger.displacement) : 0;
  const double energy_budget = state.energy_budget.amount + pushed;
  const double held = e.kinetic + e.springs + e.hand + e.gravity + e.fields - state.energy_budget.level;
  // what drag takes, hands and motors give again and again
  const double now = held - std::max(0.0, e.work - state.energy_budget.work);
  if (std::max(now, held) <= kSuspect * energy_budget) return {};
  // nor is then that of forces
  const Tightness worst = tightest(model_, state.grips);
  if (now <= kProof * energy_budget && worst.body < 0 && too_long_.empty()) return {};

  // the body to blame: the one with the most kinetic energy
  int body = 0;
  double most = -1;
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (model_.bodies[i].fixed) continue;
    const double moving = kinetic(model_, state, i);
    if (moving > most) most = moving, body = i;
  }
  return Trouble{t, named(model_, body), "energy", "grew far beyond what was put in", likely(state, body)};
}

template <int D>
std::optional<Trouble> DivergenceMonitor<D>::check_joints(const State<D>& state, double t) const {
  if (model_.joints.empty()) return {};
  at_.resize(model_.bodies.size());
  for (std::size_t body = 0; body < at_.size(); ++body) at_[body] = body_motion(state, int(body));
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (joint.linked || (i < state.broken.size() && state.broken[i])) continue;
    Row<D> J[kMostHeld<D>];
    double off[kMostHeld<D>];
    if (one_with_another(state, i)) continue;
    const int n = rows<D>(joint, i, state, at_, J, off);
    double size = length_held(joint, wound(state, i));
    joint.each_body([&](int body) {
      if (body >= 0) size = std::max(size, bounding_radius(model_.bodies[std::size_t(body)].shape));
    });
    for (const End<D>& end : {joint.a, joint.b}) {
      if (end.body >= 0) size = std::max(size, std::sqrt(end.local.squaredNorm()));
    }
    const double share = one_sided(joint) ? kLong : kOpen,
                 open = size > 0 ? share * size : kOpenPoint * model_.scale;
    for (int r = 0; r < n; ++r) {
      const bool turns = J[r].along.isZero(0);
      const double gap = one_sided(joint) ? std::max(0.0, -off[r]) : std::fabs(off[r]);
      if (!(gap > (turns ? kOpen : open))) continue;
      char what[64];
      std::snprintf(what, sizeof what, "opened to %.2g %s", gap, turns ? "rad" : "m");
      return Trouble{
          t, joint.name, "gap", what,
          "its bodies move too far in a step, or its loop cannot close: raise physics.rate, or write "
          "physics.solver = \"direct\" where it is not"};
    }
  }
  return {};
}

template <int D>
std::optional<Trouble> DivergenceMonitor<D>::check_squeezed(const State<D>& state, double t) const {
  if (!drives_) return {};
  struct Side {
    int body, by;  // by: below zero what does not move
    Vec<D> normal;
    double depth;
  };
  const auto stays = [&](int body) { return body < 0 || model_.bodies[std::size_t(body)].fixed; };
  const auto side_of = [&](const Contact<D>& contact) -> std::optional<Side> {
    const auto [a, b, feature] = contact.key;
    if (!(contact.gap < 0) || stays(a) == stays(b)) return {};
    if (stays(b)) return Side{a, b, contact.normal, -contact.gap};
    return Side{b, a, -contact.normal, -contact.gap};
  };
  const auto moved = [&](const Side& side) {
    return side.by >= 0 && model_.bodies[std::size_t(side.by)].driven;
  };
  const auto name = [&](int body) { return body < 0 ? std::string("the walls") : named(model_, body); };
  for (const Contact<D>& contact : state.contacts) {
    const auto deep = side_of(contact);
    if (!deep) continue;
    // of both sides the deeper is half of it at least
    const double width = 2 * half_thickness(model_.bodies[std::size_t(deep->body)].shape);
    if (!(width > 0) || !(deep->depth > 0.5 * kSqueezed * width)) continue;
    for (const Contact<D>& beside : state.contacts) {
      const auto other = side_of(beside);
      if (!other || other->body != deep->body || other->by == deep->by) continue;
      if (!(moved(*deep) || moved(*other)) || !(other->normal.dot(deep->normal) < kOpposite)) continue;
      if (!(deep->depth + other->depth > kSqueezed * width)) continue;
      return Trouble{t, named(model_, deep->body), "place",
                     "has no room left between " + name(other->by) + " and " + name(deep->by),
                     "nothing stops either of them: let what is moved end before"};
    }
  }
  return {};
}

template <int D>
void DivergenceMonitor<D>::spring_angles(const State<D>& state, std::vector<double>& angles) const {
  angles.clear();
  const auto motion = [&](int body) { return body < 0 ? BodyMotion<D>{} : body_motion(state, body); };
  for (const int i : coils_) {
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    Row<D> row;
    double angle = 0;
    if (std::size_t(i) >= state.broken.size() || !state.broken[std::size_t(i)])
      free_row(joint, motion(joint.a.body), motion(joint.b.body), AngularVec<D>::Zero(), row, angle);
    angles.push_back(angle);
  }
}

template <int D>
std::optional<Trouble> DivergenceMonitor<D>::check_turns(const std::vector<double>& before,
                                                         const State<D>& state, double t) const {
  if (coils_.empty()) return {};
  std::vector<double> now;
  spring_angles(state, now);
  for (std::size_t k = 0; k < coils_.size(); ++k) {
    if (std::fabs(now[k] - before[k]) > std::numbers::pi)
      return Trouble{t, model_.joints[std::size_t(coils_[k])].name, "angle", "has come to half a turn",
                     "the spring of a hinge in space counts no whole turns: make it stiffer, give the hinge "
                     "limits, or build it in the plane, where pins count them"};
  }
  return {};
}

template <int D>
std::string DivergenceMonitor<D>::likely(const State<D>& state, int body) const {
  // a spring of its own first: another may be too stiff as well
  const double h = 1 / value(model_.rate);
  const Tightness its = tightness(model_, state.grips)[std::size_t(body)];
  if (grows(model_.integrator, its, h)) return step_too_long_message(model_, its);
  if (const Tightness joint = tightest_of_joints(model_, body); joint.body >= 0)
    return step_too_long_message(model_, joint);
  if (const Tightness worst = tightest(model_, state.grips); worst.body >= 0)
    return step_too_long_message(model_, worst);
  if (!too_long_.empty()) return too_long_.front().likely;
  bool tied = false;
  for (const Spring<D>& s : model_.springs) tied = tied || s.a.body == body || s.b.body == body;
  for (const Grip<D>& grip : state.grips) tied = tied || grip.body == body;
  if (tied) {
    const bool feeds = model_.integrator == Integrator::euler || model_.integrator == Integrator::midpoint;
    return std::string(feeds ? spelled(model_.integrator) : "the step") +
           " feeds its springs: raise physics.rate" + (feeds ? ", or take rk4 or semi-implicit" : "");
  }
  for (const Joint<D>& joint : model_.joints) {
    if (joint.any_body([&](int held) { return held == body; }))
      return "its joints pull it harder than the steps can follow: raise physics.rate";
  }
  for (const Force<D>& force : model_.forces) {
    for (const Subject<D>& subject : force.subjects) {
      if (subject.body == body)
        return force.name + " drives it: raise physics.rate if it should not, or give it drag or walls";
    }
  }
  if (model_.walls.empty()) return "nothing stops it: the room has no walls";
  return "nothing stops it: no wall lies on its way, or it started too fast";
}

template class DivergenceMonitor<2>;
template class DivergenceMonitor<3>;

}  // namespace obscura::sim
