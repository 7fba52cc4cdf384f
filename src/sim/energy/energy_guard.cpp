// E = sum m v^2 / 2 + w I w / 2 - m g x + springs        before a step, and after it
// An island that has gained dE keeps a part s of its velocities, or of those relative to its motion as one
// body,
//   u = v - V - W x (x - c),   V = P / M,   W = J^-1 L    P, L, J  momentum, angular momentum and inertia
// such that its energy is that before the step,
//   K_u s^2 = K_u - dE
// One that touches something fixed keeps what it had, and of what the step changed, D = v - v_old, a part
//   v' = v + u D,   A u^2 + (m v . D) u = -dE,   A = m D^2 / 2      the root nearest to 0
// so that what slides or rolls in it without a brake goes on as alone. If that is not enough, bodies that
// rose in the step are lowered by a part of their way.

#include "sim/energy/energy_guard.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/constraint/joints/joint.h"
#include "sim/energy/energy.h"
#include "sim/model/body_motion.h"

namespace obscura::sim {

namespace {

constexpr double kFlight = 1e-9;           // of its motion: more no body gains alone
constexpr double kJointed = 1e-3;          // the same on joints, by the error of a step
constexpr double kShared = 1e-2;           // the same of what forces between bodies hold together
constexpr double kMostOfChange = 0.1;      // of what a step changes, at most so much is taken back or added
constexpr double kEnergyRounding = 1e-13;  // of all that is in motion or may fall

template <int D>
Rotation<D> axes(const State<D>& state, int k) {
  return D == 2 ? Rotation<D>(Rotation<D>::Identity()) : rotation<D>(state.turn[k]);
}

// whether it acts between bodies, none of which is moved, and has an energy that they share
template <int D>
bool shared(const Model<D>& model, const Force<D>& force) {
  return force.on != Force<D>::On::each && !force.center && force.has_potential() &&
         !(force.formula && force.formula->timed) &&
         std::none_of(force.subjects.begin(), force.subjects.end(), [&](const Subject<D>& subject) {
           return subject.body >= 0 && model.bodies[std::size_t(subject.body)].driven;
         });
}

// whether a force may give energy that no potential of its subjects tells
template <int D>
bool works(const Model<D>& model, const Force<D>& force) {
  if (shared(model, force)) return false;
  if (force.on != Force<D>::On::each || (force.center && force.center->body >= 0)) return true;
  if (!force.formula) return false;
  return force.formula->potential ? force.formula->timed : force.formula->works && force.formula->feeds;
}

}  // namespace

template <int D>
EnergyGuard<D>::EnergyGuard(const Model<D>& model)
    : model_(model), g_(std::sqrt(model.gravity.squaredNorm())), forces_(model) {
  driven_.assign(model.bodies.size(), 0);
  all_.resize(model.bodies.size());
  std::iota(all_.begin(), all_.end(), 0);
  for (const Force<D>& force : model.forces) {
    if (!works(model, force)) continue;
    for (const Subject<D>& subject : force.subjects) driven_[std::size_t(subject.body)] = 1;
    if (force.center && force.center->body >= 0) driven_[std::size_t(force.center->body)] = 1;
  }
  for (const Body<D>& body : model.bodies) {
    Weight weight;
    if (!body.fixed && !body.handout) weight = {body.mass, body.inertia};
    weights_.push_back(weight);
    size_ += weight.mass * g_ * model.scale;
  }
  sums_.reserve(weights_.size()), bound_.reserve(weights_.size());
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    if (model.joints[i].coil) sprung_.push_back(int(i));
  springs_before_.resize(model.springs.size() + sprung_.size());
  springs_now_.resize(springs_before_.size());
}

template <int D>
double EnergyGuard<D>::kinetic(const State<D>& state, int body) const {
  const Weight& weight = weights_[body];
  double sum = 0.5 * weight.mass * state.v[body].squaredNorm();
  if (const int k = turning(state, body); k >= 0 && weight.mass > 0)
    sum += spin_energy<D>(weight.inertia, axes<D>(state, k), state.spin[k]);
  return sum;
}

// the potentials of forces on each body
template <int D>
void EnergyGuard<D>::add_fields(const State<D>& state, std::vector<double>& to) {
  if (!forces_.potentials()) return;
  stand(state, motions_);
  forces_.energy(t_, motions_, &to);
}

// energy of a spring, or of that of a joint
template <int D>
double EnergyGuard<D>::in_spring(const State<D>& state, int i) const {
  const int springs = int(model_.springs.size());
  return i < springs ? spring_energy(model_, state, i)
                     : joint_spring_energy(model_, state, sprung_[std::size_t(i - springs)]);
}

template <int D>
void EnergyGuard<D>::open(const State<D>& state, double t) {
  t_ = t;
  // with what is fixed, which has its part of what it attracts
  if (forces_.potentials()) forces_.gather(state, all_);
  const int n = int(weights_.size());
  x_ = state.x, v_ = state.v, spin_ = state.spin, broken_ = state.broken, before_.resize(n), now_.resize(n),
  booked_.assign(n, 0);
  for (int i = 0; i < n; ++i) {
    before_[i] = kinetic(state, i) - weights_[i].mass * model_.gravity.dot(state.x[i]);
  }
  add_fields(state, before_);
  for (int i = 0; i < int(springs_before_.size()); ++i) springs_before_[i] = in_spring(state, i);
}

template <int D>
double EnergyGuard<D>::book_ways(State<D>& state, const std::vector<Vec<D>>& ways) {
  const int n = int(weights_.size());
  double sum = 0;
  bool any = false;
  for (int i = 0; i < n; ++i) {
    const Vec<D>& way = ways[std::size_t(i)];
    any = any || !way.isZero(0);
    const double work = -model_.bodies[std::size_t(i)].mass * model_.gravity.dot(way);
    book(i, work), sum += work;
  }
  if (!any || (springs_before_.empty() && !forces_.potentials())) return sum;
  // what is there now, less what there would be without them
  const auto add = [&](double sign) {
    std::fill(now_.begin(), now_.end(), 0.0);
    add_fields(state, now_);
    for (int i = 0; i < n; ++i) book(i, sign * now_[std::size_t(i)]), sum += sign * now_[std::size_t(i)];
    for (int i = 0; i < int(springs_before_.size()); ++i) {
      const double energy = sign * in_spring(state, i);
      springs_before_[std::size_t(i)] += energy, sum += energy;
    }
  };
  add(1);
  placed_ = state.x;
  for (int i = 0; i < n; ++i) state.x[std::size_t(i)] -= ways[std::size_t(i)];
  add(-1);
  state.x = placed_;
  return sum;
}

template <int D>
bool EnergyGuard<D>::risen(const State<D>& state) {
  const int n = int(weights_.size());
  double sum = 0, motion = 0;
  for (int i = 0; i < n; ++i) {
    const double moves = kinetic(state, i);
    now_[i] = moves - weights_[i].mass * model_.gravity.dot(state.x[i]);
    motion += moves;
  }
  add_fields(state, now_);
  for (int i = 0; i < n; ++i) sum += gain(i);
  for (int i = 0; i < int(springs_now_.size()); ++i) {
    springs_now_[i] = in_spring(state, i);
    sum += springs_now_[i] - springs_before_[i], motion += springs_now_[i];
  }
  if (!(sum > kEnergyRounding * (motion + size_))) return false;
  islands_.reset(n);
  touched_.assign(n, 0), carried_.assign(n, 0), rooted_.assign(n, 0), granted_.assign(n, 0);
  return true;
}

template <int D>
void EnergyGuard<D>::touch(int a, int b) {
  const bool stays = b < 0 || weights_[b].mass == 0;
  // a belt carries what lies on it, and the body that has it
  const bool carries =
      model_.bodies[std::size_t(a)].carries() || (b >= 0 && model_.bodies[std::size_t(b)].carries());
  carried_[a] |= char(carries);
  if (b >= 0) carried_[b] |= char(carries);
  if (weights_[a].mass == 0) {
    if (!stays) touched_[b] = rooted_[b] = 1;
    return;
  }
  touched_[a] = 1;
  if (stays)
    rooted_[a] = 1;
  else
    touched_[b] = 1, islands_.join(a, b);
}

// islands, by joints, springs and chains too, and what each has
template <int D>
void EnergyGuard<D>::gather(const State<D>& state) {
  const int n = int(weights_.size());
  const auto counts = [&](int body) { return body >= 0 && weights_[body].mass > 0; };
  tied_.assign(n, 0), jointed_.assign(n, 0), held_.assign(n, 0), shares_.assign(n, 0);
  const bool exact = model_.integrator == Integrator::rk4;  // others may win by their law
  groups_.reset(n), bound_.assign(n, {}), sums_.assign(n, {}), attracts_.assign(n, -1);
  const auto link = [&](int a, int b, bool fast) {
    for (const int body : {a, b}) {
      if (!counts(body)) continue;
      (exact && fast ? jointed_ : tied_)[body] = 1;
      held_[body] |= char(fast);
    }
    if (a >= 0 && b >= 0) {
      carried_[a] |= char(model_.bodies[std::size_t(b)].driven);
      carried_[b] |= char(model_.bodies[std::size_t(a)].driven);
    }
    if (counts(a) && counts(b)) {
      islands_.join(a, b);
      if (fast) groups_.join(a, b);
    } else if (counts(a) || counts(b)) {
      const int body = counts(a) ? a : b;
      rooted_[body] = 1, bound_[body].held = bound_[body].held || fast;
    }
  };
  for (const Spring<D>& spring : model_.springs) link(spring.a.body, spring.b.body, false);
  for (const int i : sprung_)
    link(model_.joints[std::size_t(i)].a.body, model_.joints[std::size_t(i)].b.body, false);
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    // one that has broken in this step has held in it
    if (i < broken_.size() && broken_[i]) continue;
    link(joint.a.body, joint.b.body, true);
    if (!joint.over.empty() || wound(state, i).with > 0)
      each_body_held(model_, state, i,
                     [&](int a) { each_body_held(model_, state, i, [&](int b) { link(a, b, true); }); });
  }
  for (const Articulation<D>& chain : model_.chains) {
    for (const int body : chain.bodies) link(body, chain.bodies[0], true), bound_[body].held = true;
  }

  // what shares an energy gains and loses it together
  for (const Force<D>& force : model_.forces) {
    if (!shared(model_, force)) continue;
    int first = -1;
    for (const Subject<D>& subject : force.subjects) {
      if (!counts(subject.body)) continue;
      if (first < 0) first = subject.body;
      islands_.join(first, subject.body), shares_[std::size_t(subject.body)] = 1;
    }
    for (const Subject<D>& subject : force.subjects) {
      if (first < 0 || counts(subject.body)) continue;
      rooted_[std::size_t(first)] = 1;
      // its part of the energy is theirs
      if (subject.body < 0) continue;
      int& others = attracts_[std::size_t(subject.body)];
      if (others >= 0) islands_.join(others, first);
      others = first;
    }
  }

  // in flight the scheme's own error under a force is no contact's
  for (int i = 0; forces_.any() && i < n; ++i) tied_[i] = tied_[i] || forces_.push(i);

  const auto island = [&](int body) -> Island& { return sums_[islands_.root(body)]; };
  const bool frozen = !state.frozen.empty(), blasting = [&] {
    for (const Blast<D>& blast : state.blasts) {
      if (blast.on) return true;
    }
    return false;
  }();
  for (int i = 0; i < n; ++i) {
    if (const int others = attracts_[std::size_t(i)]; others >= 0) island(others).gain += gain(i);
    if (!counts(i)) continue;
    Island& it = island(i);
    const double m = weights_[i].mass;
    it.gain += gain(i), it.kinetic += kinetic(state, i), it.mass += m, ++it.bodies;
    // of so many that fly, the scheme's own error is more than what contacts add
    if (shares_[std::size_t(i)]) it.granted += kShared * 0.5 * m * v_[std::size_t(i)].squaredNorm();
    it.granted += granted_[i] * m * g_ * model_.scale;
    it.momentum += m * state.v[i], it.middle += m * state.x[i];
    Bound& group = bound_[groups_.root(i)];
    group.lift -= m * model_.gravity.dot(state.x[i] - x_[i]), group.mass += m;
    group.held = group.held || bound_[i].held;
    it.touched = it.touched || touched_[i], it.driven = it.driven || blasting || driven_[i] || carried_[i];
    it.tied = it.tied || tied_[i], it.jointed = it.jointed || jointed_[i], it.held = it.held || held_[i];
    it.rooted = it.rooted || rooted_[i] || (frozen && state.frozen[i]);
  }
  for (int i = 0; i < n; ++i) {
    const Bound& group = bound_[i];
    if (group.mass > 0 && !group.held) island(i).height += std::max(0.0, group.lift);
  }
  for (std::size_t i = 0; i < model_.springs.size(); ++i) {
    const Spring<D>& spring = model_.springs[i];
    const int body = counts(spring.a.body) ? spring.a.body : spring.b.body;
    if (counts(body)) island(body).gain += springs_now_[i] - springs_before_[i];
  }
  for (std::size_t i = 0; i < sprung_.size(); ++i) {
    const Joint<D>& joint = model_.joints[std::size_t(sprung_[i])];
    const std::size_t at = model_.springs.size() + i;
    const int body = counts(joint.a.body) ? joint.a.body : joint.b.body;
    if (counts(body)) island(body).gain += springs_now_[at] - springs_before_[at];
  }
  for (const Joint<D>& joint : model_.joints) {
    const int body = counts(joint.a.body) ? joint.a.body : joint.b.body;
    if (joint.motor && counts(body)) island(body).driven = true;
  }
  for (const Articulation<D>& chain : model_.chains) island(chain.bodies[0]).chained = true;
  for (const Grip<D>& grip : state.grips) {
    if (counts(grip.body)) island(grip.body).driven = true;
  }
  // pushed by something that is no longer near; but what falls by Euler's scheme gains by itself, and so does
  // what turns alone by all of them
  const bool gains = model_.integrator == Integrator::euler;
  for (Island& it : sums_) {
    if (it.touched || (it.tied && !it.jointed) || gains || it.bodies == 1) continue;
    if (it.gain > (it.jointed ? kJointed : kFlight) * it.kinetic) it.touched = true;
  }
}

// for islands that nothing holds: their motion as one body, and the energy of the motion relative to it
template <int D>
void EnergyGuard<D>::move_as_one(const State<D>& state) {
  const int n = int(weights_.size());
  const auto each = [&](const auto& act) {
    for (int i = 0; i < n; ++i) {
      Island& it = sums_[islands_.root(i)];
      if (weights_[i].mass > 0 && it.touched && !it.rooted) act(i, it);
    }
  };
  const auto arm = [&](const Island& it, int i) -> Vec<D> { return state.x[i] - it.middle / it.mass; };
  each([&](int i, Island& it) {
    const double m = weights_[i].mass;
    const Vec<D> r = arm(it, i);
    it.turning += m * moment<D>(r, state.v[i]);
    const int k = turning(state, i);
    const bool turns = k >= 0 && model_.bodies[i].turns();
    const Rotation<D> at = turns ? axes<D>(state, k) : Rotation<D>(Rotation<D>::Identity());
    if (turns) it.turning += inertia_times<D>(weights_[i].inertia, at, state.spin[k]);
    for (int axis = 0; axis < kAngular<D>; ++axis) {
      const AngularVec<D> unit = AngularVec<D>::Unit(axis);
      it.inertia.col(axis) += m * moment<D>(r, cross_velocity<D>(unit, r));
      if (turns) it.inertia.col(axis) += inertia_times<D>(weights_[i].inertia, at, unit);
    }
  });
  for (Island& it : sums_) {
    if (!it.touched || it.rooted) continue;
    // points on a line have no inertia about it
    const double least = 1e-12 * it.inertia.trace();
    for (int axis = 0; axis < kAngular<D>; ++axis) it.inertia(axis, axis) += least;
    const AngularVec<D> w =
        least > 0 ? AngularVec<D>(it.inertia.inverse() * it.turning) : AngularVec<D>(AngularVec<D>::Zero());
    const double apart = it.kinetic - 0.5 * it.momentum.squaredNorm() / it.mass - 0.5 * w.dot(it.turning);
    it.kinetic = apart, it.turning = w;
  }
}

// for islands that something holds, but no joint: how much more of the changes of this step leaves the energy
// that they had
template <int D>
void EnergyGuard<D>::share_changes(const State<D>& state) {
  for (int i = 0; i < int(weights_.size()); ++i) {
    Island& it = sums_[islands_.root(i)];
    if (weights_[i].mass == 0 || !it.touched || !it.rooted) continue;
    const double m = weights_[i].mass;
    const Vec<D> change = state.v[i] - v_[i];
    it.changes += 0.5 * m * change.squaredNorm(), it.rate += m * state.v[i].dot(change);
    const int k = turning(state, i);
    if (k < 0 || !model_.bodies[i].turns()) continue;
    const AngularVec<D> turned = state.spin[k] - spin_[k];
    const AngularVec<D> momentum = inertia_times<D>(weights_[i].inertia, axes<D>(state, k), turned);
    it.changes += 0.5 * turned.dot(momentum), it.rate += state.spin[k].dot(momentum);
  }
  for (Island& it : sums_) {
    if (!it.touched || !it.rooted || it.held || it.chained || it.driven) continue;
    const double gain = it.gain - it.granted, inside = it.rate * it.rate - 4 * it.changes * gain;
    if (!(gain > 0) || !(inside >= 0)) continue;
    const double root = std::sqrt(inside), more = -2 * gain / (it.rate + (it.rate < 0 ? -root : root));
    if (std::abs(more) <= kMostOfChange) it.more = more;
  }
}

template <int D>
double EnergyGuard<D>::take_back(State<D>& state, bool lower) {
  gather(state);
  move_as_one(state);
  share_changes(state);
  double left = 0;
  for (Island& it : sums_) {
    it.gain -= it.granted;
    if (!it.touched || it.driven || (it.chained && !it.rooted) || !(it.gain > 0) || it.more != 0) continue;
    // what slides as one along the ground goes on, if the rest is enough
    if (it.rooted && !it.held && !it.chained && g_ > 0) {
      const Vec<D> down = model_.gravity / g_, as_one = it.momentum / it.mass;
      const Vec<D> along = as_one - down.dot(as_one) * down;
      const double rest = it.kinetic - 0.5 * it.mass * along.squaredNorm();
      if (rest > it.gain) it.along = along, it.kinetic = rest;
    }
    const double has = std::max(it.kinetic, 0.0);
    it.keeps = has > it.gain ? std::sqrt(1 - it.gain / has) : 0;
    if (it.gain <= has) continue;
    // where nothing holds it, what its parts have not among themselves stays: momenta go first
    if (it.rooted && lower && it.height > 0) {
      it.lowers = std::min(1.0, (it.gain - has) / it.height);
    } else {
      left += it.gain - has;
    }
  }
  const double g2 = model_.gravity.squaredNorm();
  for (int i = 0; i < int(weights_.size()); ++i) {
    const Island& it = sums_[islands_.root(i)];
    if (weights_[i].mass == 0) continue;
    if (it.more != 0) {
      state.v[i] += it.more * (state.v[i] - v_[i]);
      if (const int k = turning(state, i); k >= 0) state.spin[k] += it.more * (state.spin[k] - spin_[k]);
    }
    if (it.keeps == 1) continue;
    Vec<D> common = it.along;
    AngularVec<D> spin = AngularVec<D>::Zero();
    if (!it.rooted) {
      spin = it.turning;
      common = it.momentum / it.mass + cross_velocity<D>(spin, Vec<D>(state.x[i] - it.middle / it.mass));
    }
    state.v[i] = common + it.keeps * (state.v[i] - common);
    if (const int k = turning(state, i); k >= 0) state.spin[k] = spin + it.keeps * (state.spin[k] - spin);
    const Bound& group = bound_[groups_.root(i)];
    if (it.lowers > 0 && !group.held && group.lift > 0)
      state.x[i] += it.lowers * group.lift / (group.mass * g2) * model_.gravity;
  }
  for (std::size_t i = 0; i < model_.chains.size(); ++i) {
    const Island& it = sums_[islands_.root(model_.chains[i].bodies[0])];
    if (it.keeps == 1) continue;
    for (double& v : state.chain_states[i].v) v *= it.keeps;
  }
  return left;
}

template class EnergyGuard<2>;
template class EnergyGuard<3>;

}  // namespace obscura::sim
