// One step of many bodies with contacts, from v to v':
//   collide          pairs that may touch, and their features
//   wake             what they reach; how fast they close says how many substeps the step has
// and of each substep
//   move free        features of what has moved; v -> v + dv, dx without contacts, with the forces of joints
//   warm start       forces of the last step; in space after the impacts
//   impacts          of those that close faster than the resting speed, each at its time
//   iterate          v_n' >= -gap / h,  p_n >= 0,  |p_t| <= mu p_n,  between them joints exactly, J v' = 0;
//                    then those that have not settled, and few of these exactly
//   advance          positions by the mean of old and new velocity; of a body that was struck by that up to
//                    the impact and after it; by the new one where a slow touch closed
//   project          out of each other, a part of the way; joints back onto their places
// then
//   report           impulses of the substeps, to the contacts of the step
//   sleep            what is quiet and found in static equilibrium freezes

#include "sim/solve/iterate/iterative.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

constexpr double kMostAnswered = 0.7;  // of an error of a contact's force, from step to step

}  // namespace

template <int D>
Iterative<D>::Iterative(const Model<D>& model, const std::vector<Path<D>>& paths, double deepest)
    : model_(model),
      dynamics_(model, paths),
      joints_(model),
      struck_joints_(model),
      drives_(model),
      sleep_(model, Sleep<D>::Forces::iterated, deepest),
      warm_start_(model),
      g_(std::sqrt(model.gravity.squaredNorm())),
      allowed_overlap_(sim::allowed_overlap(model)),
      fewest_substeps_(resting_substeps(model)),
      every_(std::max<std::int64_t>(1, std::llround(value(model.rate) / kPairSearches))),
      moving_(model.bodies.size() + 1) {
  for (const Body<D>& body : model.bodies) bounding_radius_.push_back(bounding_radius(body.shape));
  on_motors_.assign(model.bodies.size(), 0);
  for (const Joint<D>& joint : model.joints) {
    if (!joint.motor) continue;
    joint.each_body([&](int body) {
      if (body >= 0) on_motors_[std::size_t(body)] = 1;
    });
  }
  varies_ =
      dynamics_.ever() || !smooth() ||
      std::any_of(model.bodies.begin(), model.bodies.end(), [](const auto& body) { return body.drag != 0; });
  const double h = 1 / value(model.rate);
  substeps_ = substeps_for(0, h, fewest_substeps_);
  if (varies_) tightness_ = tightness(model, std::vector<Grip<D>>(model.mice.size()));
  restitution_threshold_ = 2 * h / substeps_ * g_ + 1e-9 * model.scale;
  if (std::none_of(model.bodies.begin(), model.bodies.end(), [](const auto& body) { return body.carries(); }))
    return;
  for (const Body<D>& body : model.bodies) carries_.push_back(body.carries());
}

template <int D>
bool Iterative<D>::collide(StepPart<D> step) {
  State<D>& state = step.state;
  corrected_ = false, closing_rates_ = {};
  state.frozen.resize(model_.bodies.size()), state.quiet.resize(model_.bodies.size());
  joints_.prepare(state), joints_.clear_pushed();
  if (state.step == 0) joints_.project_initial_velocities(state);
  return find_contacts(step);
}

template <int D>
void Iterative<D>::wake(StepPart<D> step) {
  update_sleep(step);
  foresee_speeds(step);
  closing_rates_ = closing_rates(step.h);
  substeps_ = substeps_for(closing_rates_.ruling, step.h, fewest_substeps_);
  const double whole = step_length(model_.rate);
  part_of_step_ = step.h < (1 - 1e-9) * whole ? step.h / whole : 1;
  least_substep_ =
      part_of_step_ < 1 ? whole / substeps_for(closing_rates_.ruling, whole, fewest_substeps_) : 0;
  const double closer = 1.0001 * kCloser * substeps_ / step.h;
  if (closing_rates_.ruling > closer && approach_rate(step.h) > closer)
    step.state.limits_met.substeps.note(step.state.step);
  notes_.begin(step.state);
}

template <int D>
void Iterative<D>::move_free(StepPart<D> part) {
  if (part.substep > 0 && !joints_.empty()) joints_.prepare(part.state);
  renew_contacts(part);
  if (!joints_.empty()) joints_.gather(part.state);
  move_unconstrained(part);
  if (joints_.empty()) return;
  // rows where the substep begins, and what the free motion makes of their speeds
  poses_to_joints();
  joints_.compute_rows();
  velocities_to_joints();
  joints_.keep_row_speeds();
  // what contacts gave of these, to be found anew
  for (const int i : joints_.bodies()) {
    if (borne_.empty() || !moves(i) || !dynamics_.has(i)) continue;
    MovingBody<D>& m = moving_[std::size_t(i)];
    const Twist<D>& its = borne_[std::size_t(i)];
    set_velocity(m, velocity(m) - part.h * its.v, spin(m) - part.h * its.w);
  }
}

template <int D>
void Iterative<D>::begin_bearing(const State<D>& state) {
  bearing_.clear();
  dynamics_.mark_forced(state, forced_);
  if (!smooth()) forced_.assign(forced_.size(), 1);
  // and what hangs together with them
  for (int k = 0; k < joints_.components(); ++k) {
    const std::span<const int> members = joints_.members(k);
    const auto forced = [&](int body) { return forced_[std::size_t(body)] != 0; };
    if (std::none_of(members.begin(), members.end(), forced)) continue;
    for (const int body : members) forced_[std::size_t(body)] = 1;
  }
}

template <int D>
void Iterative<D>::find_borne(const State<D>& state, double h) {
  borne_.clear();
  if (bearing_.empty()) return;
  borne_.resize(model_.bodies.size());
  const bool held =
      std::any_of(state.grips.begin(), state.grips.end(), [](const auto& grip) { return grip.body >= 0; });
  const std::vector<Tightness> with_hands = held ? tightness(model_, state.grips) : std::vector<Tightness>();
  const std::vector<Tightness>& tight = held ? with_hands : tightness_;
  for (PersistentContact<D>& contact : bearing_) {
    double answered = 0;
    for (const int body : {contact.a, contact.b})
      if (body >= 0 && moves(body))
        answered = std::max(answered, share_answered(model_.integrator, tight[std::size_t(body)], h));
    if (answered > kMostAnswered) contact.force *= kMostAnswered / answered;
  }
  // as they stand in the middle, where their rows are
  const auto middle = [&](int body) {
    if (body < 0) return BodyMotion<D>();
    BodyMotion<D> at = begun(body);
    const MovingBody<D>& m = moving_[std::size_t(body)];
    at.v = velocity(m), at.w = spin(m);
    return ahead<D>(at, begun_turn(body), 0.5 * h);
  };
  for (const PersistentContact<D>& contact : bearing_) {
    const BodyMotion<D> a = middle(contact.a), b = middle(contact.b);
    const auto push = contact.at(a, b);
    add_borne(contact.a, push.force, Vec<D>(push.point - a.x));
    add_borne(contact.b, -push.force, Vec<D>(push.point - b.x));
  }
}

template <int D>
void Iterative<D>::add_borne(int body, const Vec<D>& force, const Vec<D>& arm) {
  if (body < 0 || !moves(body)) return;
  Twist<D>& its = borne_[std::size_t(body)];
  const Body<D>& of = model_.bodies[std::size_t(body)];
  its.v += force / of.mass;
  its.w += angular_response<D>(of, begun(body).room_from_body, moment<D>(arm, force));
}

template <int D>
void Iterative<D>::iterate(StepPart<D> part) {
  start_contacts(part);
  if (!joints_.empty()) {
    open_locked();
    velocities_to_joints();
    joints_.begin(part.h, part.t);
  }
  const int count = iterations(part);
  int round = 0;
  do {
    for (int i = 0; i < count; ++i) {
      solve_joint_velocities();
      iterate_contacts(i);
    }
    solve_jointed();
    settle_contacts(part.h);
    solve_exhausted();
    end_round(part);
  } while (temper(part, round++));
  if (!carries_.empty() && !part.state.work.empty()) part.state.work[0] += contact_work(part);
}

template <int D>
void Iterative<D>::advance(StepPart<D> part) {
  place_bodies(part);
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    if (!moves(i)) continue;
    const MovingBody<D>& m = moving_[std::size_t(i)];
    sleep_.advance_timer(part.state, i, velocity(m).squaredNorm(), spin(m).squaredNorm(), part.h);
  }
}

template <int D>
void Iterative<D>::project(StepPart<D> part) {
  correct_overlaps(part);
  if (!joints_.empty()) project_joints(part);
  finish_substep(part);
  if (notes_.any()) note_touches(part);
}

// which watched pairs bear or are struck in a substep
template <int D>
void Iterative<D>::note_touches(StepPart<D> part) {
  const double begun = part.substep * part.h, ended = begun + part.h;
  touching_.clear();
  list_touching(part, touching_);
  for (const auto& [a, b] : touching_) notes_.note(a, b, begun, ended);
  if (part.substep + 1 == substeps_) notes_.end();
}

// wakes bodies that kinematic bodies and belts may reach within `span` s; true if any woke
template <int D>
bool Iterative<D>::wake_near_driven(StepPart<D> step, double span) {
  return sleep_.wake_near_driven(step.state, [&](int body) {
    const int i = drives_.number(body);
    return i < 0 ? 0 : drives_.travel(i, step.t, span);
  });
}

template <int D>
double Iterative<D>::farther(int i, double t, double h) {
  const BodyMotion<D> now = drives_.at(i, t).at, then = drives_.at(i, t + h).at;
  const double turns = std::max(std::sqrt((then.w - now.w).squaredNorm()),
                                drives_.fastest(i, t, h).spin - std::sqrt(now.w.squaredNorm()));
  return std::max(0.0, drives_.travel(i, t, h) - h * std::sqrt(now.v.squaredNorm())) +
         h * bounding_radius_[std::size_t(drives_.body(i))] * turns;
}

// how much faster kinematic bodies become within the step than they are now
template <int D>
void Iterative<D>::foresee_speeds(StepPart<D> step) {
  if (drives_.any()) quicker_.assign(model_.bodies.size(), 0);
  for (int i = 0; i < drives_.size(); ++i) {
    const auto body = std::size_t(drives_.body(i));
    quicker_[body] =
        drives_.fastest(i, step.t, step.h).beyond(drives_.at(i, step.t).at, bounding_radius_[body]);
  }
}

template <int D>
void Iterative<D>::begin_corrections() {
  if (!corrected_) corrections_.assign(model_.bodies.size(), Vec<D>::Zero());
  corrected_ = true;
}

template <int D>
void Iterative<D>::poses_to_joints() {
  for (const int i : joints_.bodies()) joints_.body_motion(i) = begun(i), joints_.turn(i) = begun_turn(i);
}

template <int D>
void Iterative<D>::velocities_to_joints(std::span<const int> of) {
  for (const int i : of) {
    if (!joints_.has(i)) continue;
    const MovingBody<D>& m = moving_[std::size_t(i)];
    joints_.body_motion(i).v = velocity(m), joints_.body_motion(i).w = spin(m);
  }
}

template <int D>
void Iterative<D>::velocities_from_joints(std::span<const int> of) {
  for (const int i : of) {
    if (joints_.has(i))
      set_velocity(moving_[std::size_t(i)], joints_.body_motion(i).v, joints_.body_motion(i).w);
  }
}

template <int D>
void Iterative<D>::solve_joint_velocities() {
  if (joints_.empty()) return;
  velocities_to_joints();
  joints_.iterate();
  velocities_from_joints();
}

// what the substep has pulled apart
template <int D>
void Iterative<D>::project_joints(StepPart<D> part) {
  State<D>& state = part.state;
  for (const int i : joints_.bodies()) {
    joints_.body_motion(i) = body_motion(state, i);
    if (const int k = turning(state, i); k >= 0) joints_.turn(i) = state.turn[std::size_t(k)];
  }
  joints_.finish(part.h, least_substep_);
  if (!state.work.empty()) state.work[0] += joints_.given();
  velocities_from_joints();
  begin_corrections();
  for (const int i : joints_.bodies()) {
    if (!moves(i)) continue;
    corrections_[std::size_t(i)] += joints_.displacement(i);
    const BodyMotion<D>& at = joints_.body_motion(i);
    state.x[std::size_t(i)] = at.x, state.v[std::size_t(i)] = at.v;
    if (const int k = turning(state, i); k >= 0)
      state.turn[std::size_t(k)] = joints_.turn(i), state.spin[std::size_t(k)] = at.w;
    moved_by_joints(state, i);
  }
  if (part.substep + 1 < substeps_ && !joints_.may_break()) return;
  joints_.find_end_forces(state, part.t + part.h);
  bear_locked(part);
  joints_.keep(state, part.h);
  joints_.break_joints(state);
}

template class Iterative<2>;
template class Iterative<3>;

}  // namespace obscura::sim
