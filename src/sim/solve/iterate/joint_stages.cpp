// The free motion of bodies on joints: in each stage of the integrator that the scene names,
//   v' = a + M^-1 J f            f: J v' + J' v = 0, of motors their speed's rate
// of what joints hold, of ropes that are taut, limits that are reached, motors that have their speed and
// friction that sticks. One that would have to pull where it pushes, or harder than it can, lets go, and the
// step is taken again; a motor and friction then give all they can, as they do where they slide.
//
// Where within the step friction sticks or a motor reaches its speed, a new one begins, and what comes to its
// end is stopped at that time, without a rebound:
//   tau    C(x(tau)) = 0         by false position, each time with a step of tau from the beginning
//   v'     = v + M^-1 J p        p: J v' = 0 of all that holds, p >= 0 of ropes and limits; motors give none
// and from there the rest of the step is taken.

#include "sim/solve/iterate/joint_solver.h"

#include <algorithm>
#include <cmath>

#include "sim/math/false_position.h"

namespace obscura::sim {

namespace {

constexpr int kMostStrikes = 8;        // of a step
constexpr int kMostStopped = 50;       // bodies; of more, iterations stop what comes to its end
constexpr int kMostTries = 40;         // for the time of one
constexpr double kAtEnd = 1e-13;       // of a joint's size: nearer to its end it is there
constexpr double kOver = 1e-12;        // farther beyond it is
constexpr double kNothingLeft = 1e-9;  // of a step: what is left of it is none
constexpr int kPieces = 64;            // of a step that is too long,
constexpr int kFewPieces = 8;          // or for which forces change so much:
constexpr double kRough = 0.001;       // Roughness::ratio
constexpr double kLeap = 2;            // times the energy that it had
constexpr double kFalls = 100;         // times what it gains by gravity in a step
constexpr double kHalfTurn = 3;        // rad, nearly
constexpr double kSlower = 2;          // times what forces change in a step: iterations stop it as well

}  // namespace

template <int D>
double JointSolver<D>::step(ForwardDynamics<D>& dynamics, Integrate* integrate, State<D>& state, double t,
                            double h, Stages& stages) {
  dynamics_ = &dynamics, begun_ = &state, stopped_ = false, span_ = h;
  set_poses(state, t);
  begin_motors();
  double given = 0;
  const auto move = [&](double from, double span, int pieces) {
    first_stage_ = true, given = 0;
    for (Acting& acting : acting_) acting.spare = kEndless;
    for (int i = 0; i < pieces; ++i) {
      dynamics.step(integrate, state, from + i * (span / pieces), span / pieces, stages,
                    held_.empty() ? nullptr : this);
      given += dynamics.work();
    }
  };
  const auto step_free = [&](double from, double span) {
    move(from, span, 1);
    const int pieces = held_.empty()               ? 1
                       : leaps(state, h)           ? kPieces
                       : dynamics.rough() > kRough ? kFewPieces
                                                   : 1;
    if (pieces == 1) return;
    restore(state);
    move(from, span, pieces);
  };
  if (bounded_blocks_.empty()) {
    save(state);
    step_free(t, h);
    return given;
  }
  double work = 0, done = 0;
  if (choose_holding(t, h)) work += strike(state, t), choose_holding(t, h);
  for (int strikes = 0;; ++strikes) {
    const double from = t + done, span = h - done;
    save(state);
    for (Stop& stop : stops_) {
      Row<D> row;
      bounded_row(stop.block, stop.load, row);
      stop.speed = speed(row, at_);
      stop.sign = excess(stop, from) < 0 ? -1 : 1;
      stop.left = left(stop, from);
    }
    set_loose();
    step_free(from, span);
    while (release()) {
      restore(state), set_loose();
      step_free(from, span);
    }
    set_poses(state, t + h);
    if (strikes == kMostStrikes || int(bodies_.size()) > kMostStopped || !overrun(t + h)) break;

    double at_low = kEndless, until = span;
    bool stops = false;
    for (const int i : overrun_) {
      const Stop& stop = stops_[std::size_t(i)];
      at_low = std::min(at_low, stop.left / size(held_[std::size_t(stop.block)]));
      stops = stops || stop.load == lower || stop.load == upper;
    }
    FalsePosition root(0, at_low, span, least_left(t + h));
    for (int i = 0; i < kMostTries; ++i) {
      until = root.next();
      restore(state);
      step_free(from, until);
      set_poses(state, from + until);
      const double now = least_left(from + until);
      if (std::fabs(now) <= kAtEnd) break;
      root.put(until, now);
    }
    work += given;
    done += until;
    if (stops) work += strike(state, t + done);
    if (h - done <= kNothingLeft * h) {
      note_ends(t + h), end_motors();
      loosen_all();
      return work;
    }
    if (choose_holding(t + done, h)) work += strike(state, t + done), choose_holding(t + done, h);
  }
  note_ends(t + h), end_motors();
  loosen_all();
  return work + given;
}

// Whether bodies that move gain energy so fast that the step is too long for them, as where a loop of joints
// passes a dead centre.
template <int D>
bool JointSolver<D>::leaps(const State<D>& state, double h) const {
  double before = 0, now = 0, mass = 0;
  for (std::size_t i = 0; i < saved_.size(); ++i) {
    const int body = dynamics_->bodies()[i];
    const Body<D>& its = model_.bodies[std::size_t(body)];
    if (!member_[std::size_t(body)]) continue;
    mass += its.mass;
    before += its.mass * saved_[i].v.squaredNorm(),
        now += its.mass * state.v[std::size_t(body)].squaredNorm();
    const int k = turning(state, body);
    if (k < 0) continue;
    const double most = its.inertia.maxCoeff();
    before += most * saved_[i].spin.squaredNorm(), now += most * state.spin[std::size_t(k)].squaredNorm();
  }
  return now > kLeap * before && before > mass * kFalls * h * h * model_.gravity.squaredNorm();
}

template <int D>
void JointSolver<D>::set_poses(const State<D>& state, double t) {
  for (const int body : bodies_) {
    if (const int drive = drives_.number(body); drive >= 0) {
      const DrivenMotion<D> its = drives_.at(drive, t);
      at_[body] = its.at, turn_[body] = its.turn;
    }
    if (!response_.moves(body)) continue;
    at_[body] = sim::body_motion(state, body);
    if (const int k = turning(state, body); k >= 0) turn_[body] = state.turn[std::size_t(k)];
  }
}

// Ropes at their length that do not change it faster than gravity can in a step, limits that are reached,
// motors that have their speed and friction that sticks; known forces of other motors and friction. True if
// something comes to its end there.
template <int D>
bool JointSolver<D>::choose_holding(double t, double h) {
  const double falls = std::sqrt(model_.gravity.squaredNorm()) * h;
  bool arrives = false;
  for (const int k : bounded_blocks_) acting_[std::size_t(k)] = {};
  for (const Stop& stop : stops_) {
    if (stop.load > upper) continue;
    const int i = held_[std::size_t(stop.block)];
    Acting& acting = acting_[std::size_t(stop.block)];
    const double near = kTaut * size(i), off = left(i, stop.load);
    if (acting.load != none || off > near) continue;
    Row<D> row;
    bounded_row(stop.block, stop.load, row);
    const double fast = speed(row, at_);
    const double slow = one_sided(model_.joints[std::size_t(i)]) ? std::max(falls, near / h) : near / h;
    if (off < -near) continue;
    arrives = arrives || fast < -kArrives * size(i);
    if (std::fabs(fast) <= slow) acting.load = stop.load;
  }
  for (const int k : bounded_blocks_) {
    const int i = held_[std::size_t(k)];
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    Acting& acting = acting_[std::size_t(k)];
    if (!joint.motor && !(joint.friction > 0)) continue;
    Row<D> row;
    double value = 0;
    free_row_of(i, row, value);
    const double rate = speed(row, at_);
    const bool still = std::fabs(rate) <= kArrives * size(i);
    const bool ends = acting.load != none;
    if (joint.motor) {
      const double aimed = motors_.at(i, t, value, rate).speed;
      if (!ends && has_speed(i, rate, aimed, h))
        acting.load = motor;
      else
        acting.drive = rate < aimed ? joint.motor->most : rate > aimed ? -joint.motor->most : 0;
    }
    if (!(joint.friction > 0) || (still && ends)) continue;
    if (!still)
      acting.rub = rate > 0 ? -joint.friction : joint.friction;
    else if (acting.load == none)
      acting.load = friction;
  }
  return arrives;
}

template <int D>
void JointSolver<D>::set_loose() {
  for (const int k : bounded_blocks_)
    loose_[std::size_t(bounded_row(k))] = acting_[std::size_t(k)].load == none;
}

template <int D>
void JointSolver<D>::loosen_all() {
  for (const int k : bounded_blocks_) loose_[std::size_t(bounded_row(k))] = 1;
}

// What was beyond its bounds in a stage: what then holds in its place, or its known force. True if there is
// any. Ends only where motors and friction are within theirs: through a gear these may hold what an end does.
template <int D>
bool JointSolver<D>::release() {
  bool any = false;
  for (const bool ends : {false, true}) {
    for (const int k : bounded_blocks_) {
      Acting& acting = acting_[std::size_t(k)];
      const Load load = acting.load;
      if (load == none || acting.spare >= 0 || (load <= upper) != ends) continue;
      const Joint<D>& joint = model_.joints[std::size_t(held_[std::size_t(k)])];
      const double sign = acting.beyond > 0 ? 1 : -1;
      any = true;
      if (load == friction) acting.rub = sign * joint.friction;
      if (load == motor) acting.drive = sign * joint.motor->most;
      acting.released = acting.released || ends;
      acting.load = load != friction && joint.friction > 0 && acting.rub == 0 ? friction : none;
    }
    if (any) return true;
  }
  return false;
}

// the speed of a joint's coordinate less what a motor aims at, or friction
template <int D>
double JointSolver<D>::excess(const Stop& stop, double t) {
  if (stop.load <= upper) return 0;
  const int i = held_[std::size_t(stop.block)];
  Row<D> row;
  double value = 0;
  free_row_of(i, row, value);
  const double rate = speed(row, at_);
  return rate - (stop.load == motor ? motors_.at(i, t, value, rate).speed : 0);
}

// where the step ends
template <int D>
void JointSolver<D>::note_ends(double t) {
  for (Stop& stop : stops_) {
    stop.excess = excess(stop, t);
    if (stop.load <= upper) stop.ends = left(stop, t);
  }
}

// how far a joint is from a stop at the poses and velocities at hand
template <int D>
double JointSolver<D>::left(const Stop& stop, double t) {
  return stop.load > upper ? stop.sign * excess(stop, t) : left(held_[std::size_t(stop.block)], stop.load);
}

// whether a joint's coordinate has gone so far that it is told anew: an angle in space, within a turn
template <int D>
bool JointSolver<D>::goes_round(int joint, double way) const {
  return D == 3 && equations<D>(model_.joints[std::size_t(joint)].kind).angle && way > kHalfTurn;
}

// the stops that were passed in an interval that ended at t, into overrun_; true if there are any
template <int D>
bool JointSolver<D>::overrun(double t) {
  overrun_.clear();
  for (int i = 0; i < int(stops_.size()); ++i) {
    const Stop& stop = stops_[std::size_t(i)];
    const Acting& acting = acting_[std::size_t(stop.block)];
    const int joint = held_[std::size_t(stop.block)];
    const double least = (stop.load > upper ? kArrives : kOver) * size(joint);
    if (acting.load == stop.load || stop.left <= least) continue;
    if (stop.load <= upper && acting.released) continue;
    const double now = left(stop, t);
    if (now >= -kOver * size(joint)) continue;
    if (stop.load > upper) {
      // a limit keeps its speed, whatever its motor and friction are for
      if (acting.load > upper) overrun_.push_back(i);
      continue;
    }
    if (goes_round(joint, stop.left - now)) continue;
    Row<D> row;
    bounded_row(stop.block, stop.load, row);
    const double ends = speed(row, at_);
    if (-stop.speed > kSlower * std::fabs(ends - stop.speed) || -ends > slow_end(joint))
      overrun_.push_back(i);
  }
  return !overrun_.empty();
}

// m/s or rad/s: no faster comes to its end what only falls there
template <int D>
double JointSolver<D>::slow_end(int joint) const {
  return kSlower * span_ * fall(joint) + kTaut * size(joint) / span_;
}

// of those, how far the farthest is from its end, in its size
template <int D>
double JointSolver<D>::least_left(double t) {
  double least = kEndless;
  for (const int i : overrun_) {
    const Stop& stop = stops_[std::size_t(i)];
    least = std::min(least, left(stop, t) / size(held_[std::size_t(stop.block)]));
  }
  return least;
}

// Lets go the rope or limit that would have to pull hardest, by rhs_; true if there is any.
template <int D>
bool JointSolver<D>::drop_puller() {
  double least = 0;
  int worst = -1;
  for (const int k : bounded_blocks_) {
    const Load load = acting_[std::size_t(k)].load;
    // a torque as a force on the size of the scene
    const double f = rhs_[std::size_t(bounded_row(k))] / in_metres(held_[std::size_t(k)]);
    if ((load == lower || load == upper) && f < least) least = f, worst = k;
  }
  if (worst >= 0) acting_[std::size_t(worst)].load = none;
  return worst >= 0;
}

// Stops what is at its end and comes beyond. The work of kinematic bodies, J.
template <int D>
double JointSolver<D>::strike(State<D>& state, double t) {
  if (!stopped_) {
    jumps_.assign(at_.size(), Vec<D>::Zero());
    spin_jumps_.assign(at_.size(), AngularVec<D>::Zero());
  }
  stopped_ = true;
  set_poses(state, t);
  for (const int k : bounded_blocks_) {
    Acting& acting = acting_[std::size_t(k)];
    if (acting.load > upper) acting.load = none;
  }
  for (const Stop& stop : stops_) {
    const int i = held_[std::size_t(stop.block)];
    Acting& acting = acting_[std::size_t(stop.block)];
    if (stop.load > upper || acting.load != none || std::fabs(left(i, stop.load)) > kTaut * size(i)) continue;
    Row<D> row;
    bounded_row(stop.block, stop.load, row);
    if (speed(row, at_) < 0) acting.load = stop.load;
  }
  do {
    set_loose();
    compute_rows();
    for (std::size_t r = 0; r < rows_.size(); ++r) rhs_[r] = -speed(rows_[r], at_);
    factors_.solve(rhs_.data());
  } while (drop_puller());
  double work = 0;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (driven_) work += rhs_[r] * drive_works_[r];
    push(rows_[r], rhs_[r]);
  }
  for (const int body : bodies_) {
    if (!response_.moves(body)) continue;
    jumps_[std::size_t(body)] += at_[body].v - state.v[std::size_t(body)];
    state.v[std::size_t(body)] = at_[body].v;
    const int k = turning(state, body);
    if (k < 0) continue;
    spin_jumps_[std::size_t(body)] += at_[body].w - state.spin[std::size_t(k)];
    state.spin[std::size_t(k)] = at_[body].w;
  }
  return work;
}

template <int D>
void JointSolver<D>::save(const State<D>& state) {
  saved_.clear(), saved_rough_ = state.limits_met.rough, saved_wildest_ = state.limits_met.wildest;
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
  state.limits_met.rough = saved_rough_, state.limits_met.wildest = saved_wildest_;
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
  each_motor(
      [&](std::size_t i, const Coordinate& its) { begun_motors_[i] = its, free_motors_[i] = its.rate; });
}

// their rates where the free motion ends
template <int D>
void JointSolver<D>::end_motors() {
  each_motor([&](std::size_t i, const Coordinate& its) { free_motors_[i] = its.rate; });
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

// M^-1 J' f, onto accelerations
template <int D>
void JointSolver<D>::push_rates(const Row<D>& row, double f, std::span<double> v_rate) {
  each_push(row, f, [&](int body, const Vec<D>& dv, const AngularVec<D>& dw) {
    const int place = dynamics_->place(body);
    Eigen::Map<Vec<D>>(v_rate.data() + D * place) += dv;
    if (const int at = dynamics_->spin_start(place); at >= 0)
      Eigen::Map<AngularVec<D>>(v_rate.data() + at) += from_room<D>(at_[body].room_from_body, dw);
  });
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
  const double drives = push_known(v_rate);
  solve_forces(t, v_rate);
  for (std::size_t r = 0; r < rows_.size(); ++r) push_rates(rows_[r], rhs_[r], v_rate);
  const int work = dynamics_->work_place();
  if (work >= 0) v_rate[std::size_t(work)] += drives;
  for (std::size_t r = 0; work >= 0 && driven_ && r < rows_.size(); ++r)
    v_rate[std::size_t(work)] += rhs_[r] * drive_works_[r];
  for (const int k : bounded_blocks_) {
    Acting& acting = acting_[std::size_t(k)];
    if (acting.load == none) continue;
    const Row<D>& row = rows_[std::size_t(bounded_row(k))];
    const double f = rhs_[std::size_t(bounded_row(k))];
    const Joint<D>& joint = model_.joints[std::size_t(held_[std::size_t(k)])];
    if (acting.load == motor && work >= 0) v_rate[std::size_t(work)] += f * speed(row, at_);
    const double spare = acting.load == motor      ? joint.motor->most - std::fabs(f)
                         : acting.load == friction ? joint.friction - std::fabs(f)
                                                   : f;
    if (spare < acting.spare) acting.spare = spare, acting.beyond = f;
    if (first_stage_) acting.first = f;
    acting.last = f;
  }
  first_stage_ = false;
}

// Known forces of motors and friction, onto accelerations. The power of motors, W.
template <int D>
double JointSolver<D>::push_known(std::span<double> v_rate) {
  double power = 0;
  for (const int k : bounded_blocks_) {
    const Acting& acting = acting_[std::size_t(k)];
    if (acting.drive == 0 && acting.rub == 0) continue;
    Row<D> row;
    double value = 0;
    free_row_of(held_[std::size_t(k)], row, value);
    power += acting.drive * speed(row, at_);
    push_rates(row, acting.drive + acting.rub, v_rate);
  }
  return power;
}

// The forces of all rows, into rhs_, at the poses and velocities at hand, where the bodies have the
// accelerations v_rate without them.
template <int D>
void JointSolver<D>::solve_forces(double t, std::span<const double> v_rate) {
  compute_rows();
  for (std::size_t r = 0; r < rows_.size(); ++r)
    rhs_[r] = -row_acceleration(rows_[r], v_rate) - rows_[r].velocity_product;
  for (const int k : bounded_blocks_) {
    if (acting_[std::size_t(k)].load != motor) continue;
    const int i = held_[std::size_t(k)];
    Row<D> row;
    double value = 0;
    free_row_of(i, row, value);
    rhs_[std::size_t(bounded_row(k))] += motors_.at(i, t, value, speed(row, at_)).rate;
  }
  factors_.solve(rhs_.data());
}

// What acts at the end of the free motion acts on there; ropes and limits that would have to pull let go.
template <int D>
void JointSolver<D>::find_end_forces(const State<D>& state, double t) {
  if (held_.empty()) return;
  set_poses(state, t);
  const std::span<const double> without = dynamics_->accelerations(state, t);
  end_rates_.assign(without.begin(), without.end());
  push_known(end_rates_);
  do {
    set_loose();
    solve_forces(t, end_rates_);
  } while (drop_puller());
  // once more for what rows of different scales leave
  ways_ = rhs_;
  for (std::size_t r = 0; r < rows_.size(); ++r) push_rates(rows_[r], ways_[r], end_rates_);
  solve_forces(t, end_rates_);
  for (std::size_t r = 0; r < rows_.size(); ++r) end_forces_[r] = rhs_[r] += ways_[r];
  for (std::size_t k = 0; k < held_.size(); ++k) {
    end_loads_[k] = {};
    const int first = factors_.first(int(k));
    for (int r = first; r < first + factors_.size(int(k)); ++r)
      end_loads_[k] += load(held_[k], rows_[std::size_t(r)]) * rhs_[std::size_t(r)];
  }
  for (const int k : bounded_blocks_) {
    const Acting& acting = acting_[std::size_t(k)];
    if (acting.drive == 0 && acting.rub == 0) continue;
    Row<D> row;
    double value = 0;
    free_row_of(held_[std::size_t(k)], row, value);
    end_loads_[std::size_t(k)] += load(held_[std::size_t(k)], row) * (acting.drive + acting.rub);
  }
  loosen_all();
}

template <int D>
void JointSolver<D>::keep_row_speeds() {
  for (ReachedEnds& ends : reached_) ends.known = false;
  left_.assign(std::size_t(components()), 1.0);
  holds_.assign(model_.joints.size(), {});
  for (std::size_t r = 0; r < rows_.size(); ++r) targets_[r] = speed(rows_[r], at_);
  for (const int k : bounded_blocks_) {
    const Acting& acting = acting_[std::size_t(k)];
    Hold& hold = holds_[std::size_t(held_[std::size_t(k)])];
    hold.load = acting.load;
    hold.given[motor] = acting.drive, hold.given[friction] = acting.rub;
    if (acting.load == none) continue;
    Row<D> row;
    bounded_row(k, acting.load, row);
    hold.target = speed(row, at_);
    hold.given[acting.load] = 0.5 * (acting.first + acting.last);
  }
  for (const Stop& stop : stops_) {
    Row<D> row;
    bounded_row(stop.block, stop.load, row);
    Hold& hold = holds_[std::size_t(held_[std::size_t(stop.block)])];
    if (stop.load <= upper) {
      const double way = stop.ends - left(stop, 0);
      if (!goes_round(held_[std::size_t(stop.block)], std::fabs(way)))
        hold.bends[stop.load] = std::min(0.0, speed(row, at_) - way / span_);
      continue;
    }
    hold.knows = true, hold.aims[stop.load] = speed(row, at_) - stop.excess;
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                               \
  template double JointSolver<D>::step(ForwardDynamics<D>&, Integrate*, State<D>&, double, double, Stages&); \
  template void JointSolver<D>::loosen_all();                                                                \
  template void JointSolver<D>::find_end_forces(const State<D>&, double);                                    \
  template void JointSolver<D>::rates(double, std::span<const double>, std::span<const double>,              \
                                      std::span<double>, std::span<double>);                                 \
  template void JointSolver<D>::keep_row_speeds()
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
