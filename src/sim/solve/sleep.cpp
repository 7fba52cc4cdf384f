// When islands sleep and wake. An island, bodies that contacts, springs and joints join, is set at rest when
//   1. it has been quiet for kWait:    |v|^2 + (w R)^2 <= still^2 of each body, R its bounding radius
//   2. it is in equilibrium:           |a| + |w'| R <= share g, under the forces of the solver, or of Statics
//   3. its motion is held:             Mobility leaves it no freedom
// and wakes when something awake comes nearer than it may move until it is looked at again,
//   gap < 1.001 span (|v| + |w| R) + g span (span + h) / 2
// where it falls by steps of h: contacts press by the velocity at the end of each.
// The rule and its limits are told in sim/constraint/mobility.h.

#include "sim/solve/sleep.h"

#include <algorithm>
#include <cmath>

#include "sim/collide/rails.h"
#include "sim/constraint/joints/joint.h"
#include "sim/constraint/material.h"
#include "sim/force/explosion.h"
#include "sim/force/force_coupling.h"
#include "sim/model/body_motion.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kChecks = 60;          // a second
constexpr double kExact = 1e-10;        // of g: what exact forces may leave
constexpr double kNear = 1e-3;          // of the thinner body: no wider a gap joins
constexpr std::size_t kMany = 500;      // contacts: forces of more take long, too
constexpr double kOverlaps = 2e-9;      // of a body's bounding radius: no rounding
constexpr double kClosed = 1e-6;        // of it: no wider a gap bears what rests
constexpr double kRounding = 1 + 1e-6;  // of a span of time

// contacts of an island whose forces are found exactly where the solver's own do not hold it
template <int D>
constexpr int kFewContacts = D == 2 ? 100 : 250;

// act(a, b) for each two bodies of a joint
template <int D, class Act>
void each_two(const Model<D>& model, const State<D>& state, std::size_t number, Act&& act) {
  const Joint<D>& joint = model.joints[number];
  act(joint.a.body, joint.b.body);
  if (joint.over.empty() && wound(state, number).with <= 0) return;
  each_body_held(model, state, number,
                 [&](int a) { each_body_held(model, state, number, [&](int b) { act(a, b); }); });
}

}  // namespace

template <int D>
Sleep<D>::Sleep(const Model<D>& model, Forces forces, double deepest)
    : model_(model),
      driven_(restless_by_forces(model, forces == Forces::exact)),
      restless_at_start_(restless_by_forces(model, false)),
      exact_(forces == Forces::exact),
      deepest_(deepest),
      g_(std::sqrt(model.gravity.squaredNorm())),
      statics_(model),
      mobility_(model),
      rotations_(model.bodies.size(), Rotation<D>::Identity()) {
  const Slow limits = slow(model);
  const double still = exact_ ? limits.none : limits.asked;
  still2_ = still * still;
  const double rate = value(model.rate);
  if (!exact_) every_ = std::max<std::int64_t>(1, std::llround(rate / kChecks));
  interval_ = double(every_) / rate;
  for (const Body<D>& body : model.bodies) {
    bounding_radius_.push_back(bounding_radius(body.shape));
    half_thickness_.push_back(half_thickness(body.shape));
    if (body.carries()) carriers_.push_back(int(&body - model.bodies.data()));
  }
}

// half thickness of the thinner of two bodies, m; points have none
template <int D>
double Sleep<D>::thickness(const ContactKey& key) const {
  const double a = half_thickness_[key.a], b = key.b < 0 ? a : half_thickness_[key.b];
  return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b);
}

// whether a contact makes an island of two bodies
template <int D>
bool Sleep<D>::joins(const Contact<D>& contact) const {
  return contact.touching != ContactMode::open || contact.gap < kNear * thickness(contact.key);
}

// islands of the bodies that are alike
template <int D>
template <class Alike>
void Sleep<D>::build_islands(const State<D>& state, std::span<const Contact<D>> contacts, Alike&& alike) {
  const int n = int(model_.bodies.size());
  roots_.reset(n), restless_.assign(n, 0);
  const auto both = [&](int a, int b) { return a >= 0 && b >= 0 && alike(a) && alike(b); };
  for (const Contact<D>& contact : contacts) {
    const int a = contact.key.a, b = contact.key.b;
    if (both(a, b) && joins(contact)) roots_.join(a, b);
  }
  for (const Spring<D>& spring : model_.springs) {
    if (both(spring.a.body, spring.b.body)) roots_.join(spring.a.body, spring.b.body);
  }
  for (const Articulation<D>& chain : model_.chains) {
    for (const int body : chain.bodies) {
      if (both(body, chain.bodies[0])) roots_.join(body, chain.bodies[0]);
    }
  }
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (state.broken[i]) continue;
    each_two(model_, state, i, [&](int a, int b) {
      if (both(a, b)) roots_.join(a, b);
    });
  }
}

// --- wake

// how far what is awake may come in span s, by steps of h, m
template <int D>
double Sleep<D>::reach(const State<D>& state, const Contact<D>& contact, int awake, double span,
                       double h) const {
  const Vec<D>& v = state.v[awake];
  AngularVec<D> w = AngularVec<D>::Zero();
  if (const int k = turning(state, awake); k >= 0) w = state.spin[k];
  // A body that was quiet since the last check does not fall, so only its velocity counts here. With a bound
  // by free fall two neighbours would wake each other in turns.
  if (state.quiet[awake] > interval_ && !joins(contact)) {
    const double along = contact.normal.dot(v + cross_velocity<D>(w, Vec<D>(contact.point - state.x[awake])));
    return kSooner * span * std::max(0.0, awake == contact.key.a ? -along : along);
  }
  return kSooner * span *
             (std::sqrt(v.squaredNorm()) + bounding_radius_[awake] * std::sqrt(w.squaredNorm())) +
         0.5 * span * (span + h) * g_;
}

template <int D>
bool Sleep<D>::wake(State<D>& state, std::span<const Contact<D>> near, double span, double h) {
  if (!any(state)) return false;
  woken_.clear();
  for (const Contact<D>& contact : near) {
    const int a = contact.key.a, b = contact.key.b;
    if (b < 0 || state.frozen[a] == state.frozen[b]) continue;
    const int awake = state.frozen[a] ? b : a;
    if (moves(state, awake) && contact.gap < reach(state, contact, awake, span, h))
      woken_.push_back(a + b - awake);
  }
  const auto pull = [&](int a, int b) {
    if (a < 0 || b < 0) return;
    if (state.frozen[a] && moves(state, b)) woken_.push_back(a);
    if (state.frozen[b] && moves(state, a)) woken_.push_back(b);
  };
  for (const Spring<D>& spring : model_.springs) pull(spring.a.body, spring.b.body);
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (!state.broken[i]) each_two(model_, state, i, pull);
  }
  for (const Grip<D>& grip : state.grips) {
    if (grip.body >= 0 && state.frozen[grip.body]) woken_.push_back(grip.body);
  }
  if (woken_.empty()) return false;
  wake(state, woken_);
  return true;
}

template <int D>
void Sleep<D>::wake(State<D>& state, std::span<const int> bodies) {
  build_islands(state, state.contacts, [&](int body) { return state.frozen[body] != 0; });
  for (const int body : bodies) disturb(body);
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (restless_[roots_.root(i)]) state.frozen[i] = 0, state.quiet[i] = 0;
  }
}

// --- sleep

template <int D>
void Sleep<D>::disturb(int body) {
  if (body >= 0) restless_[roots_.root(body)] = 1;
}

// bodies that hands hold, and springs that the forces found do not include
template <int D>
void Sleep<D>::disturb_pulled(const State<D>& state) {
  for (const Grip<D>& grip : state.grips) disturb(grip.body);
  for (const int body : driven_) disturb(body);
  for (const int body : near_carriers_) disturb(body);
  for (const int carrier : carriers_) {
    for (const Spring<D>& spring : model_.springs) {
      if (spring.a.body == carrier) disturb(spring.b.body);
      if (spring.b.body == carrier) disturb(spring.a.body);
    }
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      bool carries = false;
      each_body_held(model_, state, i, [&](int body) { carries = carries || body == carrier; });
      if (carries) each_body_held(model_, state, i, [&](int body) { disturb(body); });
    }
  }
  // what a motor moves as time goes on does not rest
  for (const Joint<D>& joint : model_.joints)
    if (joint.motor && joint.motor->aim) disturb(joint.a.body), disturb(joint.b.body);
  if (exact_) return;
  for (const Spring<D>& spring : model_.springs) disturb(spring.a.body), disturb(spring.b.body);
  for (const Joint<D>& joint : model_.joints)
    if (joint.coil) disturb(joint.a.body), disturb(joint.b.body);
}

// makes candidates of the islands in which nothing is restless
template <int D>
void Sleep<D>::list_candidates(const State<D>& state, std::span<const Contact<D>> contacts) {
  bodies_by_root_.clear(), contacts_by_root_.clear();
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (!moves(state, i)) continue;
    if (const int root = roots_.root(i); !restless_[root]) bodies_by_root_.emplace_back(root, i);
  }
  if (bodies_by_root_.empty()) return;
  for (int i = 0; i < int(contacts.size()); ++i) {
    const ContactKey& key = contacts[i].key;
    const int body = moves(state, key.a) ? key.a : key.b;
    if (!moves(state, body)) continue;
    if (const int root = roots_.root(body); !restless_[root]) contacts_by_root_.emplace_back(root, i);
  }
  std::sort(bodies_by_root_.begin(), bodies_by_root_.end());
  std::sort(contacts_by_root_.begin(), contacts_by_root_.end());
  bodies_.clear(), contacts_.clear();
  for (const auto& [root, body] : bodies_by_root_) bodies_.push_back(body);
  for (const auto& [root, contact] : contacts_by_root_) contacts_.push_back(contact);
  std::size_t touch = 0, last_touch = 0;
  for (std::size_t i = 0, last = 0; i < bodies_.size(); i = last, touch = last_touch) {
    const int root = bodies_by_root_[i].first;
    Island island;
    for (; last < bodies_.size() && bodies_by_root_[last].first == root; ++last) {
      const double quiet = state.quiet[bodies_[last]];
      island.quiet = last == i ? quiet : std::min(island.quiet, quiet);
    }
    while (last_touch < contacts_.size() && contacts_by_root_[last_touch].first == root) ++last_touch;
    island.bodies = std::span(bodies_).subspan(i, last - i);
    island.contacts = std::span(contacts_).subspan(touch, last_touch - touch);
    candidates_.push_back(island);
  }
}

template <int D>
bool Sleep<D>::at_start(State<D>& state, std::span<Contact<D>> contacts) {
  candidates_.clear(), rows_.clear();
  if (blasting(state)) return false;
  build_islands(state, contacts, [&](int body) { return moves(state, body); });
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    const int k = turning(state, i);
    if (!state.v[i].isZero(0) || (k >= 0 && !state.spin[k].isZero(0))) disturb(i);
  }
  disturb_pulled(state);
  for (const int body : restless_at_start_) disturb(body);
  // those that overlap are pushed apart first
  for (const Contact<D>& contact : contacts) {
    if (exact_ || !(contact.gap < -kOverlaps * bounding_radius_[contact.key.a])) continue;
    disturb(contact.key.a);
    if (contact.key.b >= 0) disturb(contact.key.b);
  }
  for (const Joint<D>& joint : model_.joints) joint.each_body([&](int body) { disturb(body); });
  list_candidates(state, contacts);
  bool fell = false;
  for (const Island& island : candidates_) {
    if (!in_equilibrium(state, island, contacts, Statics<D>::kMost)) continue;
    freeze(state, island), fell = true;
  }
  return fell;
}

template <int D>
std::span<typename Sleep<D>::Island> Sleep<D>::candidates(const State<D>& state) {
  candidates_.clear(), rows_.clear();
  const int n = int(model_.bodies.size());
  bool waited = false;
  for (int i = 0; i < n; ++i) waited = waited || (moves(state, i) && state.quiet[i] >= kWait);
  if (!waited || (!exact_ && blasting(state))) return candidates_;

  build_islands(state, state.contacts, [&](int body) { return moves(state, body); });
  for (int i = 0; i < n; ++i) {
    if (moves(state, i) && state.quiet[i] < kWait) disturb(i);
  }
  disturb_pulled(state);
  // of the larger of two, as the overlap that is not corrected
  for (const Contact<D>& contact : state.contacts) {
    const int a = contact.key.a, b = contact.key.b, body = moves(state, a) ? a : b;
    const double size = b < 0 ? bounding_radius_[a] : std::max(bounding_radius_[a], bounding_radius_[b]);
    if (body >= 0 && contact.gap < -deepest_ * size) disturb(body);
  }
  list_candidates(state, state.contacts);

  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (state.broken[i]) continue;
    model_.joints[i].each_body([&](int body) {
      if (!moves(state, body)) return;
      const auto at =
          std::lower_bound(candidates_.begin(), candidates_.end(), roots_.root(body),
                           [](const Island& island, int root) { return island.bodies[0] < root; });
      if (at != candidates_.end() && at->bodies[0] == roots_.root(body)) at->jointed = true;
    });
  }
  // The solver's attempts leave other forces behind, to which joints must settle again; and exact forces, or
  // those of many contacts, take long.
  std::erase_if(candidates_, [&](const Island& island) {
    return (exact_ || island.jointed || island.contacts.size() > kMany) && !due_at_waits(island.quiet);
  });
  return candidates_;
}

// after one wait, two, three, ...
template <int D>
bool Sleep<D>::due_at_waits(double quiet) const {
  return quiet - kRounding * interval_ < kWait * std::floor(quiet / kWait);
}

// after one wait, two, four, ...
template <int D>
bool Sleep<D>::due_at_doubled_waits(double quiet) const {
  double due = kWait;
  while (2 * due <= quiet) due *= 2;
  return quiet - kRounding * interval_ < due;
}

template <int D>
bool Sleep<D>::put_to_sleep(State<D>& state) {
  std::stable_sort(rows_.begin(), rows_.end(),
                   [](const JointRow& p, const JointRow& q) { return p.island < q.island; });
  const double allowed = (exact_ ? kExact : kBalanced) * g_;
  bool fell = false;
  for (const Island& island : candidates_) {
    bool balanced = island.residual <= allowed;
    if (!balanced && !exact_ && !island.jointed && due_at_doubled_waits(island.quiet))
      balanced = in_equilibrium(state, island, state.contacts, kFewContacts<D>);
    if (!balanced || mobile(state, island) != Mobile::no) continue;
    freeze(state, island), fell = true;
  }
  return fell;
}

template <int D>
BearingContact<D> Sleep<D>::bearing(const State<D>& state, const Contact<D>& contact) const {
  const int a = contact.key.a, b = contact.key.b;
  BearingContact<D> touch{.normal = contact.normal, .force = contact.force};
  touch.friction = material(model_, a, b).static_friction;
  if (const Rail<D>* rail = rail_of(model_, contact.key))
    touch.friction = mixed(Material(model_.bodies[rail->body == a ? b : a]), *rail).static_friction;
  if (moves(state, a)) touch.a = a, touch.arm_a = contact.point - state.x[a];
  if (moves(state, b)) touch.b = b, touch.arm_b = contact.point - state.x[b];
  return touch;
}

// whether exact forces hold an island of bodies that stand still; its contacts take them
template <int D>
bool Sleep<D>::in_equilibrium(const State<D>& state, const Island& island, std::span<Contact<D>> contacts,
                              int most) {
  touches_.clear(), bearing_.clear();
  for (const int i : island.contacts) {
    if (contacts[i].gap > kClosed * thickness(contacts[i].key)) continue;
    touches_.push_back(bearing(state, contacts[i])), bearing_.push_back(i);
    if (int(touches_.size()) > most) return false;
  }
  if constexpr (D == 3) {  // one moment of inertia of the plane is the same at all turns
    for (const int body : island.bodies) rotations_[body] = body_motion(state, body).room_from_body;
  }
  if (!statics_.in_equilibrium(touches_, rotations_)) return false;
  for (const int i : island.contacts)
    contacts[i].force.setZero(), contacts[i].impulse.setZero(), contacts[i].touching = ContactMode::open;
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    Contact<D>& contact = contacts[bearing_[k]];
    contact.force = touches_[k].force;
    if (contact.force.dot(contact.normal) > 0) contact.touching = ContactMode::stick;
  }
  return true;
}

// whether what bears an island leaves its motion any freedom
template <int D>
Mobile Sleep<D>::mobile(const State<D>& state, const Island& island) {
  mobility_.clear();
  for (const int body : island.bodies) {
    AngularVec<D> w = AngularVec<D>::Zero();
    if (const int k = turning(state, body); k >= 0) w = state.spin[k];
    if constexpr (D == 3) rotations_[body] = body_motion(state, body).room_from_body;
    mobility_.add(body, state.v[body], w, rotations_[body]);
  }
  for (const int i : island.contacts) mobility_.add_contact(bearing(state, state.contacts[i]));
  const int number = int(&island - candidates_.data());
  auto row = std::lower_bound(rows_.begin(), rows_.end(), number,
                              [](const JointRow& p, int which) { return p.island < which; });
  for (; row != rows_.end() && row->island == number; ++row) mobility_.add_row(row->row, row->spare);
  return mobility_.mobile();
}

template <int D>
void Sleep<D>::halt(State<D>& state, const Island& island) const {
  for (const int body : island.bodies) {
    state.v[body].setZero();
    if (const int k = turning(state, body); k >= 0) state.spin[k].setZero();
  }
  for (std::size_t i = 0; i < model_.chains.size(); ++i) {
    if (std::binary_search(island.bodies.begin(), island.bodies.end(), model_.chains[i].bodies[0]))
      std::fill(state.chain_states[i].v.begin(), state.chain_states[i].v.end(), 0.0);
  }
}

template <int D>
void Sleep<D>::freeze(State<D>& state, const Island& island) const {
  halt(state, island);
  for (const int body : island.bodies) state.frozen[body] = 1;
}

template class Sleep<2>;
template class Sleep<3>;

}  // namespace obscura::sim
