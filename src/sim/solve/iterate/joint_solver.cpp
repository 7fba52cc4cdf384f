// Joints between velocities and places. Equality rows, C(q) = 0, and those of taut ropes act in each stage of
// the integrator that the scene names,
//   v' = a + M^-1 J f            f: J v' + J' v = 0
// which leads from x, v to x_free, v_free. What iterations with the contacts then change is kept on the
// joints after Rattle (Andersen 1983): with J at the start of a step and J' at its end
//   v*  = v_free + M^-1 (contacts + J l)      l: J v* = J v_free
//   x'  = x_free + h (v* - v_free) / 2 + M^-1 J s   s: C(x') = 0, Newton with the factors at hand
//   v'  = v* + M^-1 (J (s / h - l / 2) + J' (s / h + l / 2) + J' m)     m: J' v' = 0, and motors hold their
//                                                                       speed there
// in space with angular momenta for spins, so that a body that turns on in the step keeps its own. The free
// motion has the order of the integrator, all else is of second order, and no joint drifts. Beside them rows
// with bounds, r: a unit of impulse along r makes the joints react by c = -K^-1 J M^-1 r, so that the
// effective mass is
//   m = 1 / (r M^-1 r - r M^-1 J K^-1 J M^-1 r)

#include "sim/solve/iterate/joint_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

constexpr int kRounds = 8;               // of Newton's
constexpr int kSearches = 12;            // the same, with a search along each
constexpr double kStride = 0.1;          // rad, and of the scene's size: farther nothing is put in a step
constexpr double kLeastFraction = 1e-3;  // of a way, in it
constexpr double kPut = 1e-9;            // of the scene's size: how far off joints may stay
constexpr int kBoundedRounds =
    16;  // an iteration, of rows with bounds among themselves: they begin from nothing
constexpr double kLocked = 1e-6;  // of a row's own: what it can move once joints have answered
constexpr double kApart = 1e-9;   // 1/s, of the scene's size: slower at a joint is rounding
constexpr double kTaut = 1e-8;    // of the scene's size: a rope that is so near its length is taut
constexpr double kAims = 1e-6;    // of its speed: what a motor may be off it that holds it
constexpr double kEndless = 1e300;

}  // namespace

template <int D>
JointSolver<D>::JointSolver(const Model<D>& model)
    : model_(model), motors_(model), response_(model), drives_(model) {
  const std::size_t n = model.bodies.size();
  member_.assign(n, 0), component_of_body_.assign(n, -1);
  clear_pushed();
  at_.resize(n), turn_.resize(n), unprojected_.resize(n);
  pulls_.resize(model.joints.size()), begun_motors_.resize(model.joints.size());
  for (Orientation<D>& turn : turn_) turn.setZero();
  for (const Joint<D>& joint : model.joints) {
    joint.each_body([&](int body) {
      if (body >= 0) member_[body] = 1;
    });
  }
  for (int i = 0; i < int(n); ++i) {
    if (!member_[i]) continue;
    bodies_.push_back(i);
    driven_ = driven_ || model.bodies[std::size_t(i)].driven;
  }
}

template <int D>
void JointSolver<D>::prepare(State<D>& state) const {
  state.broken.resize(model_.joints.size());
  state.joint_forces.resize(model_.joints.size(), Vec<D>::Zero());
}

template <int D>
void JointSolver<D>::gather(const State<D>& state) {
  if (planned_ && broken_ == state.broken && frozen_ == state.frozen) return;
  planned_ = true, broken_ = state.broken, frozen_ = state.frozen;
  for (int i = 0; i < int(model_.bodies.size()); ++i)
    response_.set(i, !model_.bodies[i].fixed && !state.frozen[i]);
  plan();
}

template <int D>
std::span<const int> JointSolver<D>::components_of(std::span<const int> bodies) {
  some_parts_.clear();
  for (const int body : bodies) {
    if (has(body)) some_parts_.push_back(component(body));
  }
  std::sort(some_parts_.begin(), some_parts_.end());
  some_parts_.erase(std::unique(some_parts_.begin(), some_parts_.end()), some_parts_.end());
  return some_parts_;
}

template <int D>
void JointSolver<D>::plan() {
  held_.clear(), pairs_.clear(), ropes_.clear();
  std::vector<int> sizes;
  std::vector<std::vector<int>> of(model_.bodies.size());  // blocks of each body that moves
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (broken_[i] || !moves(joint)) continue;
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    joint.each_body([&](int body) {
      if (response_.moves(body)) of[body].push_back(int(held_.size()));
    });
    if (one_sided(joint)) ropes_.push_back(int(held_.size()));
    held_.push_back(i);
    sizes.push_back(rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_));
  }
  const auto meet = [&](const std::vector<int>& all, const std::vector<int>& others) {
    for (const int i : all) {
      for (const int j : others) {
        if (i < j) pairs_.emplace_back(i, j);
      }
    }
  };
  for (const auto& all : of) meet(all, all);
  std::sort(pairs_.begin(), pairs_.end());
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  factors_.plan(sizes, pairs_);
  for (std::size_t body = 0; body < of.size(); ++body)
    component_of_body_[body] = of[body].empty() ? -1 : factors_.component(of[body].front());
  members_.assign(std::size_t(components()), {});
  for (const int i : bodies_) {
    if (component_of_body_[i] >= 0) members_[component_of_body_[i]].push_back(i);
  }
  rows_.resize(factors_.rows()), old_rows_.resize(factors_.rows());
  for (auto* numbers : {&impulses_, &totals_, &rhs_, &shifts_}) numbers->resize(factors_.rows());
  targets_.assign(std::size_t(factors_.rows()), 0.0);
  taut_.assign(held_.size(), 0), least_force_.assign(held_.size(), 0.0);
  loose_.assign(std::size_t(factors_.rows()), 0);
  for (const int k : ropes_) loose_[std::size_t(factors_.first(k))] = 1;
  first_forces_.assign(held_.size(), Vec<D>::Zero()), last_forces_ = first_forces_;
}

template <int D>
AngularVec<D> JointSolver<D>::turn_between(const Joint<D>& joint) const {
  return joint.turn_between([&](int body) {
    return body < 0 ? AngularVec<D>(AngularVec<D>::Zero()) : AngularVec<D>(rounds<D>(turn_[body]));
  });
}

// M^-1 r p onto velocities
template <int D>
void JointSolver<D>::push(const Row<D>& row, double impulse) {
  each_push(row, impulse,
            [&](int body, const Vec<D>& v, const AngularVec<D>& w) { at_[body].v += v, at_[body].w += w; });
}

// and onto places: angular momentum stays
template <int D>
void JointSolver<D>::shift(const Row<D>& row, double by) {
  each_push(row, by, [&](int body, const Vec<D>& dx, const AngularVec<D>& dturn) {
    const Body<D>& b = model_.bodies[body];
    BodyMotion<D>& at = at_[body];
    at.x += dx;
    if (!b.turns()) return;
    const Rotation<D> from = at.room_from_body;
    turn_[body] = turned<D>(turn_[body], dturn);
    at.room_from_body = rotation<D>(turn_[body]);
    at.w = carried_spin<D>(b.inertia, from, at.room_from_body, at.w);
  });
}

template <int D>
void JointSolver<D>::step(ForwardDynamics<D>& dynamics, Integrate* integrate, State<D>& state, double t,
                          double h, Stages& stages) {
  dynamics_ = &dynamics, begun_ = &state;
  set_poses(state);
  begin_motors();
  find_taut_ropes(h);
  if (!ropes_.empty()) save(state);
  for (;;) {
    first_stage_ = true;
    dynamics.step(integrate, state, t, h, stages, held_.empty() ? nullptr : this);
    if (!slacken_ropes()) break;
    restore(state);
  }
  for (const int k : ropes_) loose_[std::size_t(factors_.first(k))] = 1;
}

template <int D>
void JointSolver<D>::set_poses(const State<D>& state) {
  for (const int body : bodies_) {
    if (!response_.moves(body)) continue;
    at_[body] = sim::body_motion(state, body);
    if (const int k = turning(state, body); k >= 0) turn_[body] = state.turn[std::size_t(k)];
  }
}

// ropes at their length that do not change it faster than gravity can in a step: taut as long as they pull
template <int D>
void JointSolver<D>::find_taut_ropes(double h) {
  const double near = kTaut * model_.scale,
               slow = std::max(std::sqrt(model_.gravity.squaredNorm()) * h, near / h);
  pulls_.assign(model_.joints.size(), {});
  for (const int k : ropes_) {
    const Joint<D>& joint = model_.joints[std::size_t(held_[std::size_t(k)])];
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_);
    taut_[std::size_t(k)] = std::fabs(off[0]) <= near && std::fabs(speed(out[0], at_)) <= slow;
    loose_[std::size_t(factors_.first(k))] = !taut_[std::size_t(k)];
    least_force_[std::size_t(k)] = kEndless;
  }
}

// ropes that would have had to push; true if there are any
template <int D>
bool JointSolver<D>::slacken_ropes() {
  bool any = false;
  for (const int k : ropes_) {
    if (!taut_[std::size_t(k)] || least_force_[std::size_t(k)] >= 0) continue;
    taut_[std::size_t(k)] = 0, loose_[std::size_t(factors_.first(k))] = 1, any = true;
  }
  for (const int k : ropes_) least_force_[std::size_t(k)] = kEndless;
  return any;
}

template <int D>
void JointSolver<D>::save(const State<D>& state) {
  saved_.clear();
  for (const int body : dynamics_->bodies()) {
    Saved& it = saved_.emplace_back();
    it.x = state.x[std::size_t(body)], it.v = state.v[std::size_t(body)];
    const int k = turning(state, body);
    if (k < 0) continue;
    it.turn = state.turn[std::size_t(k)], it.spin = state.spin[std::size_t(k)];
    if (std::size_t(k) < state.body_spin.size()) it.body_spin = state.body_spin[std::size_t(k)];
  }
}

template <int D>
void JointSolver<D>::restore(State<D>& state) const {
  for (std::size_t i = 0; i < saved_.size(); ++i) {
    const int body = dynamics_->bodies()[i];
    const Saved& it = saved_[i];
    state.x[std::size_t(body)] = it.x, state.v[std::size_t(body)] = it.v;
    const int k = turning(state, body);
    if (k < 0) continue;
    state.turn[std::size_t(k)] = it.turn, state.spin[std::size_t(k)] = it.spin;
    if (std::size_t(k) < state.body_spin.size()) state.body_spin[std::size_t(k)] = it.body_spin;
  }
}

// the coordinates of motors where the step begins
template <int D>
void JointSolver<D>::begin_motors() {
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (!joint.motor || broken_[i] || !moves(joint)) continue;
    Row<D> row;
    double value = 0;
    free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), row, value);
    begun_motors_[i] = {value, speed(row, at_)};
  }
}

// J v'
template <int D>
double JointSolver<D>::row_acceleration(const Row<D>& row, std::span<const double> v_rate) const {
  double sum = 0;
  each_side(row, [&](int body, const Vec<D>& along, const AngularVec<D>& angular) {
    if (const int drive = drives_.number(body); drive >= 0) {
      const DrivenMotion<D>& its = dynamics_->driven()[std::size_t(drive)];
      sum += along.dot(its.a) + angular.dot(its.alpha);
    }
    if (!response_.moves(body)) return;
    const int place = dynamics_->place(body);
    sum += along.dot(Eigen::Map<const Vec<D>>(v_rate.data() + D * place));
    if (const int at = dynamics_->spin_start(place); at >= 0)
      sum += angular.dot(
          to_room<D>(at_[body].room_from_body, Eigen::Map<const AngularVec<D>>(v_rate.data() + at)));
  });
  return sum;
}

template <int D>
void JointSolver<D>::rates(double t, std::span<const double> d, std::span<const double> v,
                           std::span<double> d_rate, std::span<double> v_rate) {
  dynamics_->rates(t, d, v, d_rate, v_rate);
  for (const int body : bodies_) {
    if (const int drive = drives_.number(body); drive >= 0) {
      const DrivenMotion<D>& its = dynamics_->driven()[std::size_t(drive)];
      at_[body] = its.at, turn_[body] = its.turn;
    }
    if (!response_.moves(body)) continue;
    const int place = dynamics_->place(body);
    at_[body] = dynamics_->stances()[std::size_t(place)];
    if constexpr (D == 2) {
      if (const int at = dynamics_->spin_start(place); at >= 0)
        turn_[body][0] = begun_->turn[std::size_t(turning(*begun_, body))][0] + d[std::size_t(at)];
    }
  }
  compute_rows();
  for (std::size_t r = 0; r < rows_.size(); ++r)
    rhs_[r] = -row_acceleration(rows_[r], v_rate) - rows_[r].velocity_product;
  factors_.solve(rhs_.data());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    each_push(rows_[r], rhs_[r], [&](int body, const Vec<D>& dv, const AngularVec<D>& dw) {
      const int place = dynamics_->place(body);
      Eigen::Map<Vec<D>>(v_rate.data() + D * place) += dv;
      if (const int at = dynamics_->spin_start(place); at >= 0)
        Eigen::Map<AngularVec<D>>(v_rate.data() + at) += from_room<D>(at_[body].room_from_body, dw);
    });
  }
  if (const int work = dynamics_->work_place(); work >= 0 && driven_) {
    for (std::size_t r = 0; r < rows_.size(); ++r) v_rate[std::size_t(work)] += rhs_[r] * drive_works_[r];
  }
  for (std::size_t k = 0; k < held_.size(); ++k) {
    last_forces_[k].setZero();
    const int first = factors_.first(int(k));
    for (int r = first; r < first + factors_.size(int(k)); ++r) last_forces_[k] += rhs_[r] * rows_[r].along;
  }
  for (const int k : ropes_) {
    if (taut_[std::size_t(k)])
      least_force_[std::size_t(k)] =
          std::min(least_force_[std::size_t(k)], rhs_[std::size_t(factors_.first(k))]);
  }
  if (first_stage_) first_forces_ = last_forces_;
  first_stage_ = false;
}

template <int D>
void JointSolver<D>::keep_row_speeds() {
  for (std::size_t r = 0; r < rows_.size(); ++r) targets_[r] = speed(rows_[r], at_);
  for (const int k : ropes_) {
    if (!taut_[std::size_t(k)]) continue;
    const int i = held_[std::size_t(k)];
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_);
    pulls_[std::size_t(i)] = {true, speed(out[0], at_)};
  }
}

// rows at the present poses, and their factors
template <int D>
void JointSolver<D>::compute_rows() {
  double off[kMostHeld<D>];
  for (int k = 0; k < int(held_.size()); ++k) {
    const Joint<D>& joint = model_.joints[held_[k]];
    Row<D>* const first = &rows_[factors_.first(k)];
    if (loose_[std::size_t(factors_.first(k))]) {
      *first = {};
      continue;
    }
    rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), first, off, at_);
  }
  drive_works_.assign(driven_ ? rows_.size() : 0, 0);
  for (std::size_t r = 0; r < drive_works_.size(); ++r) drive_works_[r] = given(rows_[r]);
  constexpr int kMost = kMostHeld<D>;
  const auto fill = [&](auto& block, int i, int j) {
    for (int r = 0; r < factors_.size(i); ++r) {
      for (int c = 0; c < factors_.size(j); ++c)
        block[r * kMost + c] =
            response_.coupling(rows_[factors_.first(i) + r], rows_[factors_.first(j) + c], at_);
    }
  };
  for (int k = 0; k < int(held_.size()); ++k) {
    fill(factors_.diagonal(k), k, k);
    if (loose_[std::size_t(factors_.first(k))]) factors_.diagonal(k)[0] = 1;
  }
  for (int e = 0; e < int(pairs_.size()); ++e) fill(factors_.entry(e), pairs_[e].first, pairs_[e].second);
  factors_.factorise();
}

// minus the part of the row's speed that bodies have which are moved
template <int D>
double JointSolver<D>::given(const Row<D>& row) const {
  double sum = 0;
  const auto side = [&](int body, const AngularVec<D>& turn, double sign) {
    if (body >= 0 && model_.bodies[std::size_t(body)].driven)
      sum -= sign * (row.along.dot(at_[body].v) + turn.dot(at_[body].w));
  };
  side(row.a, row.angular_a, 1), side(row.b, row.angular_b, -1);
  for (const RowSide<D>& more : row.more) {
    if (model_.bodies[std::size_t(more.body)].driven)
      sum -= more.along.dot(at_[more.body].v) + more.angular.dot(at_[more.body].w);
  }
  return sum;
}

template <int D>
double JointSolver<D>::given(const JointResponse& response) const {
  double sum = 0;
  for (int s = 0; driven_ && s < 2; ++s)
    each_row(response.components[s], [&](int k, int r) { sum += response.answer[s][k] * drive_works_[r]; });
  return sum;
}

// how far a limit or a rope is from its end at the present poses; false of what has none
template <int D>
bool JointSolver<D>::left(const Bounded& bounded, double& off) const {
  const Joint<D>& joint = model_.joints[bounded.joint];
  Row<D> out[kMostHeld<D>];
  if (bounded.load > upper) return false;
  const BodyMotion<D>&a = side(joint.a.body), &b = side(joint.b.body);
  if (one_sided(joint)) {
    double offs[kMostHeld<D>];
    rows(joint, a, b, turn_between(joint), out, offs, at_);
    off = offs[0];
    return true;
  }
  double way = 0;
  free_row(joint, a, b, turn_between(joint), out[0], way);
  off = bounded.load == lower ? way - joint.lower : joint.upper - way;
  return true;
}

// rows with bounds, of limits and ropes those that may come to their end in the step
template <int D>
void JointSolver<D>::collect_bounded(double h) {
  active_ = 0;
  const double g = std::sqrt(model_.gravity.squaredNorm());
  const auto add = [&](int i, Load load) {
    const Joint<D>& joint = model_.joints[i];
    if (active_ == bounded_.size()) bounded_.emplace_back();
    Bounded& b = bounded_[active_];
    b.joint = i, b.load = load;
    b.impulse = 0, b.taut = false, b.put = 0;

    Row<D> out[kMostHeld<D>];
    double offs[kMostHeld<D>];
    const BodyMotion<D>&p = side(joint.a.body), &q = side(joint.b.body);
    if (one_sided(joint)) {
      rows(joint, p, q, turn_between(joint), out, offs, at_);
    } else {
      free_row(joint, p, q, turn_between(joint), out[0], offs[0]);
    }
    b.row = out[0];
    if (load == upper && !one_sided(joint)) b.row.reverse();
    b.least = 0, b.most = kEndless, b.target = 0;
    if (double off = 0; left(b, off)) {
      const double sees = 4 * h * (std::fabs(speed(b.row, at_)) + g * h) + 1e-3 * model_.scale;
      if (off > sees) return;
      b.target = pulls_[std::size_t(i)].taut ? pulls_[std::size_t(i)].target : -std::max(off, 0.0) / h;
      b.taut = one_sided(joint) && std::fabs(off) <= kPut * model_.scale;
    } else {
      b.most = h * (load == motor ? joint.motor->most : joint.friction), b.least = -b.most;
      if (load == motor) {
        b.target = motors_.at(i, ends_, offs[0] + h * speed(b.row, at_), speed(b.row, at_)).speed;
        b.ends = kEndless;
        const Coordinate& begun = begun_motors_[std::size_t(i)];
        const double aimed = motors_.at(i, ends_ - h, begun.value, begun.rate).speed;
        if (std::fabs(begun.rate - aimed) <= kAims * (std::fabs(aimed) + h * h))
          b.ends = begun.value + 0.5 * h * (begun.rate + b.target);
      }
    }

    b.begun_drive_work = driven_ ? given(b.row) : 0;
    compute_response(b);
    b.effective_mass = effective_mass(b);
    active_ += b.effective_mass > 0;
  };
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (broken_[i] || !moves(joint)) continue;
    if (one_sided(joint)) add(i, upper);
    if (!has_free_row(joint)) continue;
    if (joint.lower > -1e299) add(i, lower);
    if (joint.upper < 1e299) add(i, upper);
    if (joint.motor) add(i, motor);
    if (joint.friction > 0) add(i, friction);
  }
}

template <int D>
void JointSolver<D>::compute_response(JointResponse& response) {
  const auto component = [&](int body) { return body < 0 ? -1 : component_of_body_[body]; };
  int* const components = response.components;
  components[0] = component(response.row.a), components[1] = component(response.row.b);
  if (components[0] < 0) std::swap(components[0], components[1]);
  if (components[1] == components[0]) components[1] = -1;
  // all that a mechanism holds is of one component
  for (const RowSide<D>& side : response.row.more)
    components[0] = std::max(components[0], component(side.body));
  for (int s = 0; s < 2; ++s) {
    response.answer[s].clear(), response.affected[s].clear();
    if (components[s] < 0) continue;
    each_row(components[s], [&](int k, int r) {
      const double fast = response_.coupling(rows_[r], response.row, at_);
      rhs_[r] = -fast;
      if (fast != 0) response.affected[s].emplace_back(k, fast);
    });
    factors_.solve(rhs_.data(), components[s]);
    each_row(components[s], [&](int, int r) { response.answer[s].push_back(rhs_[r]); });
  }
}

template <int D>
double JointSolver<D>::response_between(const JointResponse& p, const JointResponse& q) const {
  double sum = response_.coupling(p.row, q.row, at_);
  for (int s = 0; s < 2; ++s) {
    for (int r = 0; r < 2 && p.components[s] >= 0; ++r) {
      if (q.components[r] != p.components[s]) continue;
      for (const auto& [k, fast] : p.affected[s]) sum += fast * q.answer[r][k];
    }
  }
  return sum;
}

// zero where joints leave it nothing to move
template <int D>
double JointSolver<D>::effective_mass(const Bounded& b) const {
  const double own = response_.coupling(b.row, b.row, at_), with_joints = response_between(b, b);
  return with_joints > kLocked * own ? 1 / with_joints : 0;
}

// by components, and how they move each other
template <int D>
void JointSolver<D>::couple_bounded() {
  // component_first_[p + 1] begins component p, the next one ends it
  component_first_.assign(components() + 2, 0), by_component_.resize(active_);
  for (std::size_t k = 0; k < active_; ++k) ++component_first_[bounded_[k].components[0] + 1];
  int before = 0;
  for (int& first : component_first_) before += std::exchange(first, before);
  for (std::size_t k = 0; k < active_; ++k)
    by_component_[component_first_[bounded_[k].components[0] + 1]++] = int(k);
  for (std::size_t p = component_first_.size(); p-- > 1;) component_first_[p] = component_first_[p - 1];
  component_first_[0] = 0;

  yields_.clear();
  for (int component = -1; component < components(); ++component) {
    const int begin = component_first_[component + 1], end = component_first_[component + 2];
    for (int i = begin; i < end; ++i) {
      Bounded& b = bounded_[by_component_[i]];
      b.first = int(yields_.size());
      for (int j = begin; j < end; ++j) yields_.push_back(response_between(b, bounded_[by_component_[j]]));
    }
  }
}

// changes_ of a component onto the velocities, with what the joints answer
template <int D>
void JointSolver<D>::push_bounded(int component) {
  const int begin = component_first_[component + 1], end = component_first_[component + 2];
  bool any = false;
  for (int i = begin; i < end; ++i) {
    if (changes_[i] == 0) continue;
    any = true;
    push(bounded_[by_component_[i]].row, changes_[i]);
  }
  if (!any) return;
  each_row(component, [&](int k, int r) {
    double sum = 0;
    for (int i = begin; i < end; ++i) sum += bounded_[by_component_[i]].answer[0][k] * changes_[i];
    impulses_[r] += sum, totals_[r] += sum;
    push(rows_[r], sum);
  });
}

// one onto places
template <int D>
void JointSolver<D>::shift_bounded(const Bounded& bounded, double by) {
  shift(bounded.row, by);
  each_row(bounded.components[0], [&](int k, int r) { shift(rows_[r], bounded.answer[0][k] * by); });
}

template <int D>
void JointSolver<D>::project_initial_velocities(State<D>& state) {
  if (bodies_.empty()) return;
  gather(state);
  for (const int i : bodies_) {
    at_[i] = sim::body_motion(state, i);
    if (const int k = turning(state, i); k >= 0) turn_[i] = state.turn[k];
  }
  compute_rows();
  double fastest = 0;
  for (const Row<D>& row : rows_) fastest = std::max(fastest, std::fabs(speed(row, at_)));
  if (fastest <= kApart * model_.scale) return;
  solve_positions();
  for (const int i : bodies_) {
    if (!response_.moves(i)) continue;
    state.v[i] = at_[i].v;
    if (const int k = turning(state, i); k >= 0) state.spin[k] = at_[i].w;
  }
}

template <int D>
void JointSolver<D>::begin(double h, double t) {
  ends_ = t + h;
  collect_bounded(h);
  couple_bounded();
  std::fill(impulses_.begin(), impulses_.end(), 0.0), std::fill(totals_.begin(), totals_.end(), 0.0);
  speeds_.resize(active_), changes_.resize(active_);
}

template <int D>
void JointSolver<D>::iterate() {
  for (int component = -1; component < components(); ++component) iterate(component);
}

template <int D>
void JointSolver<D>::iterate(int component) {
  if (component >= 0) {
    each_row(component, [&](int, int r) { rhs_[r] = targets_[r] - speed(rows_[r], at_); });
    factors_.solve(rhs_.data(), component);
    each_row(component, [&](int, int r) {
      impulses_[r] += rhs_[r], totals_[r] += rhs_[r];
      push(rows_[r], rhs_[r]);
    });
  }
  const int begin = component_first_[component + 1], end = component_first_[component + 2];
  if (begin == end) return;
  for (int i = begin; i < end; ++i) {
    const Bounded& b = bounded_[by_component_[i]];
    speeds_[i] = speed(b.row, at_) - b.target, changes_[i] = 0;
  }
  for (int round = 0; round < kBoundedRounds; ++round) {
    for (int i = begin; i < end; ++i) {
      Bounded& b = bounded_[by_component_[i]];
      const double next = std::clamp(b.impulse - b.effective_mass * speeds_[i], b.least, b.most);
      const double change = next - b.impulse;
      if (change == 0) continue;
      b.impulse = next, changes_[i] += change;
      for (int j = begin; j < end; ++j) speeds_[j] += yields_[b.first + j - begin] * change;
    }
  }
  push_bounded(component);
}

template <int D>
void JointSolver<D>::solve_positions() {
  for (std::size_t r = 0; r < rows_.size(); ++r) rhs_[r] = -speed(rows_[r], at_);
  factors_.solve(rhs_.data());
  for (std::size_t r = 0; r < rows_.size(); ++r) push(rows_[r], rhs_[r]);
}

// how far joints are off, at most; into rhs_ what would bring each row back
template <int D>
double JointSolver<D>::position_error() {
  double worst = 0;
  for (int k = 0; k < int(held_.size()); ++k) {
    const Joint<D>& joint = model_.joints[held_[k]];
    if (one_sided(joint)) {
      rhs_[factors_.first(k)] = 0;
      continue;
    }
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    const int n = rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_);
    for (int i = 0; i < n; ++i) {
      rhs_[factors_.first(k) + i] = -off[i];
      worst = std::max(worst, std::fabs(off[i]));
    }
  }
  return worst;
}

// whether all are near where they stood before they were put back
template <int D>
bool JointSolver<D>::near() const {
  for (const int i : bodies_) {
    if ((at_[i].x - begun_at_[i].x).norm() > kStride * model_.scale) return false;
    if ((at_[i].room_from_body - begun_at_[i].room_from_body).norm() > kStride) return false;
  }
  return true;
}

// Motors that hold their speed all through the step, to where it leads them: else what the forces change by
// within a step adds up.
template <int D>
void JointSolver<D>::put_motors() {
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& bounded = bounded_[k];
    if (bounded.load != motor || bounded.ends == kEndless || !(std::fabs(bounded.impulse) < bounded.most))
      continue;
    const Joint<D>& joint = model_.joints[std::size_t(bounded.joint)];
    Row<D> row;
    double value = 0;
    free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), row, value);
    const double off = bounded.ends - value;
    if (std::fabs(off) < kStride) shift_bounded(bounded, off * bounded.effective_mass);
  }
}

// places back onto what joints keep, and within what they let
template <int D>
void JointSolver<D>::project_positions(double h) {
  put_motors();
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& bounded = bounded_[k];
    double off = 0;
    if (!left(bounded, off)) continue;
    // a rope that pulled keeps its length to both sides
    const bool pulls = pulls_[std::size_t(bounded.joint)].taut && std::fabs(off) <= kTaut * model_.scale;
    if (!pulls && off >= 0) continue;
    const double strayed = position_error();
    begun_at_ = at_, begun_turn_ = turn_;
    if (pulls) {
      shift_bounded(bounded, -off * bounded.effective_mass);
      if (!near() || position_error() > strayed + std::fabs(off)) at_ = begun_at_, turn_ = begun_turn_;
      continue;
    }
    // what joints hardly let it do would throw them far: then only a part of it
    for (double fraction = 1; fraction > kLeastFraction; fraction /= 2) {
      const double put = -fraction * off * bounded.effective_mass;
      shift_bounded(bounded, put);
      double rest = 0;
      left(bounded, rest);
      if (near() && rest > (1 - fraction / 4) * off && position_error() <= strayed - fraction * off) {
        if (bounded.taut) bounded.put = put;
        break;
      }
      at_ = begun_at_, turn_ = begun_turn_;
    }
  }
  begun_at_ = at_, begun_turn_ = turn_;
  std::fill(shifts_.begin(), shifts_.end(), 0.0);
  const double close = 1e-15 * model_.scale, enough = kPut * model_.scale;
  double worst = position_error(), before = kEndless;
  for (int round = 0; round < kRounds && worst > close && worst <= 0.9 * before; ++round) {
    before = worst;
    factors_.solve(rhs_.data());
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      shifts_[r] += rhs_[r];
      shift(rows_[r], rhs_[r]);
    }
    worst = position_error();
  }
  for (double& s : shifts_) s /= h;
  old_rows_ = rows_, begun_drive_works_ = drive_works_;
  if (worst <= enough && near()) return;
  at_.swap(begun_at_), turn_.swap(begun_turn_);
  std::fill(shifts_.begin(), shifts_.end(), 0.0);
  damped_newton();
}

// Position projection by damped Newton iterations, with new rows and factors in each, where the simple one
// with old factors fails, as on levers that turn far in a step. Velocities stay as they are.
template <int D>
void JointSolver<D>::damped_newton() {
  double worst = position_error();
  for (int round = 0; round < kSearches && worst > kPut * model_.scale; ++round) {
    compute_rows();
    position_error();
    factors_.solve(rhs_.data());
    begun_at_ = at_, begun_turn_ = turn_, ways_ = rhs_;
    const double before = worst;
    bool helped = false;
    for (double fraction = 1; !helped && fraction > kLeastFraction; fraction /= 2) {
      at_ = begun_at_, turn_ = begun_turn_;
      for (std::size_t r = 0; r < rows_.size(); ++r) shift(rows_[r], fraction * ways_[r]);
      worst = position_error();
      helped = worst < (1 - fraction / 4) * before && near();
    }
    if (!helped) at_ = begun_at_, turn_ = begun_turn_;
    if (!helped || worst > 0.9 * before) break;
  }
}

template <int D>
void JointSolver<D>::finish(double h) {
  work_ = 0;
  if (bodies_.empty()) return;
  for (const int i : bodies_) unprojected_[i] = at_[i].x;
  project_positions(h);
  // a taut rope turns its bodies' motion as an equality does: s / h of Rattle's
  for (std::size_t k = 0; k < active_; ++k) {
    if (bounded_[k].put == 0) continue;
    bounded_[k].impulse += bounded_[k].put / h;
    each_push(bounded_[k], bounded_[k].put / h,
              [&](int body, const Vec<D>& v, const AngularVec<D>& w) { at_[body].v += v, at_[body].w += w; });
  }
  compute_rows();
  stop_rows();
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    push(old_rows_[r], shifts_[r] - 0.5 * impulses_[r]);
    const double half = 0.5 * impulses_[r] + shifts_[r];
    push(rows_[r], half);
    totals_[r] = 2 * half;
  }
  if (update_bounded()) {
    iterate();
  } else {
    solve_positions();
    for (std::size_t r = 0; r < rows_.size(); ++r) totals_[r] += rhs_[r];
  }
  book();
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& bounded = bounded_[k];
    if (bounded.impulse == 0) continue;
    any_pushed_ = true;
    for (const int component : bounded.components) {
      if (component < 0) continue;
      for (const int body : members_[std::size_t(component)]) pushed_[std::size_t(body)] = 1;
    }
  }
}

// half of each impulse where the step began, half where it ends
template <int D>
void JointSolver<D>::book() {
  work_ = 0;
  if (!driven_) return;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    work_ += 0.5 * totals_[r] * (begun_drive_works_[r] + drive_works_[r]);
  }
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& b = bounded_[k];
    work_ += 0.5 * b.impulse * (b.begun_drive_work + given(b.row));
  }
}

// Motors where bodies now stand, with what they have left to give; what else has bounds has done its
// component. False where there are none.
template <int D>
bool JointSolver<D>::update_bounded() {
  bool any = false;
  for (std::size_t k = 0; k < active_; ++k) {
    Bounded& b = bounded_[k];
    if (b.load != motor && b.put == 0) {
      b.least = b.most = b.impulse;
      continue;
    }
    any = true;
    const Joint<D>& joint = model_.joints[b.joint];
    if (b.load == motor) {
      double way = 0;
      free_row(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), b.row, way);
      b.target = motors_.at(b.joint, ends_, way, speed(b.row, at_)).speed;
    } else {
      Row<D> out[kMostHeld<D>];
      double offs[kMostHeld<D>];
      rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, offs, at_);
      b.row = out[0], b.target = 0, b.least = b.impulse;
    }
    compute_response(b);
    b.effective_mass = effective_mass(b);
  }
  if (any) couple_bounded();
  return any;
}

template <int D>
void JointSolver<D>::keep(State<D>& state, double h, const std::vector<char>* of) const {
  const auto wanted = [&](int i) {
    const Joint<D>& joint = model_.joints[i];
    if (!of) return moves(joint) || broken_[i] != 0;
    return joint.any_body([&](int body) { return response_.moves(body) && (*of)[body] != 0; });
  };
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    if (!wanted(i)) continue;
    state.joint_forces[i].setZero();
  }
  for (int k = 0; k < int(held_.size()); ++k) {
    if (!wanted(held_[k])) continue;
    if (!of) state.joint_forces[held_[k]] += 0.5 * (first_forces_[k] + last_forces_[k]);
    for (int r = factors_.first(k); r < factors_.first(k) + factors_.size(k); ++r)
      state.joint_forces[held_[k]] += totals_[r] / h * rows_[r].along;
  }
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& b = bounded_[k];
    if (!wanted(b.joint)) continue;
    state.joint_forces[b.joint] += b.impulse / h * b.row.along;
  }
}

template <int D>
bool JointSolver<D>::break_joints(State<D>& state) const {
  bool any = false;
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (state.broken[i] || !(std::sqrt(state.joint_forces[i].squaredNorm()) > model_.joints[i].breaks))
      continue;
    state.broken[i] = 1, any = true;
  }
  if (any) break_ropes(model_, state.broken);
  return any;
}

template class JointSolver<2>;
template class JointSolver<3>;

}  // namespace obscura::sim
