// The free motion of bodies on joints: in each stage of the integrator that the scene names,
//   v' = a + M^-1 J f            f: J v' + J' v = 0
// of what joints hold and of taut ropes. A rope that would push goes slack, and the step is taken again.

#include "sim/solve/iterate/joint_solver.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

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
    last_loads_[k] = {};
    const int first = factors_.first(int(k));
    for (int r = first; r < first + factors_.size(int(k)); ++r)
      last_loads_[k] += load(held_[k], rows_[std::size_t(r)]) * rhs_[std::size_t(r)];
  }
  for (const int k : ropes_) {
    if (taut_[std::size_t(k)])
      least_force_[std::size_t(k)] =
          std::min(least_force_[std::size_t(k)], rhs_[std::size_t(factors_.first(k))]);
  }
  if (first_stage_) first_loads_ = last_loads_;
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

#define OBSCURA_INSTANTIATE(D)                                                                             \
  template void JointSolver<D>::step(ForwardDynamics<D>&, Integrate*, State<D>&, double, double, Stages&); \
  template void JointSolver<D>::set_poses(const State<D>&);                                                \
  template void JointSolver<D>::find_taut_ropes(double);                                                   \
  template bool JointSolver<D>::slacken_ropes();                                                           \
  template void JointSolver<D>::save(const State<D>&);                                                     \
  template void JointSolver<D>::restore(State<D>&) const;                                                  \
  template void JointSolver<D>::begin_motors();                                                            \
  template double JointSolver<D>::row_acceleration(const Row<D>&, std::span<const double>) const;          \
  template void JointSolver<D>::rates(double, std::span<const double>, std::span<const double>,            \
                                      std::span<double>, std::span<double>);                               \
  template void JointSolver<D>::keep_row_speeds()
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
