// Joints between velocities and places. Equality rows, C(q) = 0, and those of taut ropes act in each stage of
// the integrator that the scene names,
//   v' = a + M^-1 J f            f: J v' + J' v = 0
// which leads from x, v to x_free, v_free (joint_stages.cpp). What iterations with the contacts then change
// is kept on the joints after Rattle (Andersen 1983): with J at the start of a step and J' at its end
//   v*  = v_free + M^-1 (contacts + J l)      l: J v* = J v_free
//   x'  = x_free + h (v* - v_free) / 2 + M^-1 J s   s: C(x') = 0, Newton with the factors at hand
//   v'  = v* + M^-1 (J (s / h - l / 2) + J' (s / h + l / 2) + J' m)     m: J' v' = 0, and motors hold their
//                                                                       speed there
// (joint_projection.cpp), in space with angular momenta for spins, so that a body that turns on in the step
// keeps its own. The free motion has the order of the integrator, all else is of second order, and no joint
// drifts. Beside them rows with bounds, r: a unit of impulse along r makes the joints react by c = -K^-1 J
// M^-1 r, so that the effective mass is
//   m = 1 / (r M^-1 r - r M^-1 J K^-1 J M^-1 r)

#include "sim/solve/iterate/joint_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/math/lie_step.h"

namespace obscura::sim {

namespace {

constexpr int kBoundedRounds =
    16;  // an iteration, of rows with bounds among themselves: they begin from nothing
constexpr double kLocked = 1e-6;  // of a row's own: what it can move once joints have answered
constexpr double kApart = 1e-9;   // 1/s, of the scene's size: slower at a joint is rounding

}  // namespace

template <int D>
JointSolver<D>::JointSolver(const Model<D>& model)
    : model_(model), motors_(model), response_(model), drives_(model) {
  const std::size_t n = model.bodies.size();
  member_.assign(n, 0), component_of_body_.assign(n, -1);
  clear_pushed();
  at_.resize(n), turn_.resize(n), unprojected_.resize(n);
  holds_.resize(model.joints.size()), begun_motors_.resize(model.joints.size()),
      free_motors_.resize(model.joints.size());
  for (Orientation<D>& turn : turn_) turn.setZero();
  for (const Joint<D>& joint : model.joints) {
    joint.each_body([&](int body) {
      if (body >= 0) member_[body] = 1;
    });
    may_break_ = may_break_ || joint.breaks < kEndless || joint.breaks_torque < kEndless;
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
  state.joint_torques.resize(model_.joints.size(), AngularVec<D>::Zero());
}

template <int D>
void JointSolver<D>::gather(const State<D>& state) {
  // pieces of a rope that became one, or two
  bool same = wound_.size() == state.wound.size();
  for (std::size_t i = 0; same && i < wound_.size(); ++i) same = wound_[i].with == state.wound[i].with;
  wound_ = state.wound;
  if (planned_ && same && broken_ == state.broken && frozen_ == state.frozen) return;
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
  held_.clear(), pairs_.clear(), bounded_blocks_.clear(), stops_.clear();
  std::vector<int> sizes;
  std::vector<std::vector<int>> of(model_.bodies.size());  // blocks of each body that moves
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (broken_[i] || !holds_any(i)) continue;
    Row<D> out[kMostHeld<D>];
    double off[kMostHeld<D>];
    each_body_held(joint, wound_of(std::size_t(i)), [&](int body) {
      if (response_.moves(body)) of[body].push_back(int(held_.size()));
    });
    const int block = int(held_.size());
    held_.push_back(i);
    sizes.push_back(rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), out, off, at_));
    if (one_sided(joint)) {
      bounded_blocks_.push_back(block), stops_.push_back({block, upper});
      continue;
    }
    const bool least = joint.lower > -1e299, most = joint.upper < 1e299;
    if (!has_free_row(joint) || !(least || most || joint.motor || joint.friction > 0)) continue;
    bounded_blocks_.push_back(block), ++sizes.back();
    if (joint.motor) stops_.push_back({block, motor});
    if (joint.friction > 0) stops_.push_back({block, friction});
    if (least) stops_.push_back({block, lower});
    if (most) stops_.push_back({block, upper});
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
  reached_.assign(std::size_t(components()), {}), with_ends_.assign(std::size_t(components()), {});
  for (const int block : bounded_blocks_) {
    const Joint<D>& joint = model_.joints[std::size_t(held_[block])];
    if (one_sided(joint) || joint.lower > -1e299 || joint.upper < 1e299)
      with_ends_[std::size_t(factors_.component(block))].push_back(block);
  }
  for (const int i : bodies_) {
    if (component_of_body_[i] >= 0) members_[component_of_body_[i]].push_back(i);
  }
  rows_.resize(factors_.rows()), old_rows_.resize(factors_.rows());
  for (auto* numbers : {&impulses_, &totals_, &rhs_, &shifts_, &end_forces_, &loads_})
    numbers->resize(factors_.rows());
  targets_.assign(std::size_t(factors_.rows()), 0.0);
  acting_.assign(held_.size(), {}), has_bounded_row_.assign(held_.size(), 0);
  for (const int block : bounded_blocks_) has_bounded_row_[std::size_t(block)] = 1;
  loose_.assign(std::size_t(factors_.rows()), 0);
  loosen_all();
  end_loads_.assign(held_.size(), {});
  floating_.assign(std::size_t(components()), 1);
  for (int k = 0; k < int(held_.size()); ++k) {
    const Joint<D>& joint = model_.joints[std::size_t(held_[std::size_t(k)])];
    if (!joint.over.empty() || joint.geared || wound_of(std::size_t(held_[std::size_t(k)])).with > 0 ||
        !response_.moves(joint.a.body) || !response_.moves(joint.b.body))
      floating_[std::size_t(factors_.component(k))] = 0;
  }
}

template <int D>
JointTurn<D> JointSolver<D>::turn_between(const Joint<D>& joint) const {
  const Wound rope = wound_of(std::size_t(&joint - model_.joints.data()));
  const AngularVec<D> turn = sim::turn_between(joint, rope, [&](int body) {
    return body < 0 ? AngularVec<D>(AngularVec<D>::Zero()) : AngularVec<D>(rounds<D>(turn_[body]));
  });
  return {turn, rope};
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

// rows at the present poses, and their factors
template <int D>
void JointSolver<D>::compute_rows() {
  drive_works_.assign(driven_ ? rows_.size() : 0, 0);
  for (int component = 0; component < components(); ++component) compute_rows(component);
}

template <int D>
void JointSolver<D>::compute_rows(int component) {
  double off[kMostHeld<D>];
  const auto each_block = [&](auto&& act) {
    for (int place = factors_.begin(component); place < factors_.end(component); ++place)
      act(factors_.at(place));
  };
  drive_works_.resize(driven_ ? rows_.size() : 0);
  each_block([&](int k) {
    const Joint<D>& joint = model_.joints[held_[k]];
    if (!one_sided(joint))
      rows(joint, side(joint.a.body), side(joint.b.body), turn_between(joint), &rows_[factors_.first(k)], off,
           at_);
    if (has_bounded_row_[std::size_t(k)]) {
      Row<D>& row = rows_[std::size_t(bounded_row(k))];
      row = {};
      if (!loose_[std::size_t(bounded_row(k))]) bounded_row(k, acting_[std::size_t(k)].load, row);
    }
    for (int r = factors_.first(k); driven_ && r < factors_.first(k) + factors_.size(k); ++r)
      drive_works_[std::size_t(r)] = given(rows_[std::size_t(r)]);
  });
  constexpr int kMost = kMostHeld<D>;
  const auto fill = [&](auto& block, int i, int j) {
    for (int r = 0; r < factors_.size(i); ++r) {
      for (int c = 0; c < factors_.size(j); ++c)
        block[r * kMost + c] =
            response_.coupling(rows_[factors_.first(i) + r], rows_[factors_.first(j) + c], at_);
    }
  };
  each_block([&](int k) {
    fill(factors_.diagonal(k), k, k);
    // what is loose stands alone, with a pivot like the others
    if (!has_bounded_row_[std::size_t(k)] || !loose_[std::size_t(bounded_row(k))]) return;
    const int last = factors_.size(k) - 1;
    double pivot = last == 0 ? 1 : 0;
    for (int r = 0; r < last; ++r) pivot = std::max(pivot, factors_.diagonal(k)[r * kMost + r]);
    factors_.diagonal(k)[last * kMost + last] = pivot;
  });
  factors_.each_pair(component, [&](int e) { fill(factors_.entry(e), pairs_[e].first, pairs_[e].second); });
  factors_.factorise(component);
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

// the bounded row of a block at the present poses: of a rope, else along the free coordinate, away from an
// end
template <int D>
void JointSolver<D>::bounded_row(int block, Load load, Row<D>& row) const {
  const Joint<D>& joint = model_.joints[std::size_t(held_[std::size_t(block)])];
  const BodyMotion<D>&a = side(joint.a.body), &b = side(joint.b.body);
  double off[kMostHeld<D>];
  Row<D> out[kMostHeld<D>];
  if (one_sided(joint)) {
    rows(joint, a, b, turn_between(joint), out, off, at_);
  } else {
    free_row(joint, a, b, turn_between(joint), out[0], off[0]);
    if (load == upper) out[0].reverse();
  }
  row = out[0];
}

// how far a joint is from an end of its at the present poses
template <int D>
double JointSolver<D>::left(int number, Load load) const {
  const Joint<D>& joint = model_.joints[std::size_t(number)];
  Row<D> out[kMostHeld<D>];
  double off[kMostHeld<D>];
  const BodyMotion<D>&a = side(joint.a.body), &b = side(joint.b.body);
  if (one_sided(joint)) {
    rows(joint, a, b, turn_between(joint), out, off, at_);
    return off[0];
  }
  free_row(joint, a, b, turn_between(joint), out[0], off[0]);
  return load == lower ? off[0] - joint.lower : joint.upper - off[0];
}

// what errors of that are compared with: a radian, or the size of the scene
template <int D>
double JointSolver<D>::size(int joint) const {
  return equations<D>(model_.joints[std::size_t(joint)].kind).angle ? 1 : model_.scale;
}

// a unit of it as m: a radian as the size of the scene
template <int D>
double JointSolver<D>::in_metres(int joint) const {
  return model_.scale / size(joint);
}

// What gravity can give a joint in a second, m/s or rad/s: of an angle by the longer arm of its two ends.
template <int D>
double JointSolver<D>::fall(int number) const {
  const Joint<D>& joint = model_.joints[std::size_t(number)];
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (!equations<D>(joint.kind).angle) return g;
  const double arm2 = std::max(joint.a.body < 0 ? 0 : joint.a.local.squaredNorm(),
                               joint.b.body < 0 ? 0 : joint.b.local.squaredNorm());
  return arm2 > 0 ? g / std::sqrt(arm2) : g / model_.scale;
}

// rows with bounds, of limits and ropes those that may come to their end in the step
template <int D>
void JointSolver<D>::collect_bounded(double h) {
  active_ = 0;
  const auto add = [&](int i, Load load) {
    const Joint<D>& joint = model_.joints[i];
    if (active_ == bounded_.size()) bounded_.emplace_back();
    Bounded& b = bounded_[active_];
    b.joint = i, b.load = load;
    b.impulse = b.at_end = b.put = 0, b.target = 0, b.put_back = false;

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
    // of what the free motion has given it may take back
    const Hold& hold = holds_[std::size_t(i)];
    const auto component = [&](int body) { return body < 0 ? -1 : component_of_body_[std::size_t(body)]; };
    const int its = std::max(component(joint.a.body), component(joint.b.body));
    const double after = its < 0 || left_.empty() ? h : h * left_[std::size_t(its)],
                 before = after * hold.given[load];
    if (load == lower || load == upper) {
      const double off = left(i, load);
      const double sees = 4 * h * (std::fabs(speed(b.row, at_)) + fall(i) * h) + 1e-3 * size(i);
      if (off > sees) return;
      b.least = -std::max(before, 0.0), b.most = kEndless,
      b.target = -std::max(off, 0.0) / h + hold.bends[load];
    } else {
      const double most = after * (load == motor ? joint.motor->most : joint.friction);
      b.least = -most - before, b.most = most - before;
    }
    if (load == motor) {
      const double aims = motors_.at(i, ends_, offs[0] + h * speed(b.row, at_), speed(b.row, at_)).speed;
      b.target = aims;
      b.ends = kEndless;
      const Coordinate& begun = begun_motors_[std::size_t(i)];
      // not where it has come to its aim within the step
      const double aimed = motors_.at(i, ends_ - h, begun.value, begun.rate).speed;
      if (has_speed(i, begun.rate, aimed, h))
        b.ends = hold.load == motor ? motors_.lead(i, ends_ - h, h, begun.value)
                                    : begun.value + 0.5 * h * (begun.rate + aims);
    }
    if (hold.load == load)
      b.target = hold.target;
    else if (load > upper && hold.knows)
      b.target = hold.aims[load];

    b.begun_drive_work = driven_ ? given(b.row) : 0;
    compute_response(b);
    b.effective_mass = effective_mass(b);
    active_ += b.effective_mass > 0;
  };
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (broken_[i] || !holds_any(i)) continue;
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
double JointSolver<D>::effective_mass(const JointResponse& b) const {
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
void JointSolver<D>::shift_bounded(Bounded& bounded, double by) {
  bounded.put += by;
  shift(bounded.row, by);
  each_row(bounded.components[0], [&](int k, int r) { shift(rows_[r], bounded.answer[0][k] * by); });
}

template <int D>
bool JointSolver<D>::project_initial_velocities(State<D>& state) {
  if (bodies_.empty()) return false;
  gather(state);
  for (const int i : bodies_) {
    at_[i] = sim::body_motion(state, i);
    if (const int k = turning(state, i); k >= 0) turn_[i] = state.turn[k];
  }
  compute_rows();
  double fastest = 0;
  for (const Row<D>& row : rows_)
    fastest = std::max(fastest, std::fabs(speed(row, at_)) * sim::in_metres(row, model_.scale));
  if (fastest <= kApart * model_.scale) return false;
  for (int round = 0; round < 2; ++round) solve_positions();  // the second for the rounding of the first
  for (const int i : bodies_) {
    if (!response_.moves(i)) continue;
    state.v[i] = at_[i].v;
    if (const int k = turning(state, i); k >= 0) state.spin[k] = at_[i].w;
  }
  return true;
}

template <int D>
void JointSolver<D>::begin(double h, double t) {
  ends_ = t + h;
  collect_bounded(h);
  couple_bounded();
  std::fill(impulses_.begin(), impulses_.end(), 0.0), std::fill(totals_.begin(), totals_.end(), 0.0);
  relief_.assign(rows_.size(), 0.0);
  speeds_.resize(active_), changes_.resize(active_);
}

template <int D>
void JointSolver<D>::iterate() {
  for (int component = -1; component < components(); ++component) iterate(component);
}

template <int D>
void JointSolver<D>::iterate(int component, bool last) {
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
  if (last) solve_within(begin, end);
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
void JointSolver<D>::keep(State<D>& state, double h, const std::vector<char>* of) const {
  const auto wanted = [&](int i) {
    bool any = !of && broken_[i] != 0;
    each_body_held(model_.joints[i], wound_of(std::size_t(i)),
                   [&](int body) { any = any || (response_.moves(body) && (!of || (*of)[body] != 0)); });
    return any;
  };
  const auto add = [&](int i, const Wrench<D>& load) {
    state.joint_forces[std::size_t(i)] += load.f, state.joint_torques[std::size_t(i)] += load.n;
  };
  for (int i = 0; i < int(model_.joints.size()); ++i) {
    if (!wanted(i)) continue;
    state.joint_forces[i].setZero(), state.joint_torques[i].setZero();
    const Joint<D>& joint = model_.joints[i];
    if (joint.coil && !broken_[i])
      add(i, coil_load(joint, side(joint.a.body), side(joint.b.body), turn_between(joint)));
  }
  for (int k = 0; k < int(held_.size()); ++k) {
    if (!wanted(held_[k])) continue;
    if (!of) add(held_[k], end_loads_[k]);
    for (int r = factors_.first(k); r < factors_.first(k) + factors_.size(k); ++r)
      add(held_[k], load(held_[k], rows_[r]) * (impulses_[r] / h + relief_[std::size_t(r)]));
  }
  for (std::size_t k = 0; k < active_; ++k) {
    const Bounded& b = bounded_[k];
    if (wanted(b.joint)) add(b.joint, load(b.joint, b.row) * ((b.impulse - b.at_end) / h));
  }
}

template <int D>
bool JointSolver<D>::break_joints(State<D>& state) const {
  bool any = false;
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    if (state.broken[i] || !overloaded(model_.joints[i], {state.joint_torques[i], state.joint_forces[i]}))
      continue;
    state.broken[i] = 1, any = true;
  }
  if (any) break_dependents(model_, state.broken);
  return any;
}

template class JointSolver<2>;
template class JointSolver<3>;

}  // namespace obscura::sim
