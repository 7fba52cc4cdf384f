// What the iterative solver does in space (its stages: sim/solve/iterate/iterative.h). All that may touch
// within a substep is found anew in each, features of few pairs. Of each contact iterations solve, over and
// over,
//   v_n' >= -g / h,  of what closes fast  v_n' >= -e v_n         p_n >= 0
//   p_t <- p_t - v_t / k_t, cut back to |p_t| <= mu p_n          k_t  the most a push across answers
// (sim/solve/iterate/space_batches.cpp). Impacts of few are solved before, each at its time
// (sim/solve/iterate/space_impacts.cpp).

#include "sim/solve/iterate/space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/math/exponential.h"
#include "sim/solve/iterate/pieces.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::sim {

namespace {

constexpr double kDeepest = 2e-3;        // of a body's bounding radius: deeper nothing rests
constexpr int kMostIterations = 40;      // of few touches
constexpr int kFewestIterations = 4;     // of many
constexpr int kTouchIterations = 20000;  // touches times iterations between
constexpr int kTempering = 5;            // rounds
constexpr double kAtOnce = 1e-3;         // of a step: what meets so soon after another meets with it
constexpr double kRoundingGain = 1e-9;   // of its kinetic energy: what an island may win by rounding
constexpr double kNotNear = -1e300;      // 1/s: among closing rates, a touch that is not near

}  // namespace

SpaceIterative::SpaceIterative(const Model<D>& model, const std::vector<Path<D>>& paths)
    : Iterative(model, paths, kDeepest), may_touch_(model), response_(model), energy_guard_(model) {
  for (const Body<D>& body : model.bodies) {
    width_.push_back(std::max(2 * half_thickness(body.shape), kPointWidth * model.scale));
    round_.push_back(bool(round_radius(body.shape)));
    points_.push_back(is_point(body.shape));
  }
  farther_.resize(carries_.size());
}

bool SpaceIterative::find_contacts(StepPart<D> step) {
  impulses_.clear();
  prepare(step.state, step.t, step.h);
  found_for_ = 0;
  find(step);
  return true;
}

void SpaceIterative::update_sleep(StepPart<D> step) {
  State<D>& state = step.state;
  bool changed = wake_near_driven(step, step.h);
  if (state.step == 0 || sleep_.any(state)) {
    near_.clear();
    for (const ContactConstraint& touch : touches_) near_.push_back(contact(touch, step.h));
    changed = sleep_.wake(state, near_, step.h, step.h) || changed;
    if (!changed && state.step == 0 && sleep_.at_start(state, near_)) {
      state.contacts = near_, changed = true;
      // what begins at rest may be struck in the first step
      sleep_.wake(state, near_, step.h, step.h);
    }
  }
  if (changed) prepare(state, step.t, step.h), find(step);
  while (wake_struck(state, step.h)) prepare(state, step.t, step.h), find(step);
}

// Wakes what sleeps where a body may come that is struck within the step, and would be a wall to it. True if
// any woke.
bool SpaceIterative::wake_struck(State<D>& state, double h) {
  if (!Sleep<D>::any(state)) return false;
  const int n = int(model_.bodies.size());
  const auto fixed = [&](int body) { return body == n || model_.bodies[std::size_t(body)].fixed; };
  const auto sleeps = [&](int body) { return state.frozen[std::size_t(body)] != 0; };
  struck_speeds_.clear(n);
  for (int i = 0; i < n; ++i)
    // what is quiet gets no faster by itself
    if (!fixed(i) && !sleeps(i) && !(state.quiet[std::size_t(i)] > 0)) struck_speeds_.begin(i, swiftness(i));
  struck_bodies_.clear(), reached_.clear();
  const auto strike = [&](int a, int b) {
    const int struck = struck_speeds_.struck(a, b);
    if (struck < 0) return false;
    struck_speeds_.strike(a + b - struck, struck);
    struck_bodies_.push_back(struck);
    if (sleeps(struck)) reached_.push_back(struck);
    return true;
  };
  for (bool more = true; more;) {
    more = false;
    for (const ContactConstraint& touch : touches_)
      if (!fixed(touch.a) && !fixed(touch.b) &&
          touch.gap < Sleep<D>::kSooner * h * (struck_speeds_.speed(touch.a) + struck_speeds_.speed(touch.b)))
        more = strike(touch.a, touch.b) || more;
  }
  // what sleeps is no touch yet of what is still slow
  for (std::size_t k = 0; k < struck_bodies_.size(); ++k) {
    const int i = struck_bodies_[k];
    for (int j = 0; j < n; ++j) {
      if (!sleeps(j) || fixed(j) || struck_speeds_.speed(j) > 0) continue;
      const double near = bounding_radius_[std::size_t(i)] + bounding_radius_[std::size_t(j)] +
                          Sleep<D>::kSooner * h * struck_speeds_.speed(i);
      if ((stances_[std::size_t(i)].x - stances_[std::size_t(j)].x).squaredNorm() < near * near) strike(i, j);
    }
  }
  if (reached_.empty()) return false;
  sleep_.wake(state, reached_);
  return true;
}

// How fast those close that touch, or may within h s, in widths of the narrower body, 1/s. A spin along the
// normal brings no corner nearer to the plane between two; `spins_along`: it counts as if it did.
SpaceIterative::ClosingRates SpaceIterative::rates_of_touches(double h, bool spins_along) const {
  const int n = int(model_.bodies.size());
  const auto closes_by = [&](const ContactConstraint& touch) {
    const Vec<D> u = slip(touch);
    double closes = -touch.n.dot(u);
    if (!(round_[touch.a] && (touch.b == n || round_[touch.b]))) {
      double passes = std::sqrt(u.squaredNorm());
      for (const int body : {touch.a, touch.b}) {
        if (body == n) continue;
        const AngularVec<D>& w = moving_[body].w;
        const double along = spins_along ? 0 : touch.n.dot(w);
        passes += bounding_radius_[body] * std::sqrt(std::max(0.0, w.squaredNorm() - along * along));
      }
      closes = std::max(closes, kPassing * passes);
    }
    // what is moved, as fast as it becomes within the step
    if (!quicker_.empty()) closes += quicker_[touch.a] + (touch.b < n ? quicker_[touch.b] : 0);
    return (touch.gap - h * closes) * touch.per_width < kNearly ? closes * touch.per_width : kNotNear;
  };
  closes_.resize(touches_.size());
  each(workers(), int(touches_.size()), kTouchPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) closes_[i] = closes_by(touches_[i]);
  });
  std::size_t near = 0;
  double most = 0;
  rates_.clear();
  for (const double rate : closes_) {
    if (rate == kNotNear) continue;
    ++near;
    if (rate > 0) rates_.push_back(rate), most = std::max(most, rate);
  }
  return {ruling_rate(rates_, near), most};
}

// impulses of a substep that is not the last
void SpaceIterative::keep_impulses(const State<D>& state) {
  for (const Contact<D>& contact : state.contacts) {
    if (contact.impulse.isZero(0)) continue;
    impulses_.push_back(contact);
    impulses_.back().force.setZero();
  }
}

// those of a step, to its contacts
void SpaceIterative::add_impulses(State<D>& state) const {
  for (const Contact<D>& struck : impulses_) {
    const auto at = std::lower_bound(state.contacts.begin(), state.contacts.end(), struck,
                                     [](const auto& p, const auto& q) { return p.key < q.key; });
    if (at == state.contacts.end() || at->key != struck.key) {
      state.contacts.insert(at, struck);
      continue;
    }
    at->impulse += struck.impulse;
    if (at->touching == ContactMode::open) at->touching = struck.touching;
  }
}

// the impacts decide which contacts the forces of the last step push
void SpaceIterative::start_contacts(StepPart<D> part) {
  if (part.substep == 0) warm_start_.begin(moving_);
  warm_start_contacts(part.state, part.h);
  if (part.substep == 0) moderate_warm_start();
  batches_.build(touches_, all_, moving_);
  // what hangs together is struck together
  components_.assign(joints_.components(), 0);
  for (const int i : joints_.bodies()) {
    if (closing_[i] && joints_.component(i) >= 0) components_[joints_.component(i)] = 1;
  }
  for (const int i : joints_.bodies()) {
    if (joints_.component(i) >= 0 && components_[joints_.component(i)]) closing_[i] = 1;
    if (joints_.stopped()) closing_[i] = 0;
  }
}

int SpaceIterative::iterations(StepPart<D> part) const {
  if (touches_.empty() && !joints_.empty() && joints_.plain()) return 1;
  if (starts(part)) return kFirstIterations;
  return std::clamp(kTouchIterations / std::max(1, int(touches_.size())), kFewestIterations, kMostIterations);
}

void SpaceIterative::end_round(StepPart<D> part) {
  shed_gains();
  place(part.state, part.h);
}

void SpaceIterative::finish_substep(StepPart<D> part) {
  report_contacts(part.state, part.h);
  if (part.substep + 1 < substeps_) keep_impulses(part.state);
}

void SpaceIterative::list_touching(StepPart<D> part, std::vector<std::pair<int, int>>& pairs) const {
  for (const Contact<D>& it : part.state.contacts)
    if (it.touching != ContactMode::open) pairs.emplace_back(it.key.a, it.key.b);
}

void SpaceIterative::report(StepPart<D> step) { add_impulses(step.state); }

// poses, velocities and inverse inertias
void SpaceIterative::prepare(const State<D>& state, double t, double h) {
  const int n = int(model_.bodies.size());
  stances_.resize(n), moving_.assign(n + 1, {}), inactive_.resize(n), turned_.resize(n);
  each(workers(), n, kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const Body<D>& body = model_.bodies[i];
      const Rotation<D> before = stances_[i].room_from_body;
      stances_[i] = body_motion(state, i);
      // no matter has moved farther than this, of its distance from the centre
      turned_[i] += std::sqrt(0.5 * (stances_[i].room_from_body - before).squaredNorm());
      inactive_[i] = body.fixed || state.frozen[i];
      response_.set(i, !inactive_[i]);
      if (!inactive_[i]) moving_[i] = PointBody<D>(body, stances_[i]);
    }
  });
  std::fill(farther_.begin(), farther_.end(), 0);
  for (int i = 0; i < drives_.size(); ++i) {
    const int body = drives_.body(i);
    if (jumps(h)) {
      const BodyMotion<D> then = drives_.at(i, t + h).at;
      stances_[body].v = then.v, stances_[body].w = then.w;
    }
    // no zeros below zero (sim/solve/iterate/space_batches.cpp)
    moving_[body].v = stances_[body].v + Vec<D>::Zero(),
    moving_[body].w = stances_[body].w + AngularVec<D>::Zero();
    farther_[body] = farther(i, t, h);
    if (!too_fast()) continue;
    // at most twice as fast as the matter that strikes it, and then against what lies beside it
    const double passes = swiftness(body) + farther_[body] / h;
    for (int other = 0; other < n; ++other) {
      const double near = bounding_radius_[body] + bounding_radius_[other] + h * passes;
      if (inactive_[other] || (stances_[other].x - stances_[body].x).squaredNorm() > near * near) continue;
      farther_[other] = std::max(farther_[other], 2 * h * passes);
    }
  }
}

void SpaceIterative::renew_contacts(StepPart<D> part) {
  if (substeps_ > 1) prepare(part.state, part.t, part.h), find(part);
  x_ = part.state.x, turn_ = part.state.turn;
}

Orientation<3> SpaceIterative::begun_turn(int body) const {
  const int k = body - int(stances_.size() - turn_.size());
  return k < 0 ? no_rotation<D>() : turn_[std::size_t(k)];
}

// Of the blows of a step that are left to the iterations, a body meets the first; what it met after that it
// may miss, or meet with another speed.
void SpaceIterative::order_blows(double h) {
  later_blows_.clear(), given_by_blows_ = 0;
  const int count = int(touches_.size()), none = int(model_.bodies.size());
  if (std::none_of(touches_.begin(), touches_.end(), [](const auto& touch) { return touch.blow; })) return;
  first_blows_.assign(std::size_t(none) + 1, {});
  const auto each_pair = [&](auto&& act) {
    for (int first = 0, end = 0; first < count; first = end) {
      double when = 1e300;
      for (; end < count && touches_[end].a == touches_[first].a && touches_[end].b == touches_[first].b;
           ++end)
        if (touches_[end].blow) when = std::min(when, touches_[end].closes);
      if (when < 1e300) act(first, end, when);
    }
  };
  each_pair([&](int first, int, double when) {
    for (const int body : {touches_[first].a, touches_[first].b}) {
      FirstBlow& its = first_blows_[body];
      if (moving_[body].inverse_mass == 0) continue;
      if (when < its.when)
        its.other = its.when, its.when = when, its.pair = first;
      else
        its.other = std::min(its.other, when);
    }
  });
  each_pair([&](int first, int end, double when) {
    const double after = std::min(first_blows_[touches_[first].a].of_others(first),
                                  first_blows_[touches_[first].b].of_others(first));
    if (!(after + kAtOnce * h < when)) return;
    for (int i = first; i < end; ++i) {
      ContactConstraint& touch = touches_[i];
      if (!touch.blow) continue;
      later_blows_.push_back({i, after});
      touch.least = kNoAim, touch.bounces = touch.closing = false;
    }
  });
}

// those of the later blows that are met all the same: true if there are any
bool SpaceIterative::strike_later(double h) {
  const std::size_t waited = later_blows_.size();
  std::erase_if(later_blows_, [&](const LaterBlow& later) {
    ContactConstraint& touch = touches_[later.touch];
    const double speed = touch.n.dot(slip(touch));
    const double gap = touch.closes > 0 ? touch.gap * (1 - later.after / touch.closes) : touch.gap;
    if (gap + (h - later.after) * speed >= 0) return false;
    if (speed < -restitution_threshold_) {
      touch.least = -touch.bounce * speed;
      touch.bounces = touch.bounce > 0, touch.closing = touch.bounce == 0;
    } else {
      touch.least = std::min(-touch.gap / h, 0.0);
    }
    if (touch.closing) closing_[touch.a] = closing_[touch.b] = 1;
    return true;
  });
  if (later_blows_.size() == waited) return false;
  // what has been given before stays given
  for (ContactConstraint& touch : touches_) {
    if (!touch.blow || !touch.bounces || !(touch.normal_impulse > 0)) continue;
    const Vec<D> impulse = touch.normal_impulse * touch.n + touch.tangent_impulse;
    touch.impact_impulse += impulse, given_by_blows_ += given_at(touch, impulse);
    touch.normal_impulse = 0, touch.tangent_impulse.setZero();
    touch.least = std::min(-touch.gap / h, 0.0), touch.bounces = false;
  }
  return true;
}

// Several impacts in one instant, with friction or on joints, may leave more energy than was there if each
// keeps its restitution (Kane and Levinson 1985); those of such an island keep less. Energy is that of the
// step's end: a body struck within it had not yet fallen all of its way. With
//   dK = p . v' - p W p / 2
// a share dK / p . v' less is enough where p stays; what stays of it is looked at again. True where there was
// any.
bool SpaceIterative::gains(const State<D>& state) {
  if (std::none_of(touches_.begin(), touches_.end(), [](const ContactConstraint& touch) {
        return touch.bounces && touch.least > 0 && touch.normal_impulse > 0;
      }))
    return false;
  energy_guard_.risen(state);
  const int n = int(model_.bodies.size());
  islands_.reset(n);
  const auto link = [&](int a, int b) {
    if (a >= 0 && a < n && b >= 0 && b < n && moving_[a].inverse_mass > 0 && moving_[b].inverse_mass > 0)
      islands_.join(a, b);
  };
  for (const ContactConstraint& touch : touches_) {
    if (touch.normal_impulse > 0) link(touch.a, touch.b);
  }
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (state.broken[i]) continue;
    // in space no rope leaves a wheel
    const Joint<D>& joint = model_.joints[i];
    joint.each_body([&](int a) { joint.each_body([&](int b) { link(a, b); }); });
  }
  before_.assign(n, 0), gained_.assign(n, 0), returned_.assign(n, 0);
  for (int i = 0; i < n; ++i) {
    const PointBody<D>& m = moving_[i];
    if (m.inverse_mass == 0) continue;
    double moves = v_free_[i].squaredNorm();
    if (const int k = turning(state, i); k >= 0)
      moves += bounding_radius_[i] * bounding_radius_[i] * w_free_[k].squaredNorm();
    before_[islands_.root(i)] += 0.5 * moves / m.inverse_mass,
        gained_[islands_.root(i)] += energy_guard_.gain(i);
  }
  const auto island = [&](const ContactConstraint& touch) {
    return islands_.root(moving_[touch.a].inverse_mass > 0 ? touch.a : touch.b);
  };
  for (const ContactConstraint& touch : touches_) {
    if (touch.bounces && touch.least > 0 && touch.normal_impulse > 0)
      returned_[island(touch)] += touch.normal_impulse * touch.least;
  }
  bool any = false;
  // what is moved may give energy
  for (const ContactConstraint& touch : touches_) {
    if (touch.normal_impulse > 0 && (carries(touch.a) || carries(touch.b))) gained_[island(touch)] = 0;
  }
  for (ContactConstraint& touch : touches_) {
    if (!(touch.bounces && touch.least > 0 && touch.normal_impulse > 0)) continue;
    const int of = island(touch);
    if (gained_[of] <= kRoundingGain * before_[of]) continue;
    touch.least *= std::max(0.0, 1 - 1.5 * gained_[of] / returned_[of]), any = true;
  }
  return any;
}

bool SpaceIterative::temper(StepPart<D> part, int round) {
  if (round + 1 == kTempering || !(gains(part.state) || strike_later(part.h))) return false;
  batches_.load(touches_);
  return true;
}

// When each body meets an impact that the iterations change its motion at, s from the start of the step: the
// first that is left to them, or its last, if joints answered it. h: none.
void SpaceIterative::find_strikes(double h) {
  const int n = int(model_.bodies.size());
  strikes_.assign(n + 1, h);
  for (const ContactConstraint& touch : touches_) {
    const bool struck = touch.bounces && touch.normal_impulse > 0;
    if (!struck && !(touch.blow && !touch.impact_impulse.isZero(0))) continue;
    for (const int side : {touch.a, touch.b})
      each_tied(side, [&](int body) { strikes_[body] = std::min(strikes_[body], touch.closes); });
  }
  for (const int body : joints_.bodies()) {
    if (when_[body] >= 0 && strikes_[body] == h) strikes_[body] = when_[body];
  }
}

// positions at the end of the step, from those without contacts
void SpaceIterative::place(State<D>& state, double h) {
  const int n = int(model_.bodies.size());
  find_strikes(h);
  const auto place_one = [&](int i) {
    if (inactive_[i]) return;
    const PointBody<D>& m = moving_[i];
    const bool closing = closing_[i] && when_[i] < 0;
    // how long it moves with what the iterations changed: all of the step in the mean, or since an impact
    const double with = strikes_[i] < h ? h - strikes_[i] : 0.5 * (h - std::max(0.0, when_[i]));
    if (closing) {
      state.x[i] = x_[i] + h * m.v;
    } else {
      state.x[i] = x_free_[i] + with * (m.v - v_free_[i]);
    }
    state.v[i] = m.v;
    const int k = turning(state, i);
    if (k < 0) return;
    state.turn[k] = turn_free_[k], state.spin[k] = w_free_[k];
    const AngularVec<D> change = m.w - w_free_[k];
    if (change.isZero(0)) return;
    // pushes were reckoned with the body as it stood when the step began; it turns on, and its angular
    // momentum stays
    const AngularVec<D>& inertia = model_.bodies[i].inertia;
    const Rotation<D> fallen = rotation<D>(turn_free_[k]);
    state.turn[k] = closing ? turned<D>(turn_[k], AngularVec<D>(h * m.w))
                            : turned<D>(turn_free_[k], AngularVec<D>(with * change));
    const Rotation<D> now = rotation<D>(state.turn[k]);
    state.spin[k] = carried_spin<D>(inertia, fallen, now, w_free_[k]) +
                    carried_spin<D>(inertia, stances_[i].room_from_body, now, change);
  };
  each(workers(), n, kBodyPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) place_one(i);
  });
}

// place() has, but for what their spins become by turning on
void SpaceIterative::place_bodies(StepPart<D> part) {
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (inactive_[i]) continue;
    if (const int k = turning(part.state, i); k >= 0) moving_[i].w = part.state.spin[k];
  }
}

// the forces of this substep; what sleeps keeps its own
void SpaceIterative::report_contacts(State<D>& state, double h) {
  if (newness() < 1) before_piece_ = state.contacts;
  write_contacts(state, h);
  if (newness() == 1) return;
  auto known = before_piece_.begin();
  for (Contact<D>& contact : state.contacts) {
    while (known != before_piece_.end() && known->key < contact.key) ++known;
    const bool was = known != before_piece_.end() && known->key == contact.key;
    const Vec<D> before = was ? known->force : Vec<D>(Vec<D>::Zero());
    if (!moves(contact.key.a) && !(contact.key.b >= 0 && moves(contact.key.b))) continue;
    contact.force = before + newness() * (contact.force - before);
    if (was && contact.touching == ContactMode::open) contact.touching = known->touching;
  }
}

void SpaceIterative::write_contacts(State<D>& state, double h) const {
  if (std::find(state.frozen.begin(), state.frozen.end(), 1) == state.frozen.end()) {
    state.contacts.resize(touches_.size());
    each(workers(), int(touches_.size()), kTouchPiece, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) state.contacts[i] = contact(touches_[i], h);
    });
    return;
  }
  const auto asleep = [&](int body) { return body < 0 || inactive_[body]; };
  std::erase_if(state.contacts, [&](const Contact<D>& c) { return !asleep(c.key.a) || !asleep(c.key.b); });
  const std::size_t kept = state.contacts.size();
  state.contacts.resize(kept + touches_.size());
  each(workers(), int(touches_.size()), kTouchPiece, [&](int begin, int end) {
    for (auto i = std::size_t(begin); i < std::size_t(end); ++i)
      state.contacts[kept + i] = contact(touches_[i], h);
  });
  std::inplace_merge(state.contacts.begin(), state.contacts.begin() + std::ptrdiff_t(kept),
                     state.contacts.end(), [](const auto& p, const auto& q) { return p.key < q.key; });
}

// a contact as the state keeps it
Contact<3> SpaceIterative::contact(const ContactConstraint& touch, double h) const {
  Contact<D> it;
  it.key = touch.key, it.point = touch.point, it.normal = touch.n, it.gap = touch.gap;
  const Vec<D> impulse = touch.normal_impulse * touch.n + touch.tangent_impulse;
  it.force = impulse / h, it.before = touch.before;
  if (touch.bounces && touch.least > 0) it.impulse = impulse;
  it.impulse += touch.impact_impulse;
  it.touching =
      touch.normal_impulse <= 0 ? ContactMode::open
      : std::sqrt(touch.tangent_impulse.squaredNorm()) < touch.mu * touch.normal_impulse * (1 - 1e-9)
          ? ContactMode::stick
          : ContactMode::slide;
  if (it.touching == ContactMode::open && !touch.impact_impulse.isZero(0)) it.touching = ContactMode::slide;
  return it;
}

}  // namespace obscura::sim
