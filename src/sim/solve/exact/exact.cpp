// One step of the event-driven solver, with contact forces inside the stages of the integrator.
//   1. impacts of this instant
//   2. contact modes and forces at this instant: K f + b = w under the laws of cone_law.h
//   3. smooth motion with those modes, up to the next event or the end of the step
//   4. projection of positions and velocities onto the constraints; again from 1
// After too many events the rest of the step is done at once, by impulses.

#include "sim/solve/exact/exact.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/energy/energy.h"
#include "sim/solve/exact/couples.h"

namespace obscura::sim {

namespace {

constexpr double kCreep = 1e-6;      // of sqrt(g L)
constexpr double kSunk = 0.1;        // of the thinnest: how far two may come into each other in one piece
constexpr double kMostPieces = 200;  // of a step that is done roughly
constexpr double kTiny = 1e-6;       // of a step: a cut that leads nowhere
constexpr int kStuck = 16;           // such cuts, one after another
constexpr int kThorough = 32;        // steps: in each such one what is not found is looked for everywhere
constexpr double kManyLooks = 3e5;   // at couples, before a step is
constexpr int kMostRounds = 8;       // of stepping again what got farther than expected
constexpr int kMostLoneCuts =
    50000;  // of a step, by a body that meets walls alone: a bounce takes microseconds

}  // namespace

template <int D>
ExactSolver<D>::ExactSolver(const Model<D>& model, const std::vector<Path<D>>& paths, Serves whom)
    : model_(model),
      may_touch_(model),
      integrate_(sim::integrate(model.integrator)),
      free_(model, paths),
      response_(model) {
  const double g = std::sqrt(model.gravity.squaredNorm()), h = 1 / value(model.rate);
  const bool exact = model.collision == Collision::event;
  pace_ = std::sqrt(g * model.scale);
  if (pace_ == 0) pace_ = model.scale;
  closed_ = (exact ? 1e-12 : 1e-9) * model.scale;
  rest_ = exact ? 1e-6 * pace_ : std::max(1e-6 * pace_, 0.1 * g * h);
  most_cuts_ = exact ? 2000 + 100 * int(model.bodies.size()) : 12;
  most_openings_ = exact ? most_cuts_ : 6;
  patience_ = exact ? 8 + int(model.bodies.size()) : 4;
  short_ = exact ? 1.0 / 64 : 1.0 / 4;
  budget_ = exact ? 1e300 : 1e7;
  if (!exact) cone_.enough = 1e-7;
  for (const Joint<D>& joint : model.joints) row_joints_ += !joint.linked;
  for (const Body<D>& body : model.bodies) {
    bounding_radius_.push_back(sim::bounding_radius(body.shape));
    half_thickness_.push_back(half_thickness(body.shape));
  }
  if (whom == Serves::all) {
    list_couples<D>(model, [&](int a, int b) { couples_.push_back({a, b}); });
  } else {
    for (int a = 0; a < int(model.bodies.size()); ++a)
      if (model.bodies[a].fixed) fixed_.push_back(a);
  }
  const auto number = [](std::vector<int>& list, std::size_t size) {
    list.resize(size);
    std::iota(list.begin(), list.end(), 0);
  };
  number(every_body_, model.bodies.size()), number(every_joint_, model.joints.size());
  number(every_spring_, model.springs.size()), number(every_chain_, model.chains.size());
  reach_.resize(model.bodies.size());
  groups_.reserve(model.bodies.size());
}

template <int D>
void ExactSolver<D>::keep(const State<D>& state, Motion& motion) const {
  motion.x.resize(state.x.size()), motion.v.resize(state.v.size());
  motion.turn.resize(state.turn.size()), motion.spin.resize(state.spin.size());
  motion.own.resize(state.own.size()), motion.postures.resize(state.postures.size());
  for (const int body : active_.subset.bodies) {
    motion.x[body] = state.x[body], motion.v[body] = state.v[body];
    const int k = turning(state, body);
    if (k < 0) continue;
    motion.turn[k] = state.turn[k], motion.spin[k] = state.spin[k];
    if (std::size_t(k) < state.own.size()) motion.own[k] = state.own[k];
  }
  for (const int chain : active_.subset.chains) motion.postures[chain] = state.postures[chain];
}

template <int D>
void ExactSolver<D>::restore(const Motion& motion, State<D>& state) const {
  for (const int body : active_.subset.bodies) {
    state.x[body] = motion.x[body], state.v[body] = motion.v[body];
    const int k = turning(state, body);
    if (k < 0) continue;
    state.turn[k] = motion.turn[k], state.spin[k] = motion.spin[k];
    if (std::size_t(k) < state.own.size()) state.own[k] = motion.own[k];
  }
  for (const int chain : active_.subset.chains) state.postures[chain] = motion.postures[chain];
}

// whether every number of the bodies at hand is finite
template <int D>
bool ExactSolver<D>::sound(const State<D>& state) const {
  for (const int body : active_.subset.bodies) {
    if (!state.x[body].array().isFinite().all() || !state.v[body].array().isFinite().all()) return false;
    const int k = turning(state, body);
    if (k >= 0 && !(state.turn[k].array().isFinite().all() && state.spin[k].array().isFinite().all()))
      return false;
  }
  return true;
}

// kinetic energy of the bodies at hand, J
template <int D>
double ExactSolver<D>::motion(const State<D>& state) const {
  double sum = 0;
  for (const int body : active_.subset.bodies) {
    if (!model_.bodies[body].fixed) sum += kinetic(model_, state, body);
  }
  return sum;
}

// collects the bodies at hand, whatever of them is awake
template <int D>
void ExactSolver<D>::ready(State<D>& state) {
  double fastest = 0;
  for (const int body : active_.subset.bodies) {
    response_.set(body, !model_.bodies[body].fixed && !state.frozen[body]);
    fastest = std::max(fastest, state.v[body].squaredNorm());
  }
  still_ = 1e-11 * std::max(pace_, std::sqrt(fastest));
  free_.gather(state, active_.subset);
  stages_.reserve(std::size_t(free_.size()));
}

template <int D>
void ExactSolver<D>::step(State<D>& state, double t, double h) {
  const std::size_t n = model_.bodies.size();
  begin_groups(state);
  all_contacts_.clear(), all_impulses_.clear();
  joint_forces_ = state.joint_forces;
  cone_.thorough = model_.collision == Collision::event || state.step % kThorough == 0;

  enter_all();
  ready(state);
  keep(state, first_);
  frozen_then_ = state.frozen, quiet_then_ = state.quiet;
  bound_ways(state, t, h);
  near_.reset(int(n)), old_root_.assign(n, -1), strayed_.assign(n, 0.0), spent_.assign(n, 0);
  for (int round = 0; round < kMostRounds; ++round) {
    // bodies that got farther than expected, into the reach of others, are stepped again together with them
    join_near(state);
    bool any = false;
    list_groups(state);
    for (const Group& group : groups_) {
      bool known = old_root_[group.root] == group.root;
      for (const int body : group.subset.bodies) known = known && old_root_[body] == group.root;
      if (known) continue;
      any = true;
      enter(group);
      if (round > 0) {
        restore(first_, state);
        for (const int body : group.subset.bodies)
          state.frozen[body] = frozen_then_[body], state.quiet[body] = quiet_then_[body];
        const auto of_group = [&](const Contact<D>& c) {
          return group_of_[c.key.a] == group_of_[group.root];
        };
        std::erase_if(all_contacts_, of_group), std::erase_if(all_impulses_, of_group);
      }
      for (const int body : group.subset.bodies) old_root_[body] = group.root, spent_[body] = 0;
      advance(state, t, h);
      all_contacts_.insert(all_contacts_.end(), contacts_.begin(), contacts_.end());
      all_impulses_.insert(all_impulses_.end(), impulses_.begin(), impulses_.end());
    }
    if (!any) break;
  }
  contacts_.swap(all_contacts_), impulses_.swap(all_impulses_);
  const auto sooner = [](const auto& p, const auto& q) { return p.key < q.key; };
  std::sort(contacts_.begin(), contacts_.end(), sooner);

  enter_all();
  ready(state);
  report(state);
  rest(state, t + h, h);
  report(state);
  break_joints(state);
}

// moves the group at hand from t to t + h
template <int D>
void ExactSolver<D>::advance(State<D>& state, double t, double h) {
  ready(state);
  contacts_.clear(), impulses_.clear();
  known_ = &state.contacts;
  double done = 0;
  int tiny = 0;  // cuts in a row that led nowhere
  forced_.clear(), forced_again_ = false;
  rough_ = false, work_ = 0, looks_ = 0;
  openings_ = most_openings_, let_go_.reset(), vague_.clear();
  const bool exact = model_.collision == Collision::event;
  const int most_cuts = exact ? most_cuts_ : active_.lone ? kMostLoneCuts : most_cuts_;
  const double slowest = rest_, fastest = std::max(rest_, pace_ * pace_ / model_.scale * h);
  int grown = 0;  // cuts at which rest has grown
  // `event` counts the cuts of all bodies of the group
  for (int spent = 0; done < h; spent = exact ? spent + 1 : most_spent()) {
    find(state, closed_);
    if (wake(state)) {
      ready(state);
      find(state, closed_);
    }
    resolve_impacts(state);
    bool cut = true;
    double length = 0;
    bool held_again = false;  // what let go is to be held: the same instant once more
    // what is as fast as 1e6 room heights a second has as many places to be looked for
    if ((work_ > budget_ || looks_ > kManyLooks) && done > 0) rough_ = true;
    const bool chosen = !rough_ && choose(state, t + done) && !jammed();
    if (!chosen) rough_ = !exact;
    if (chosen && spent < most_cuts && tiny <= kStuck) {
      if (let_go_) part_ways();
      remember();
      if (coming_apart()) project(state);
      // on the brink nothing slips: as an equality it is a stick
      holding_ = modes_;
      for (ConeMode<D>& mode : holding_) {
        if (mode.hold == Hold::at_friction_limit) mode.hold = Hold::stick;
      }
      if (D > 2) begin_slides(state, t + done, h - done);
      const std::size_t forced = forced_.size();
      length = stretch(state, t + done, h - done, cut);
      held_again = forced_.size() > forced && !forced_again_;
      if (length > 0) project(state);
      if (cut) charge(charged_.a, charged_.b);
    }
    if (length == 0 && !held_again) {
      // no way to go on but a short one at once
      length = std::min(spent < most_cuts && !rough_ ? short_ * h : std::max(h / kMostPieces, unseen(state)),
                        h - done);
      settle(state, t + done, length);
      cut = length < h - done;
      charge(-1, -1);
    }
    if (length > 0) {
      measure_ways(state);
      forced_.clear(), forced_again_ = false;
      tiny = length < kTiny * h ? tiny + 1 : 0;
    }
    done = cut ? done + length : h;
    // ever faster impacts count as rest, so that what bounces ever faster comes to an end
    if (spent > patience_ && spent % 2 == 0 && spent > grown) {
      rest_ = std::min(fastest, 2 * rest_);
      grown = spent;
    }
  }
  rest_ = slowest;
  find(state, closed_);
  if (wake(state)) {
    ready(state);
    find(state, closed_);
  }
  resolve_impacts(state);
  // the forces that joints are shown with and break by are those of the end
  if (!active_.joints.empty() && choose(state, t + h)) remember();
  // what was pushed out of another has another gap now than when its force was found
  if (!rough_) return;
  stand(state);
  for (Contact<D>& contact : contacts_) contact.gap = gap_of(contact.key, contact.gap);
}

// what the last stretch ended by lets go, or slips, if it bears next to nothing more now
template <int D>
void ExactSolver<D>::part_ways() {
  --openings_;
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact || gaps_[held.of].key != *let_go_ || !acts(held)) continue;
    ConeMode<D>& mode = modes_[held.block];
    const Tangent<D> drag = f_.segment(held.first + 1, D - 1);
    const double left = grasp(held, f_);
    if (f_[held.first] <= slight_) {
      mode.hold = Hold::open;
      f_.segment(held.first, D).setZero();
    } else if (left <= slight_ && mode.hold != Hold::slide) {
      mode.hold = Hold::slide, mode.along = -drag / std::sqrt(drag.squaredNorm());
    } else if (left > 0.25 * grasp_at_let_go_) {
      vague_.push_back(*let_go_);  // one of many that may bear the same load: its force tells nothing
    }
  }
  let_go_.reset();
}

// s: how long all may move on and not come far into one another
template <int D>
double ExactSolver<D>::unseen(const State<D>& state) const {
  double least = 1e300;
  for (const int body : active_.subset.bodies) {
    if (half_thickness_[body] > 0) least = std::min(least, half_thickness_[body]);
  }
  double fastest = 0;
  for (const int body : active_.subset.bodies) {
    if (!response_.moves(body)) continue;
    double speed = std::sqrt(state.v[body].squaredNorm());
    if (const int k = turning(state, body); k >= 0)
      speed += bounding_radius_[body] * std::sqrt(state.spin[k].squaredNorm());
    fastest = std::max(fastest, speed);
  }
  return fastest > 0 ? kSunk * least / fastest : 1e300;
}

template <int D>
void ExactSolver<D>::rates(double t, std::span<const double> d, std::span<const double> v,
                           std::span<double> d_rate, std::span<double> v_rate) {
  free_.rates(t, d, v, d_rate, v_rate);
  if (held_.empty()) return;

  // rows at the poses of this stage
  const auto& members = free_.bodies();
  for (std::size_t i = 0; i < members.size(); ++i) stances_[members[i]] = free_.stances()[i];
  const auto& links = free_.chains().links();
  for (std::size_t i = 0; i < links.size(); ++i) stances_[links[i]] = free_.stances()[members.size() + i];
  rows_.clear();
  for (Held& held : held_) lay_rows(held, AngularVec<D>::Zero());
  chain_response_.build(rows_, response_, free_.chains());
  b_.resize(Eigen::Index(rows_.size()));
  for (int i = 0; i < int(rows_.size()); ++i) b_[i] = along(i, v_rate) + rows_[i].velocity_product;

  // what holds goes on holding
  if (D > 2) turn_slides();
  hold();
  for (int i = 0; i < int(rows_.size()); ++i) push(i, f_[i], v_rate);
}

// contacts and joints and their forces as they were chosen last; joints of what is frozen keep theirs
template <int D>
void ExactSolver<D>::remember() {
  contacts_.clear(), known_ = &contacts_;
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (response_.moves(joint.a.body) || response_.moves(joint.b.body)) joint_forces_[i].setZero();
  }
  chain_forces();
  for (const Held& held : held_) {
    if (held.kind == Held::Kind::contact) continue;
    for (int i = held.first; i < held.first + held.rows; ++i)
      joint_forces_[held.of] += f_[i] * rows_[i].along;
  }
  for (const Held& held : held_) {
    if (held.kind != Held::Kind::contact) continue;
    const Hold hold = modes_[held.block].hold;
    if (hold == Hold::open) continue;
    Contact<D> contact;
    contact.key = gaps_[held.of].key;
    contact.touching = hold == Hold::slide               ? ContactMode::slide
                       : hold == Hold::at_friction_limit ? ContactMode::at_friction_limit
                                                         : ContactMode::stick;
    contact.point = held.point, contact.normal = held.normal, contact.gap = held.off;
    for (int i = 0; i < D; ++i) contact.force += f_[held.first + i] * rows_[held.first + i].along;
    contacts_.push_back(contact);
  }
}

// joints that are loaded beyond what they bear are no more from the next step on; what they held wakes
template <int D>
void ExactSolver<D>::break_joints(State<D>& state) {
  bool any = false;
  ripe_.assign(model_.bodies.size(), 0);
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (state.broken[i] || !(std::sqrt(state.joint_forces[i].squaredNorm()) > joint.breaks)) continue;
    if (!any) join(state);
    state.broken[i] = 1, any = true;
    for (const int body : {joint.a.body, joint.b.body}) {
      if (body >= 0) ripe_[islands_.root(body)] = 1;
    }
  }
  for (std::size_t i = 0; any && i < ripe_.size(); ++i) {
    if (ripe_[islands_.root(i)]) state.frozen[i] = 0, state.quiet[i] = 0;
  }
}

template <int D>
void ExactSolver<D>::report(State<D>& state) {
  state.joint_forces = joint_forces_;
  for (const Contact<D>& struck : impulses_) {
    const auto at = std::lower_bound(contacts_.begin(), contacts_.end(), struck,
                                     [](const auto& p, const auto& q) { return p.key < q.key; });
    if (at != contacts_.end() && at->key == struck.key) {
      at->impulse = struck.impulse;
    } else {
      contacts_.insert(at, struck);
    }
  }
  // what was frozen keeps its forces
  std::size_t kept = 0;
  for (Contact<D>& contact : state.contacts) {
    if (response_.moves(contact.key.a) || response_.moves(contact.key.b)) continue;
    contact.impulse.setZero();
    state.contacts[kept++] = contact;
  }
  state.contacts.resize(kept);
  state.contacts.insert(state.contacts.end(), contacts_.begin(), contacts_.end());
  std::sort(state.contacts.begin(), state.contacts.end(),
            [](const auto& p, const auto& q) { return p.key < q.key; });
}

// the rest of a step at once: impulses instead of forces, so that nothing that touches comes closer at its
// end
template <int D>
void ExactSolver<D>::settle(State<D>& state, double t, double h) {
  find(state, closed_);
  stand(state);
  gather(state, true);
  keep(state, begun_);
  lay_blocks(true);
  split();
  b_.resize(Eigen::Index(rows_.size()));
  const auto rate = free_.accelerations(state, t);
  for (int i = 0; i < int(rows_.size()); ++i)
    b_[i] = moves(i) + h * (along(i, rate) + rows_[i].velocity_product);
  // What all but rests is begun with the forces of the step before. With these sweeps would go on holding
  // what has begun to fall
  double fastest = 0;
  for (int i = 0; i < int(rows_.size()); ++i) fastest = std::max(fastest, std::abs(moves(i)));
  const auto& members = free_.bodies();
  for (std::size_t i = 0; i < members.size(); ++i) {
    const int body = members[i];
    state.v[body] += h * Eigen::Map<const Vec<D>>(rate.data() + D * i);
    if (const int at = free_.spin_start(int(i)); at >= 0)
      state.spin[turning(state, body)] +=
          h * to_room<D>(stances_[body].room_from_body, Eigen::Map<const AngularVec<D>>(rate.data() + at));
  }
  Articulated<D>& chains = free_.chains();
  chain_change_.assign(rate.begin() + free_.chain_start(), rate.end());
  for (double& change : chain_change_) change *= h;
  chains.jump(state, chain_change_, false);
  guess(fastest < kCreep * pace_ ? h : 0);
  solve();
  jump(state, false);
  for (const int body : members) {
    state.x[body] += 0.5 * h * (begun_.v[body] + state.v[body]);
    if (const int k = turning(state, body); k >= 0)
      state.turn[k] = turned<D>(begun_.turn[k], AngularVec<D>(0.5 * h * (begun_.spin[k] + state.spin[k])));
  }
  chains.advance(begun_.postures, h, state);
  f_ /= h;
  remember();

  // whatever is inside now, and was not: out again
  find(state, closed_);
  gather(state, true);
  lay_blocks(true);
  split();
  for (const Held& held : held_) {
    if (held.kind == Held::Kind::contact && held.off >= -closed_) modes_[held.block].hold = Hold::open;
    if (held.kind == Held::Kind::contact && held.off < -closed_) modes_[held.block].hold = Hold::slide;
    if (held.kind == Held::Kind::motor || held.kind == Held::Kind::friction)
      modes_[held.block].hold = Hold::at_lower;
    if (held.kind == Held::Kind::rope || held.kind == Held::Kind::lower || held.kind == Held::Kind::upper)
      modes_[held.block].hold = held.off < -closed_ ? Hold::free : Hold::at_lower;
  }
  project(state, true);
}

template class ExactSolver<2>;
template class ExactSolver<3>;

}  // namespace obscura::sim
