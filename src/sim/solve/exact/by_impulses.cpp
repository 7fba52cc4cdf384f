// The rest of a step at once, where events are too many or no forces are found: impulses over a piece of it,
//   J v' >= 0 of what touches,    g + h J (v + v') / 2 >= 0 of what comes down slowly,
//   x' = x + h v'    of what nothing holds, else    x' = x + h (v + v') / 2
// of the first order. Bodies that have come into each other are pushed apart after it.

#include "sim/solve/exact/exact.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kCreep = 1e-6;   // of sqrt(g L)
constexpr double kBarely = 0.05;  // of what gravity gives in the piece

}  // namespace

// whether no row at hand holds bodies to what does not move, and none of them is a link
template <int D>
bool ExactSolver<D>::floats() const {
  const auto moves = [&](int body) { return body >= 0 && response_.moves(body); };
  const auto is_free = [&](const Row<D>& row) {
    return moves(row.a) && moves(row.b) &&
           std::all_of(row.more.begin(), row.more.end(),
                       [&](const RowSide<D>& side) { return moves(side.body); });
  };
  return active_.subset.chains.empty() &&
         std::all_of(constraints_.begin(), constraints_.end(), [&](const Constraint& one) {
           return (one.kind == Constraint::Kind::contact && one.off > limits_.touching_gap) ||
                  std::all_of(rows_.begin() + one.first, rows_.begin() + one.first + one.rows, is_free);
         });
}

// What bears at the end of a piece has come to lie there: the velocities that the piece began with,
// interval_.begun, become those that bring it there with the new ones, in the mean. What bounced and has come
// back would else be lifted by half of that, to fall and bounce anew in each step, and what has landed would
// lie too deep.
template <int D>
void ExactSolver<D>::land(State<D>& state, double h) {
  using Kind = typename Constraint::Kind;
  const auto bears = [&](const Constraint& one) { return one.kind == Kind::contact && f_[one.first] > 0; };
  const auto lands = [&](const Constraint& one) {
    return bears(one) && (one.began > still_speed_ || one.off > limits_.touching_gap);
  };
  if (std::none_of(constraints_.begin(), constraints_.end(), lands)) return;
  const Eigen::VectorXd impulses = f_;
  scratch_.chosen.clear();
  b_.setZero(Eigen::Index(rows_.size()));
  for (const Constraint& one : constraints_) {
    const int held = bears(one) ? 1 : one.kind == Kind::joint ? one.rows : 0;
    for (int row = one.first; row < one.first + held; ++row) scratch_.chosen.push_back(row);
    if (lands(one)) b_[one.first] = -2 * std::max(one.off, 0.0) / h - row_velocity(one.first) - one.began;
  }
  save(state, scratch_.put);
  restore(interval_.begun, state);
  update_poses(state);
  solve_least_norm();
  apply_impulses(state, false);
  save(state, interval_.begun);
  restore(scratch_.put, state);
  update_poses(state);
  f_ = impulses;
}

// the rest of a step at once: impulses instead of forces, so that nothing that touches comes closer at its
// end
template <int D>
void ExactSolver<D>::step_by_impulses(State<D>& state, double t, double h) {
  pose_driven(t);
  // also what comes down within it, slowly: that is no impact
  const double reach = std::max(limits_.touching_gap, 2 * h * kComing * limits_.rest_speed);
  // asleep they would be walls, also to what is still and is struck in this piece
  find_contacts_awake(state, reach, true);
  update_poses(state);
  collect_constraints(state, 1e300, reach);
  save(state, interval_.begun);
  build_blocks(true, h);
  find_islands();
  const auto rate = dynamics_.accelerations(state, t);
  predict_velocities(rate, h);
  // Where nothing holds them by the new velocities, symplectic: what forces at the old places give is no
  // angular momentum. Else by the mean, by which heaps come to rest on what stands.
  const double mean = floats() ? 0 : 0.5;
  for (Constraint& constraint : constraints_) {
    constraint.began = row_velocity(constraint.first);
    if (constraint.kind == Constraint::Kind::contact && constraint.off > limits_.touching_gap)
      b_[constraint.first] += std::max(0.0, (constraint.off / h + mean * constraint.began) / (1 - mean));
  }
  // Start from the forces of the step before only if nearly all is at rest: with them the iterations would go
  // on holding bodies that have begun to fall.
  double fastest = 0;
  for (int i = 0; i < int(rows_.size()); ++i)
    fastest = std::max(fastest, in_metres(i, std::abs(row_velocity(i))));
  const auto& members = dynamics_.bodies();
  for (std::size_t i = 0; i < members.size(); ++i) {
    const int body = members[i];
    state.v[body] += h * Eigen::Map<const Vec<D>>(rate.data() + D * i);
    if (const int at = dynamics_.spin_start(int(i)); at >= 0)
      state.spin[turning(state, body)] +=
          h * to_room<D>(poses_[body].room_from_body, Eigen::Map<const AngularVec<D>>(rate.data() + at));
  }
  Articulated<D>& chains = dynamics_.chains();
  scratch_.chain_change.assign(rate.begin() + dynamics_.chain_start(),
                               rate.begin() + dynamics_.chain_start() + chains.size());
  for (double& change : scratch_.chain_change) change *= h;
  chains.jump(state, scratch_.chain_change, false);
  const double creeps =
      std::max(kCreep * limits_.unit_speed, kBarely * h * std::sqrt(model_.gravity.squaredNorm()));
  warm_start_rows(fastest < creeps ? h : 0);
  if (!solve()) solve_roughly();
  for (int i = 0; i < kMostRubs && rub(i); ++i)
    if (!solve()) solve_roughly();
  apply_impulses(state, false);
  for (int i = 0; i < int(rows_.size()); ++i) progress_.given += f_[i] * given(i);
  update_poses(state);
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::motor)
      progress_.given += 0.5 * f_[constraint.first] * (constraint.began + row_velocity(constraint.first));
  }
  if (mean > 0) land(state, h);
  for (const int body : members) {
    state.x[body] += h * (state.v[body] + mean * (interval_.begun.v[body] - state.v[body]));
    if (const int k = turning(state, body); k >= 0)
      state.turn[k] =
          turned<D>(interval_.begun.turn[k],
                    AngularVec<D>(h * (state.spin[k] + mean * (interval_.begun.spin[k] - state.spin[k]))));
  }
  chains.advance(interval_.begun.chain_states, h, state);
  for (const Constraint& constraint : constraints_) {
    if (!course_ || constraint.kind != Constraint::Kind::contact || f_[constraint.first] == 0) continue;
    const ContactKey& key = candidates_[constraint.of].key;
    if (course_->watches(key.a) || course_->watches(key.b))
      course_->meetings.push_back({key.a, key.b, stepped_, stepped_ + h});
  }
  f_ /= h;
  record_forces(state);

  // push apart bodies that overlap now and did not before
  pose_driven(t + h);
  find_contacts_awake(state, limits_.touching_gap, true);
  collect_constraints(state);
  build_blocks(true);
  find_islands();
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact && constraint.off >= -limits_.touching_gap)
      modes_[constraint.block].kind = ModeKind::open;
    if (constraint.kind == Constraint::Kind::contact && constraint.off < -limits_.touching_gap)
      modes_[constraint.block].kind = ModeKind::slide;
    if (constraint.kind == Constraint::Kind::motor || constraint.kind == Constraint::Kind::friction)
      modes_[constraint.block].kind = ModeKind::at_lower;
    if (constraint.kind == Constraint::Kind::rope || constraint.kind == Constraint::Kind::lower ||
        constraint.kind == Constraint::Kind::upper)
      modes_[constraint.block].kind =
          constraint.off < -limits_.touching_gap ? ModeKind::free : ModeKind::at_lower;
  }
  project_state(state, h, true);
}

template bool ExactSolver<2>::floats() const;
template bool ExactSolver<3>::floats() const;
template void ExactSolver<2>::step_by_impulses(State<2>&, double, double);
template void ExactSolver<3>::step_by_impulses(State<3>&, double, double);

}  // namespace obscura::sim
