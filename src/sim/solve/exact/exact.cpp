// One step of the event-driven solver, with contact forces inside the stages of the integrator.
//   1. impacts of this instant
//   2. contact modes and forces at this instant: K f + b = w under the laws of cone_law.h
//   3. smooth motion with those modes, up to the next event or the end of the step
//   4. projection of positions and velocities onto the constraints; again from 1
// After too many events the rest of the step is done at once, by impulses.
// Source: Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical Systems (2008), event-driven
// schemes.

#include "sim/solve/exact/exact.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/energy/energy.h"
#include "sim/force/force_coupling.h"
#include "sim/model/script.h"
#include "sim/solve/exact/couples.h"

namespace obscura::sim {

namespace {

// of the speeds of two bodies: how much of their contact's taking back energy may change
constexpr double kPerturbed = 1e-3;
constexpr double kSunk = 0.1;        // of the thinnest: how far two may come into each other in one piece
constexpr double kMostPieces = 200;  // of a step that is done roughly
constexpr double kTiny = 1e-6;       // of a step: a cut that leads nowhere
constexpr int kStuck = 16;           // such cuts, one after another
constexpr int kThorough = 32;        // steps: in each such one what is not found is looked for everywhere
constexpr double kManyLooks = 3e5;   // at couples, before a step is
// of a step, by a body that meets walls alone: a bounce takes microseconds
constexpr int kMostLoneCuts = 50000;
// by one of a few, to which each is cheap: rest grows with them, so that what bounces ever faster comes to an
// end
constexpr std::size_t kSmallGroup = 4;
constexpr int kMostCutsOfSmall = 100;

}  // namespace

template <int D>
typename ExactSolver<D>::Limits ExactSolver<D>::make_limits(const Model<D>& model, Serves bodies) {
  Limits limits;
  const double g = std::sqrt(model.gravity.squaredNorm()), h = 1 / value(model.rate);
  const bool event_mode = model.collision == Collision::event;
  limits.unit_speed = std::sqrt(g * model.scale);
  if (limits.unit_speed == 0) limits.unit_speed = model.scale;
  limits.touching_gap = (event_mode ? 1e-12 : 1e-9) * model.scale;
  limits.least_speed = 1e-6 * limits.unit_speed;
  limits.rest_speed = event_mode ? limits.least_speed : std::max(limits.least_speed, 0.1 * g * h);
  limits.most_cuts = event_mode ? 2000 + 100 * int(model.bodies.size()) : 12;
  limits.most_openings = event_mode ? limits.most_cuts : 6;
  limits.most_faces = event_mode ? limits.most_cuts : 6;
  limits.patience = event_mode ? 8 + int(model.bodies.size()) : 4;
  limits.short_step = event_mode ? 1.0 / 64 : 1.0 / 4;
  limits.budget = event_mode ? 1e300 : 1e7;
  for (const Joint<D>& joint : model.joints) limits.row_joints += !joint.linked;
  for (const Body<D>& body : model.bodies) {
    limits.bounding_radius.push_back(sim::bounding_radius(body.shape));
    limits.half_thickness.push_back(sim::half_thickness(body.shape));
  }
  if (bodies == Serves::all) {
    list_couples<D>(model, [&](int a, int b) { limits.couples.push_back({a, b}); });
  } else {
    for (int a = 0; a < int(model.bodies.size()); ++a)
      if (model.bodies[a].fixed && !model.bodies[a].driven) limits.fixed.push_back(a);
  }
  const auto number = [](std::vector<int>& list, std::size_t size) {
    list.resize(size);
    std::iota(list.begin(), list.end(), 0);
  };
  number(limits.bodies, model.bodies.size()), number(limits.joints, model.joints.size());
  number(limits.springs, model.springs.size()), number(limits.chains, model.chains.size());
  limits.tied_by_forces = tied_by_forces(model);
  limits.wires = has_wires(model), limits.rubs = limits.wires || has_rubbing_ropes(model);
  if (!model.rails.empty()) limits.rails.resize(model.bodies.size());
  for (int i = 0; i < int(model.rails.size()); ++i) {
    const Rail<D>& rail = model.rails[std::size_t(i)];
    limits.rails[std::size_t(rail.body)].push_back(i);
    double& far = limits.bounding_radius[std::size_t(rail.body)];
    far = std::max(far, rail.curve->reach());
  }
  return limits;
}

template <int D>
ExactSolver<D>::ExactSolver(const Model<D>& model, const std::vector<Path<D>>& paths, Serves bodies)
    : model_(model),
      may_touch_(model),
      drives_(model),
      motors_(model),
      limits_(make_limits(model, bodies)),
      integrate_(sim::integrate(model.integrator)),
      dynamics_(model, paths),
      response_(model),
      sleep_(model, Sleep<D>::Forces::exact) {
  if (model.collision != Collision::event) cone_.enough = 1e-7;
  progress_.rest_speed = limits_.rest_speed;
  step_.travel_bound.resize(model.bodies.size());
  step_.groups.reserve(model.bodies.size());
  driven_.resize(std::size_t(drives_.size()));
  for (const Body<D>& body : model.bodies) belts_ = belts_ || !body.belt.isZero(0);
}

template <int D>
void ExactSolver<D>::save(const State<D>& state, Motion& motion) const {
  motion.x.resize(state.x.size()), motion.v.resize(state.v.size());
  motion.turn.resize(state.turn.size()), motion.spin.resize(state.spin.size());
  motion.body_spin.resize(state.body_spin.size()), motion.chain_states.resize(state.chain_states.size());
  for (const int body : active_.subset.bodies) {
    motion.x[body] = state.x[body], motion.v[body] = state.v[body];
    const int k = turning(state, body);
    if (k < 0) continue;
    motion.turn[k] = state.turn[k], motion.spin[k] = state.spin[k];
    if (std::size_t(k) < state.body_spin.size()) motion.body_spin[k] = state.body_spin[k];
  }
  for (const int chain : active_.subset.chains) motion.chain_states[chain] = state.chain_states[chain];
}

template <int D>
void ExactSolver<D>::restore(const Motion& motion, State<D>& state) const {
  for (const int body : active_.subset.bodies) {
    state.x[body] = motion.x[body], state.v[body] = motion.v[body];
    const int k = turning(state, body);
    if (k < 0) continue;
    state.turn[k] = motion.turn[k], state.spin[k] = motion.spin[k];
    if (std::size_t(k) < state.body_spin.size()) state.body_spin[k] = motion.body_spin[k];
  }
  for (const int chain : active_.subset.chains) state.chain_states[chain] = motion.chain_states[chain];
}

// whether every number of the bodies at hand is finite
template <int D>
bool ExactSolver<D>::all_finite(const State<D>& state) const {
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
double ExactSolver<D>::kinetic_energy(const State<D>& state) const {
  double sum = 0;
  for (const int body : active_.subset.bodies) {
    if (!model_.bodies[body].fixed) sum += kinetic(model_, state, body);
  }
  return sum;
}

// collects the bodies at hand, whatever of them is awake
template <int D>
void ExactSolver<D>::collect_bodies(State<D>& state) {
  double fastest = 0;
  for (const int body : active_.subset.bodies) {
    response_.set(body, !model_.bodies[body].fixed && !state.frozen[body]);
    fastest = std::max(fastest, state.v[body].squaredNorm());
  }
  for (const DrivenMotion<D>& it : driven_) fastest = std::max(fastest, it.at.v.squaredNorm());
  still_speed_ = 1e-11 * std::max(limits_.unit_speed, std::sqrt(fastest));
  dynamics_.gather(state, active_.subset);
  stages_.reserve(std::size_t(dynamics_.size()));
}

template <int D>
bool ExactSolver<D>::collide(StepPart<D> step) {
  corrections_.clear();
  State<D>& state = step.state;
  const std::size_t n = model_.bodies.size();
  resize_for(state);
  step_.contacts.clear(), step_.impulses.clear();
  outcome_.joint_loads.resize(state.joint_forces.size());
  if (limits_.rubs) {
    outcome_.drags.assign(state.joint_forces.size(), 0);
    for (std::size_t i = 0; i < state.wound.size(); ++i) outcome_.drags[i] = state.wound[i].drag;
  }
  for (std::size_t i = 0; i < state.joint_forces.size(); ++i)
    outcome_.joint_loads[i] = {state.joint_torques[i], state.joint_forces[i]};
  cone_.thorough = model_.collision == Collision::event || state.step % kThorough == 0;

  activate_all();
  pose_driven(step.t);
  wake_near_driven(state, step.t, step.h);
  collect_bodies(state);
  save(state, step_.begun);
  step_.frozen = state.frozen, step_.quiet = state.quiet, step_.on_piece = state.on_piece;
  step_.broken = state.broken;
  bound_travel(state, step.t, step.h);
  step_.near.reset(int(n)), step_.old_root.assign(n, -1), step_.travelled.assign(n, 0.0),
      step_.cuts.assign(n, 0), step_.given.assign(n, 0.0);
  return true;
}

template <int D>
void ExactSolver<D>::advance(StepPart<D> step) {
  State<D>& state = step.state;
  // Bodies that got farther than expected, into the reach of others, are stepped again together with them: of
  // a row, through which a blow goes, one more each time. Groups only grow, so it comes to an end.
  bool any = true;
  for (int round = 0; any; ++round) {
    join_near_bodies(state);
    any = false;
    list_groups(state);
    for (const Group& group : step_.groups) {
      bool known = step_.old_root[group.root] == group.root;
      for (const int body : group.subset.bodies) known = known && step_.old_root[body] == group.root;
      if (known) continue;
      any = true;
      activate(group);
      if (round > 0) {
        restore(step_.begun, state);
        for (const int i : active_.joints) state.broken[i] = step_.broken[i];
        for (const int body : group.subset.bodies)
          state.frozen[body] = step_.frozen[body], state.quiet[body] = step_.quiet[body];
        const auto of_group = [&](const Contact<D>& c) {
          return step_.group_of[c.key.a] == step_.group_of[group.root];
        };
        std::erase_if(step_.contacts, of_group), std::erase_if(step_.impulses, of_group);
      }
      for (const int body : group.subset.bodies)
        step_.old_root[body] = group.root, step_.cuts[body] = 0, step_.given[body] = 0;
      step_group(state, step.t, step.h);
      step_.given[group.root] = progress_.given;
      step_.contacts.insert(step_.contacts.end(), outcome_.contacts.begin(), outcome_.contacts.end());
      step_.impulses.insert(step_.impulses.end(), outcome_.impulses.begin(), outcome_.impulses.end());
    }
  }
  if (state.work.empty()) return;
  for (const double given : step_.given) state.work[0] += given;
}

template <int D>
void ExactSolver<D>::sleep(StepPart<D> step) {
  put_to_sleep(step.state, step.t + step.h, step.h);
  write_contacts(step.state);
  break_joints(step.state);
}

// moves the group at hand from t to t + h
template <int D>
void ExactSolver<D>::step_group(State<D>& state, double t, double h) {
  collect_bodies(state);
  outcome_.contacts.clear(), outcome_.impulses.clear();
  progress_.known = &state.contacts;
  progress_.given = 0;
  if (limits_.wires) on_piece_ = state.on_piece;
  double done = 0;
  int tiny = 0;  // cuts in a row that led nowhere
  progress_.forced.clear(), progress_.forced_again = false;
  progress_.jumps = h < 2 * kJumpPiece * step_length(model_.rate);
  progress_.rough = progress_.limited = false, progress_.work = 0, progress_.searches = 0;
  progress_.faces = limits_.most_faces;
  progress_.openings = limits_.most_openings, progress_.released.reset(), progress_.unclear.clear();
  const bool event_mode = model_.collision == Collision::event;
  const bool small = active_.subset.bodies.size() <= kSmallGroup;
  const int most_cuts = event_mode     ? limits_.most_cuts
                        : active_.lone ? kMostLoneCuts
                        : small        ? kMostCutsOfSmall
                                       : limits_.most_cuts;
  const double slowest = progress_.rest_speed,
               fastest =
                   std::max(progress_.rest_speed, limits_.unit_speed * limits_.unit_speed / model_.scale * h);
  int grown = 0;  // cuts at which rest has grown
  for (const int body : active_.subset.bodies)
    if (course_) course_->forget(body);
  if (course_) {
    std::erase_if(course_->breaks, [&](const auto& it) {
      return std::find(active_.joints.begin(), active_.joints.end(), it.joint) != active_.joints.end();
    });
  }
  // `event` counts all cuts of the group, whoever they are of
  for (int spent = 0; done < h; spent = event_mode ? spent + !progress_.passes : cuts_so_far()) {
    progress_.passes = false;
    pose_driven(t + done);
    stepped_ = done;
    find_contacts_awake(state, limits_.touching_gap);
    if (done == 0) hold_again(state);
    resolve_contact_impacts(state);
    bool cut = true;
    double length = 0;
    bool held_again = false;  // what let go is to be held: the same instant once more
    // at a speed of 1e6 room heights a second a step has as many places to search
    if ((progress_.work > limits_.budget || progress_.searches > kManyLooks) && done > 0)
      progress_.rough = progress_.limited = true;
    const bool chosen = !progress_.rough && solve_modes(state, t + done) && !jammed();
    if (!chosen) progress_.rough = !event_mode;
    if (chosen && spent < most_cuts && tiny <= kStuck) {
      if (progress_.released) release_contact();
      record_forces(state);
      if (break_loaded(state, done)) continue;
      if (coming_apart()) project_state(state, 0);
      // at the friction limit nothing slips: as an equality it is sticking
      interval_.modes = modes_, interval_.loads = loads();
      for (std::size_t i = 0; i < interval_.modes.size(); ++i) {
        ConeMode<D>& mode = interval_.modes[i];
        if (mode.kind != ModeKind::at_friction_limit) continue;
        // without friction it slips where a force sets in later
        mode.kind = blocks_[i].mu > 0 ? ModeKind::stick : ModeKind::slide;
      }
      const double soon = time_to_aims(state, t + done, h - done);
      const double most = D > 2 ? begin_slip_directions(state, t + done, soon) : soon;
      const std::size_t forced = progress_.forced.size();
      length = advance_to_event(state, t + done, most, cut);
      if (!cut && most < h - done) cut = progress_.passes = true;
      held_again = progress_.forced.size() > forced && !progress_.forced_again;
      if (length > 0) note_contacts(done, done + length);
      pose_driven(t + done + length);
      if (length > 0) project_state(state, length), progress_.given += interval_.given;
      if (cut && !progress_.passes) count_cut(progress_.cut_by.a, progress_.cut_by.b);
    }
    if (length == 0 && !held_again) {
      progress_.limited = progress_.limited || spent >= most_cuts || tiny > kStuck;
      // no way to go on but a short one at once
      length = std::min(spent < most_cuts && !progress_.rough ? limits_.short_step * h
                                                              : std::max(h / kMostPieces, time_unseen(state)),
                        h - done);
      step_by_impulses(state, t + done, length);
      cut = length < h - done;
      count_cut(-1, -1);
    }
    if (length > 0) {
      note_motion(state, done, done + length);
      measure_travel(state);
      progress_.forced.clear(), progress_.forced_again = false;
      tiny = length < kTiny * h ? tiny + 1 : 0;
    }
    done = cut ? done + length : h;
    // ever faster impacts count as rest, so that what bounces ever faster comes to an end
    if (spent > limits_.patience && spent % 2 == 0 && spent > grown) {
      progress_.rest_speed = std::min(fastest, 2 * progress_.rest_speed);
      grown = spent;
    }
  }
  progress_.rest_speed = slowest;
  stepped_ = h;
  pose_driven(t + h);
  find_contacts_awake(state, limits_.touching_gap);
  for (const int i : active_.joints)
    if (limits_.wires) step_.on_piece[std::size_t(i)] = on_piece_[std::size_t(i)];
  resolve_contact_impacts(state);
  if (progress_.limited) state.limits_met.work.note(state.step);
  // the forces that joints are shown with and break by are those of the end
  if (!active_.joints.empty() && solve_modes(state, t + h)) record_forces(state);
  // contacts that were pushed apart have another gap now than when their force was found
  if (!progress_.rough) return;
  update_poses(state);
  for (Contact<D>& contact : outcome_.contacts) contact.gap = gap_of(contact.key, contact.gap);
}

// Contacts that stuck where the last step ended stick as this one begins, though velocities are a little
// others: what that step won of energy has been taken from them (sim/energy/energy_guard.h). As a slip it
// would choose another law; where bodies jam, one with forces without bounds.
template <int D>
void ExactSolver<D>::hold_again(State<D>& state) {
  using Kind = typename Constraint::Kind;
  update_poses(state);
  collect_constraints(state);
  scratch_.chosen.clear();
  b_.setZero(Eigen::Index(rows_.size()));
  const auto hold = [&](const Constraint& constraint, int rows) {
    for (int row = constraint.first; row < constraint.first + rows; ++row)
      scratch_.chosen.push_back(row), b_[row] = -row_velocity(row);
  };
  const auto swift = [&](int body) {
    return body < 0 ? 0
                    : std::sqrt(poses_[std::size_t(body)].v.squaredNorm()) +
                          limits_.bounding_radius[std::size_t(body)] *
                              std::sqrt(poses_[std::size_t(body)].w.squaredNorm());
  };
  double worst = 0;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Kind::joint) hold(constraint, constraint.rows);
    if (constraint.kind != Kind::contact) continue;
    const ContactKey& key = candidates_[constraint.of].key;
    const Contact<D>* known = find_contact<D>(*progress_.known, key);
    if (!known || known->touching == ContactMode::open) continue;
    double off2 = 0;
    const bool sticks = known->touching != ContactMode::slide && material(key).static_friction > 0;
    for (int row = constraint.first; row < constraint.first + (sticks ? D : 1); ++row)
      off2 += row_velocity(row) * row_velocity(row);
    const double off = std::sqrt(off2);
    if (off > kPerturbed * (swift(key.a) + swift(key.b))) continue;
    hold(constraint, sticks ? D : 1);
    if (sticks) worst = std::max(worst, off);
  }
  if (worst <= still_speed_) return;
  find_islands();
  solve_least_norm();
  apply_impulses(state, false);
}

// lets the contact that ended the last interval separate, or slip, if it bears next to nothing now
template <int D>
void ExactSolver<D>::release_contact() {
  --progress_.openings;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact ||
        candidates_[constraint.of].key != *progress_.released || !active(constraint))
      continue;
    ConeMode<D>& mode = modes_[constraint.block];
    const Tangent<D> drag = f_.segment(constraint.first + 1, D - 1);
    const double left = force_reserve(constraint, f_);
    if (f_[constraint.first] <= interval_.slight) {
      mode.kind = ModeKind::open;
      f_.segment(constraint.first, D).setZero();
    } else if (left <= interval_.slight && mode.kind != ModeKind::slide) {
      // others may bear on: lawful_length() finds where none does
      if (grips(constraint) && !bears_alone(*progress_.released))
        progress_.unclear.push_back(*progress_.released);
      else
        mode.kind = ModeKind::slide, mode.along = -drag / std::sqrt(drag.squaredNorm());
    } else if (left > 0.25 * progress_.reserve_at_release) {
      progress_.unclear.push_back(
          *progress_.released);  // one of many that may bear the same load: its force tells nothing
    }
  }
  if (begin_to_slip()) solve();
  progress_.released.reset();
}

// s: how long all may move on and not come far into one another
template <int D>
double ExactSolver<D>::time_unseen(const State<D>& state) const {
  double least = 1e300;
  for (const int body : active_.subset.bodies) {
    if (limits_.half_thickness[body] > 0) least = std::min(least, limits_.half_thickness[body]);
  }
  double fastest = 0;
  for (const int body : active_.subset.bodies) {
    if (!response_.moves(body)) continue;
    double speed = std::sqrt(state.v[body].squaredNorm());
    if (const int k = turning(state, body); k >= 0)
      speed += limits_.bounding_radius[body] * std::sqrt(state.spin[k].squaredNorm());
    fastest = std::max(fastest, speed);
  }
  return fastest > 0 ? kSunk * least / fastest : 1e300;
}

template <int D>
void ExactSolver<D>::rates(double t, std::span<const double> d, std::span<const double> v,
                           std::span<double> d_rate, std::span<double> v_rate) {
  dynamics_.rates(t, d, v, d_rate, v_rate);
  if (constraints_.empty()) return;

  // rows at the poses of this stage
  const auto& members = dynamics_.bodies();
  for (std::size_t i = 0; i < members.size(); ++i) poses_[members[i]] = dynamics_.stances()[i];
  const auto& links = dynamics_.chains().links();
  for (std::size_t i = 0; i < links.size(); ++i) poses_[links[i]] = dynamics_.stances()[members.size() + i];
  for (int i = 0; i < drives_.size(); ++i) {
    driven_[std::size_t(i)] = dynamics_.driven()[std::size_t(i)];
    poses_[std::size_t(drives_.body(i))] = driven_[std::size_t(i)].at;
  }
  rows_.clear();
  for (Constraint& constraint : constraints_)
    build_jacobian(constraint, {AngularVec<D>(AngularVec<D>::Zero()), constraint.rope});
  chain_response_.build(rows_, response_, dynamics_.chains());
  b_.resize(Eigen::Index(rows_.size()));
  for (int i = 0; i < int(rows_.size()); ++i) b_[i] = row_acceleration(i, v_rate) + rows_[i].velocity_product;
  now_ = t;
  for (const Constraint& constraint : constraints_) b_[constraint.first] -= aim(constraint).rate;
  if (model_.integrator == Integrator::semi_implicit) aim_at_end();

  // constraints that hold go on holding
  if (D > 2) turn_slip_directions();
  solve_held();
  for (int i = 0; i < kMostRubs && rub(i); ++i) solve_held();
  for (int i = 0; i < int(rows_.size()); ++i) add_accelerations(i, f_[i], v_rate);
  if (const int work = dynamics_.work_place(); work >= 0) {
    for (int i = 0; i < int(rows_.size()); ++i) v_rate[std::size_t(work)] += f_[i] * given(i);
    v_rate[std::size_t(work)] += motor_power();
  }
}

// For semi-implicit Euler: forces of joints that make C = 0 at the end of the step, whose way is h v',
//   C' + h (J v' + J' v / 2) = 0        C' = J v, which is not yet 0 within the pieces of an interval
// instead of C'' = 0 at its beginning, which would give what turns the energy of an explicit step. Not where
// friction goes by these forces.
// Source: Andersen, Rattle (1983), of its first half.
template <int D>
void ExactSolver<D>::aim_at_end() {
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::joint) continue;
    const Joint<D>& joint = model_.joints[constraint.of];
    if (joint.kind == JointKind::wire && joint.friction > 0) continue;
    for (int i = 0; i < constraint.rows; ++i) {
      const int row = constraint.first + i;
      b_[row] += row_velocity(row) / interval_.piece - 0.5 * rows_[row].velocity_product;
    }
  }
}

// of the forces f_ of motors at the poses at hand, without what given() has of it, W
template <int D>
double ExactSolver<D>::motor_power() const {
  double sum = 0;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::motor)
      sum += f_[constraint.first] * row_velocity(constraint.first);
  }
  return sum;
}

template class ExactSolver<2>;
template class ExactSolver<3>;

}  // namespace obscura::sim
