// Constraint forces and impulses at one instant.
//   K f + b = w,   K = J M^-1 J',   b = J a + J' v        forces, w the rows' accelerations
//                                   b = J v (+ e v_n)     impulses, w the rows' velocities after them
// with the laws of sim/solve/cone/cone.h for f and w.
// Source: Baraff, Fast contact force computation for nonpenetrating rigid bodies (1994).

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/pulley.h"
#include "sim/energy/energy.h"
#include "sim/math/lie_step.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kLeastPart = 1e-3;  // of the way back to where joints belong
constexpr double kNowhere = 1e-6;    // of the room: a way that is none, of what is on its way back
constexpr double kCarried = 1e-3;    // of what a motor may do in an interval: an error of the scheme
constexpr double kJam = 100;  // times what all bodies weigh and are pulled by: a stack's floor bears it once

}  // namespace

template <int D>
void ExactSolver<D>::update_poses(const State<D>& state) {
  for (const int body : active_.subset.bodies) poses_[body] = body_motion(state, body);
  dynamics_.chains().stand(state);
}

// bodies that are moved, at time t
template <int D>
void ExactSolver<D>::pose_driven(double t) {
  now_ = t;
  for (int i = 0; i < drives_.size(); ++i) {
    driven_[std::size_t(i)] = drives_.at(i, t);
    poses_[std::size_t(drives_.body(i))] = driven_[std::size_t(i)].at;
  }
}

// how a body stands now: one that is moved as pose_driven() saw it last
template <int D>
BodyMotion<D> ExactSolver<D>::end_pose(const State<D>& state, int body) const {
  const int drive = drives_.number(body);
  return drive < 0 ? body_motion(state, body) : driven_[std::size_t(drive)].at;
}

template <int D>
AngularVec<D> ExactSolver<D>::rounds_of(const State<D>& state, int body) const {
  const int k = body < 0 ? -1 : turning(state, body);
  if (k < 0) return AngularVec<D>::Zero();
  const int drive = drives_.number(body);
  return rounds<D>(drive < 0 ? state.turn[k] : driven_[std::size_t(drive)].turn);
}

template <int D>
JointTurn<D> ExactSolver<D>::turn_between(const State<D>& state, const Joint<D>& joint) const {
  const Wound rope = wound(state, std::size_t(&joint - model_.joints.data()));
  return {sim::turn_between(joint, rope, [&](int body) { return rounds_of(state, body); }), rope};
}

// the turn that the rows of a constraint are of; a contact's have none
template <int D>
JointTurn<D> ExactSolver<D>::turn_of(const State<D>& state, const Constraint& constraint) const {
  if (constraint.kind == Constraint::Kind::contact) return AngularVec<D>::Zero();
  return turn_between(state, model_.joints[constraint.of]);
}

// what bodies that are moved, and belts, give by a unit of force along a row, W; of impulse, J
template <int D>
double ExactSolver<D>::given(int number) const {
  const Row<D>& row = rows_[number];
  double sum = row.drift;
  if (drives_.number(row.a) >= 0) sum += row.along.dot(poses_[row.a].v) + row.angular_a.dot(poses_[row.a].w);
  if (drives_.number(row.b) >= 0) sum -= row.along.dot(poses_[row.b].v) + row.angular_b.dot(poses_[row.b].w);
  for (const RowSide<D>& side : row.more) {
    if (drives_.number(side.body) >= 0)
      sum += side.along.dot(poses_[side.body].v) + side.angular.dot(poses_[side.body].w);
  }
  return -sum;
}

template <int D>
typename Motors<D>::Aim ExactSolver<D>::aim(const Constraint& constraint) {
  if (constraint.kind != Constraint::Kind::motor) return {};
  double speed = 0;
  if (motors_.follows(constraint.of)) speed = row_velocity(constraint.first);
  return motors_.at(constraint.of, now_, constraint.off, speed);
}

// the rows of what is held, at the stances at hand
template <int D>
void ExactSolver<D>::build_jacobian(Constraint& constraint, const JointTurn<D>& between) {
  static const BodyMotion<D> room;
  constraint.first = int(rows_.size());
  const auto at = [&](int body) -> const BodyMotion<D>& { return body < 0 ? room : poses_[body]; };
  Row<D> out[kMostHeld<D>];
  if (constraint.kind == Constraint::Kind::contact) {
    const ContactCandidate<D>& gap = candidates_[constraint.of];
    const EvaluatedContact<D> now = sim::rows(gap, at(gap.key.a), at(gap.key.b), out);
    if (belts_) add_belts(model_, gap.key, poses_, out);
    constraint.off = now.value, constraint.point = now.point, constraint.normal = now.normal;
    constraint.rows = D;
  } else {
    const Joint<D>& joint = model_.joints[constraint.of];
    const BodyMotion<D>&a = at(joint.a.body), &b = at(joint.b.body);
    const JointTurn<D> turn = joint.kind == JointKind::wire ? wire_pose(constraint.of) : between;
    if (constraint.kind == Constraint::Kind::joint || constraint.kind == Constraint::Kind::rope) {
      constraint.rows = sim::rows(joint, a, b, turn, out, constraint.offs, poses_);
      constraint.off = constraint.offs[0];
    } else if (rubs(joint)) {
      constraint.grip = hold_drag<D>({joint, a, b, turn.between, poses_, turn.wound}, out[0]);
      constraint.rows = 1;
    } else {
      double way = 0;
      free_row(joint, a, b, turn, out[0], way);
      constraint.rows = 1;
      if (constraint.kind == Constraint::Kind::motor) constraint.off = way;
      if (constraint.kind == Constraint::Kind::lower) constraint.off = way - joint.lower;
      if (constraint.kind == Constraint::Kind::upper) {
        constraint.off = joint.upper - way;
        out[0].reverse();
      }
    }
  }
  rows_.insert(rows_.end(), out, out + constraint.rows);
}

template <int D>
double ExactSolver<D>::row_velocity(int row) const {
  return speed(rows_[row], poses_);
}

// collects the constraints of this state, without one-sided ones that separate faster than `fastest`, but for
// those of returning_. Of what it leaves out, leaving_ has what separates slower than the resting speed. With
// `reach` also contacts with wider gaps, of at most so many m, that close slowly; with `near_ends` also
// limits and ropes that are so far from their ends.
template <int D>
void ExactSolver<D>::collect_constraints(const State<D>& state, double fastest, double reach,
                                         double near_ends) {
  using Kind = typename Constraint::Kind;
  constraints_.clear(), rows_.clear(), leaving_.clear();
  const auto returns = [&](const Constraint& constraint) {
    return std::any_of(returning_.begin(), returning_.end(), [&](const Constraint& it) {
      return it.kind == constraint.kind && it.of == constraint.of;
    });
  };
  const auto add = [&](Kind kind, int of, const JointTurn<D>& turn, bool one_sided) {
    Constraint constraint{};
    constraint.kind = kind, constraint.of = of, constraint.rope = turn.wound;
    build_jacobian(constraint, turn);
    const double speed = one_sided ? in_metres(constraint.first, row_velocity(constraint.first)) : 0;
    const bool comes = kind == Kind::contact && speed > -kComing * limits_.rest_speed;
    const double farther = kind != Kind::contact ? near_ends : comes ? reach : 0;
    const bool apart =
        one_sided && in_metres(constraint.first, constraint.off) > std::max(farther, limits_.touching_gap);
    if (!apart && (speed <= fastest || returns(constraint))) {
      constraints_.push_back(constraint);
      return;
    }
    if (!apart && speed <= progress_.rest_speed) leaving_.push_back(constraint);
    rows_.resize(constraint.first);
  };
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (!holds_any(state, i)) continue;
    const JointTurn<D> turn = turn_between(state, joint);
    if (!joint.linked) add(one_sided(joint) ? Kind::rope : Kind::joint, i, turn, one_sided(joint));
    if (rubs(joint, turn.wound) && !constraints_.empty() && constraints_.back().kind == Kind::rope &&
        constraints_.back().of == i)
      add(Kind::friction, i, turn, false);
    if (!has_free_row(joint)) continue;
    if (joint.lower > -1e299) add(Kind::lower, i, turn, true);
    if (joint.upper < 1e299) add(Kind::upper, i, turn, true);
    if (joint.motor) add(Kind::motor, i, turn, false);
    if (joint.friction > 0) add(Kind::friction, i, turn, false);
  }
  for (int i = 0; i < int(candidates_.size()); ++i) add(Kind::contact, i, AngularVec<D>::Zero(), true);
  chain_response_.build(rows_, response_, dynamics_.chains());
}

// the rows of constraints_ at the poses of a state
template <int D>
void ExactSolver<D>::rebuild_rows(const State<D>& state) {
  update_poses(state);
  rows_.clear();
  for (Constraint& constraint : constraints_) build_jacobian(constraint, turn_of(state, constraint));
  chain_response_.build(rows_, response_, dynamics_.chains());
}

// Builds the blocks of the constraints at the present poses: of forces; or of impulses, in which motors and
// friction in joints have a share by how long they last (s), so in blows none.
template <int D>
void ExactSolver<D>::build_blocks(bool impulses, double last) {
  using Kind = typename Constraint::Kind;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  blocks_.clear();
  for (Constraint& constraint : constraints_) {
    constraint.block = int(blocks_.size());
    ConeBlock<D> block;
    switch (constraint.kind) {
      case Kind::contact: {
        Tangent<D> slip;
        for (int i = 0; i < D - 1; ++i) slip[i] = row_velocity(constraint.first + 1 + i);
        const double fast = std::sqrt(slip.squaredNorm());
        if (!impulses && fast > still_speed_) block.sliding = true, block.direction = slip / fast;
        const Material its = material(candidates_[constraint.of].key);
        block.mu = impulses || block.sliding ? its.friction : its.static_friction;
        blocks_.push_back(block);
        break;
      }
      case Kind::joint:
        block.law = Law::equal;
        for (int i = 0; i < constraint.rows; ++i) blocks_.push_back(block);
        break;
      case Kind::rope:
      case Kind::lower:
      case Kind::upper:
        block.law = Law::bounded, block.lower = 0, block.upper = kEndless;
        blocks_.push_back(block);
        break;
      case Kind::motor:
      case Kind::friction: {
        const Joint<D>& joint = model_.joints[constraint.of];
        const bool wire = joint.kind == JointKind::wire, by_load = wire || rubs(joint);
        // that of a wire or a rope goes by its load, see rub(); of blows on a wire there is none
        if (wire) constraint.grip = impulses && last == 0 ? 0 : joint.friction;
        const double most = by_load ? 0 : constraint.kind == Kind::motor ? joint.motor->most : joint.friction;
        const double slip =
            in_metres(constraint.first, row_velocity(constraint.first) -
                                            (constraint.kind == Kind::motor ? aim(constraint).speed : 0));
        block.law = Law::bounded, block.upper = impulses ? last * most : most, block.lower = -block.upper;
        constraint.rubs = !by_load || impulses ? 0 : slip > still_speed_ ? 1 : slip < -still_speed_ ? -1 : 0;
        if (impulses) {
          // whatever slips: it may come to an end
        } else if (slip > still_speed_) {
          block.upper = -most;
        } else if (slip < -still_speed_) {
          block.lower = most;
        }
        blocks_.push_back(block);
        break;
      }
    }
  }
  modes_.assign(blocks_.size(), {});
}

// J a: the acceleration of each row, from accelerations in the order of dynamics_
template <int D>
double ExactSolver<D>::row_acceleration(int number, std::span<const double> rate) const {
  const Row<D>& row = rows_[number];
  double sum = 0;
  const auto side = [&](int body, const AngularVec<D>& turn, double sign, const Vec<D>& along) {
    if (const int drive = drives_.number(body); drive >= 0) {
      const DrivenMotion<D>& its = driven_[std::size_t(drive)];
      sum += sign * (along.dot(its.a) + turn.dot(its.alpha));
    }
    const int place = response_.free(body) ? dynamics_.place(body) : -1;
    if (place < 0) return;
    sum += sign * along.dot(Eigen::Map<const Vec<D>>(rate.data() + D * place));
    if (const int at = dynamics_.spin_start(place); at >= 0)
      sum += sign * turn.dot(to_room<D>(poses_[body].room_from_body,
                                        Eigen::Map<const AngularVec<D>>(rate.data() + at)));
  };
  side(row.a, row.angular_a, 1, row.along), side(row.b, row.angular_b, -1, row.along);
  for (const RowSide<D>& more : row.more) side(more.body, more.angular, 1, more.along);
  if (!chain_response_.moves(number)) return sum;
  const auto J = chain_response_.jacobian(number);
  for (std::size_t i = 0; i < J.size(); ++i) sum += J[i] * rate[std::size_t(dynamics_.chain_start()) + i];
  return sum;
}

// M^-1 J' f, onto accelerations in the order of dynamics_
template <int D>
void ExactSolver<D>::add_accelerations(int number, double f, std::span<double> rate) const {
  const auto side = [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double force) {
    const int place = dynamics_.place(body);
    if (place < 0) return;
    Eigen::Map<Vec<D>>(rate.data() + D * place) += dv;
    if (const int at = dynamics_.spin_start(place); at >= 0)
      Eigen::Map<AngularVec<D>>(rate.data() + at) += force * from_room<D>(poses_[body].room_from_body, spin);
  };
  if (f == 0) return;
  each_response(rows_[number], response_.of(rows_[number], poses_), f, side);
  if (!chain_response_.moves(number)) return;
  const auto U = chain_response_.response(number);
  for (std::size_t i = 0; i < U.size(); ++i) rate[std::size_t(dynamics_.chain_start()) + i] += f * U[i];
}

// M^-1 J' p onto the velocities of the free bodies of a state, or onto their places and scratch_.turns
template <int D>
void ExactSolver<D>::apply_impulses(State<D>& state, const Row<D>& row, double p, bool places) {
  const auto side = [&](int body, const Vec<D>& dv, const AngularVec<D>& spin, double impulse) {
    (places ? state.x : state.v)[body] += dv;
    const int k = turning(state, body);
    if (k < 0) return;
    const AngularVec<D> by = impulse * spin;
    (places ? scratch_.turns[body] : state.spin[k]) += by;
  };
  if (p == 0) return;
  each_response(row, response_.of(row, poses_), p, side);
}

// takes the last modes and forces of contacts as the first guess; for impulses the forces times `h`
template <int D>
void ExactSolver<D>::warm_start_rows(double h) {
  warm_.setZero(Eigen::Index(rows_.size()));
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact) continue;
    const ContactKey& key = candidates_[constraint.of].key;
    const Contact<D>* known = find_contact<D>(*progress_.known, key);
    if (!known) continue;
    for (int i = 0; i < D; ++i)
      warm_[constraint.first + i] = h * known->force.dot(rows_[constraint.first + i].along);
    ConeMode<D>& mode = modes_[constraint.block];
    if (known->touching == ContactMode::open) mode.kind = ModeKind::open;
    if (known->touching != ContactMode::slide && known->touching != ContactMode::at_friction_limit) continue;
    Tangent<D> drag;
    for (int i = 0; i < D - 1; ++i) drag[i] = h * known->force.dot(rows_[constraint.first + 1 + i].along);
    const double size = std::sqrt(drag.squaredNorm());
    if (size > 0) mode.kind = ModeKind::slide, mode.along = -drag / size;
  }
}

// gives what the laws let slip from here on the friction of what slips; true if that is less
template <int D>
bool ExactSolver<D>::begin_to_slip() {
  bool any = false;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact || modes_[constraint.block].kind != ModeKind::slide)
      continue;
    any = any || grips(constraint);
    blocks_[constraint.block].mu = material(candidates_[constraint.of].key).friction;
  }
  return any;
}

// forces and modes under the laws of the blocks, where the bodies have accelerations `rate` without them
template <int D>
bool ExactSolver<D>::solve_laws(std::span<const double> rate) {
  for (int i = 0; i < int(rows_.size()); ++i) b_[i] = row_acceleration(i, rate) + rows_[i].velocity_product;
  for (const Constraint& constraint : constraints_) b_[constraint.first] -= aim(constraint).rate;
  warm_start_rows(1);
  bool found = solve();
  for (std::size_t i = 0; found && i < constraints_.size() && begin_to_slip(); ++i) found = solve();
  for (int i = 0; i < kMostRubs && rub(i); ++i) found = solve();
  // what can give one force only slips on, also where its acceleration happens to be zero
  for (std::size_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].law == Law::bounded && blocks_[i].lower == blocks_[i].upper &&
        modes_[i].kind == ModeKind::free)
      modes_[i].kind = ModeKind::at_lower;
  }
  return found;
}

// b_: how fast each row goes after h, next to its aim there, by accelerations `rate` without forces of rows
template <int D>
void ExactSolver<D>::predict_velocities(std::span<const double> rate, double h) {
  b_.resize(Eigen::Index(rows_.size()));
  for (int i = 0; i < int(rows_.size()); ++i)
    b_[i] = row_velocity(i) + h * (row_acceleration(i, rate) + rows_[i].velocity_product);
  for (const Constraint& constraint : constraints_) {
    const typename Motors<D>::Aim its = aim(constraint);
    b_[constraint.first] -= its.speed + h * its.rate;
  }
}

// Collects also what separates slower than the resting speed and would be back soon, or from next to nowhere:
// where the forces of all else close a row again, w < 0, it is held if its velocity v is at most
// -w (rest_speed / g), or its way v^2 / -2w at most kNowhere of the room. What they do not close, or as
// slowly as the far corner of a slim block that rocks, is on its way.
template <int D>
void ExactSolver<D>::collect_returning(const State<D>& state, double t) {
  const auto unheld = dynamics_.accelerations(state, t);
  scratch_.rate.assign(unheld.begin(), unheld.end());
  if (!constraints_.empty()) {
    build_blocks(false);
    find_islands();
    b_.resize(Eigen::Index(rows_.size()));
    solve_laws(scratch_.rate);
    for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], scratch_.rate);
  }
  for (Constraint& constraint : leaving_) build_jacobian(constraint, turn_of(state, constraint));
  chain_response_.build(rows_, response_, dynamics_.chains());
  const double soon = progress_.rest_speed * model_.scale / (limits_.unit_speed * limits_.unit_speed);
  for (const Constraint& constraint : leaving_) {
    const int row = constraint.first;
    const double w = in_metres(row, row_acceleration(row, scratch_.rate) + rows_[row].velocity_product);
    const double v = in_metres(row, row_velocity(row));
    if (v <= -w * soon || v * v <= -2 * w * kNowhere * model_.scale) returning_.push_back(constraint);
  }
  collect_constraints(state, limits_.least_speed);
  returning_.clear();
}

// the forces of this instant, and what each contact does. False where there are none.
template <int D>
bool ExactSolver<D>::solve_modes(State<D>& state, double t) {
  update_poses(state), pose_driven(t);
  collect_constraints(state, limits_.least_speed);
  if (!leaving_.empty()) collect_returning(state, t);
  build_blocks(false);
  if (constraints_.empty()) return true;
  find_islands();
  b_.resize(Eigen::Index(rows_.size()));
  const bool found = solve_laws(dynamics_.accelerations(state, t));
  // hold contacts that separate now, but that the forces without them would close again at once
  for (const Constraint& constraint : constraints_) {
    if (progress_.forced.empty() || constraint.kind != Constraint::Kind::contact) continue;
    const ContactKey& key = candidates_[constraint.of].key;
    ConeMode<D>& mode = modes_[constraint.block];
    if (mode.kind != ModeKind::open || std::find(progress_.forced.begin(), progress_.forced.end(),
                                                 std::pair(key.a, key.b)) == progress_.forced.end())
      continue;
    const ConeBlock<D>& block = blocks_[constraint.block];
    mode.kind = ModeKind::slide, mode.along = block.sliding ? block.direction : Tangent<D>::Zero();
  }
  return found;
}

// what all bodies at hand weigh and their rows are pulled by, N
template <int D>
double ExactSolver<D>::loads() const {
  const double g = std::sqrt(model_.gravity.squaredNorm());
  double sum = 0;
  for (const int body : active_.subset.bodies)
    sum += response_.moves(body) ? g / response_.inverse_mass(body) : 0;
  for (int i = 0; i < int(rows_.size()); ++i) {
    if (const double k = self_coupling(i); k > 0) sum += in_newtons(i, std::fabs(b_[i]) / k);
  }
  return sum;
}

// Whether a sliding contact jams (Painleve): its normal force is kJam times all loads together. Near the
// angle at which it locks, forces grow without bound and would throw bodies away. The rest is left to an
// impact.
template <int D>
bool ExactSolver<D>::jammed() const {
  double most = 0;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact || modes_[constraint.block].kind != ModeKind::slide)
      continue;
    most = std::max(most, f_[constraint.first]);
  }
  return most > 0 && most > kJam * loads();
}

// whether a constraint in such a mode is held
template <int D>
bool ExactSolver<D>::holds(const Constraint& constraint, ModeKind kind) {
  switch (constraint.kind) {
    case Constraint::Kind::joint:
      return true;
    case Constraint::Kind::contact:
      return kind != ModeKind::open;
    default:
      return kind == ModeKind::free;
  }
}

// Bodies that are lifted out of an overlap: the energy of their height is the work of pushing them out. By
// approximate forces they overlap farther, and pay it by their spin and by what they move up or down, as far
// as that is enough; what goes along the ground goes on.
template <int D>
void ExactSolver<D>::pay_for_lift(State<D>& state) {
  const double g = std::sqrt(model_.gravity.squaredNorm());
  if (g == 0) return;
  const Vec<D> down = model_.gravity / g;
  if (corrections_.empty()) corrections_.assign(model_.bodies.size(), Vec<D>::Zero());
  const auto lifted = [&](int body) {
    return -model_.bodies[body].mass * model_.gravity.dot(state.x[body] - scratch_.placed[body]);
  };
  const auto left = [](double more, double has) { return std::sqrt(std::max(0.0, 1 - more / has)); };
  for (const int body : dynamics_.bodies()) {
    const double more = lifted(body);
    if (more <= 0) continue;
    const double m = model_.bodies[body].mass, falls = down.dot(state.v[body]);
    const Vec<D> along = state.v[body] - falls * down;
    const double has = std::max(0.0, kinetic(model_, state, body) - 0.5 * m * along.squaredNorm());
    const double pays = progress_.rough ? std::min(more, has) : 0;
    if (pays > 0) {
      state.v[body] = along + left(pays, has) * falls * down;
      if (const int k = turning(state, body); k >= 0) state.spin[k] *= left(pays, has);
    }
    corrections_[body] -= (more - pays) / (m * g) * down;
  }
  for (const int i : active_.subset.chains) {
    double more = 0, has = 0;
    for (const int body : model_.chains[i].bodies) more += lifted(body), has += kinetic(model_, state, body);
    if (more <= 0 || has <= 0) continue;
    for (double& v : state.chain_states[i].v) v *= left(more, has);
  }
  if (!active_.subset.chains.empty()) dynamics_.chains().follow(state);
}

// Puts what is held back to where it belongs: places first, then velocities, after an interval of h s.
// `impacts_follow`: contacts that approach as in an impact keep their velocities, for the impact to come. So
// do motors whose aim has jumped, or been bent, by more than they can follow: they are no longer at it.
template <int D>
void ExactSolver<D>::project_state(State<D>& state, double h, bool impacts_follow) {
  using Kind = typename Constraint::Kind;
  // how far they are off, at most; into b_ what would bring each row back
  const auto astray = [&] {
    rebuild_rows(state);
    scratch_.chosen.clear();
    double worst = 0;
    b_.setZero(rows_.size());
    for (const Constraint& constraint : constraints_) {
      if (!active(constraint) || constraint.kind == Kind::motor || constraint.kind == Kind::friction)
        continue;
      for (int i = 0; i < (constraint.kind == Kind::contact ? 1 : constraint.rows); ++i) {
        scratch_.chosen.push_back(constraint.first + i);
        b_[constraint.first + i] = -(constraint.kind == Kind::joint ? constraint.offs[i] : constraint.off);
        worst = std::max(worst, in_metres(constraint.first + i, std::abs(b_[constraint.first + i])));
      }
    }
    return worst;
  };
  scratch_.placed.resize(state.x.size());
  for (const int body : active_.subset.bodies) scratch_.placed[body] = state.x[body];
  double moved = 0, worst = astray();
  for (int round = 0; round < 3 && worst > 1e-14 * model_.scale; ++round) {
    moved = std::max(moved, worst);
    solve_least_norm();
    if (worst <= 1e-9 * model_.scale) {
      apply_impulses(state, true);
      break;
    }
    // rows that turn far, or hardly move what they hold, lead astray: no farther than it helps
    save(state, scratch_.put);
    scratch_.ways = f_;
    double left = worst;
    for (double part = 1; part > kLeastPart; part /= 2) {
      f_ = part * scratch_.ways;
      apply_impulses(state, true);
      left = astray();
      if (left <= worst) break;
      restore(scratch_.put, state);
      rebuild_rows(state);
    }
    if (left > worst) break;
    worst = left;
  }
  if (moved > limits_.touching_gap) pay_for_lift(state);

  rebuild_rows(state);
  // what has jumped strikes what it holds or bears: an impact
  if (progress_.jumps) return;
  scratch_.chosen.clear();
  worst = 0;
  b_.setZero(rows_.size());
  for (const Constraint& constraint : constraints_) {
    if (!active(constraint)) continue;
    const ModeKind kind = modes_[constraint.block].kind;
    if (impacts_follow && constraint.kind == Kind::contact &&
        row_velocity(constraint.first) < -progress_.rest_speed)
      continue;
    // what nothing rubs may have no slip yet, and gets one as soon as it is pushed
    const bool slips = kind == ModeKind::slide || (kind == ModeKind::at_friction_limit &&
                                                   blocks_[std::size_t(constraint.block)].mu == 0);
    const int n = constraint.kind != Kind::contact ? constraint.rows : slips ? 1 : D;
    for (int i = 0; i < n; ++i) {
      const int row = constraint.first + i;
      const double off = aim(constraint).speed - row_velocity(row);
      if (constraint.kind == Kind::motor) {
        const double carried = kCarried * h * model_.joints[constraint.of].motor->most * self_coupling(row);
        if (in_metres(row, std::abs(off) - carried) > still_speed_) continue;
      }
      scratch_.chosen.push_back(row);
      b_[row] = off;
      worst = std::max(worst, in_metres(row, std::abs(b_[row])));
    }
  }
  if (worst <= 1e-6 * still_speed_) return;
  solve_least_norm();
  apply_impulses(state, false);
}

template class ExactSolver<2>;
template class ExactSolver<3>;

}  // namespace obscura::sim
