// Bodies under springs and forces, handout §2.2, §3.2.
//   dv/dt = g - (c/m) v - (c_g/m) v_g + sum f / m          v_g  along the ground, for what stands on it
//   dw/dt = I^-1 (sum r x f - w x I w)          in the body's axes

#include "sim/motion/forward_dynamics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/constraint/joints/joint.h"
#include "sim/math/elementary.h"
#include "sim/math/lie_step.h"
#include "sim/math/limits.h"
#include "sim/math/workers.h"
#include "sim/model/body_spin.h"
#include "sim/motion/free_motion.h"
#include "sim/motion/stability.h"

namespace obscura::sim {

namespace {

constexpr int kTurningPiece = 64;  // bodies that turn, of which one thread takes so many at a time

}  // namespace

template <int D>
ForwardDynamics<D>::ForwardDynamics(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model),
      paths_(paths),
      drives_(model),
      chains_(model),
      blasts_(model),
      forces_(model),
      passages_(model),
      forced_flight_(model, forces_.flying()),
      tips_(model.bodies) {
  member_.assign(model.bodies.size(), -1);
  const std::size_t counts[] = {model.bodies.size(), model.springs.size(), model.chains.size()};
  for (int i = 0; i < 3; ++i) {
    numbers_[i].resize(counts[i]);
    std::iota(numbers_[i].begin(), numbers_[i].end(), 0);
  }
  ever_ = !model.springs.empty() || !model.mice.empty() || !model.explosions.empty() || !model.chains.empty();
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    if (model.joints[i].coil) sprung_.push_back(int(i)), ever_ = true;
  for (const Joint<D>& joint : model.joints) books_ = books_ || joint.motor;
  for (const Body<D>& body : model.bodies) {
    ever_ = ever_ || body.ground_drag != 0;
    books_ = books_ || body.carries() || body.ground_drag != 0;
  }
  driven_.resize(std::size_t(drives_.size()));
  only_forces_ = !ever_;
  ever_ = ever_ || forces_.any();
}

template <int D>
typename ForwardDynamics<D>::Hold ForwardDynamics<D>::hold(const State<D>& state, const End<D>& end) const {
  if (end.body < 0) return {-1, -1, -1, end.local};
  if (member_[end.body] >= 0) return {member_[end.body], -1, -1, end.local};
  if (const int drive = drives_.number(end.body); drive >= 0) return {-1, -1, drive, end.local};
  const BodyMotion<D> at = body_motion(state, end.body);  // what does not move: its point stays
  return {-1, -1, -1, at.x + at.arm(end.local)};
}

// act(body) of the bodies with a spring, those that the mouse holds, and those awake that the ground brakes
// or a force pushes
template <int D>
template <class Act>
void ForwardDynamics<D>::each_forced(const State<D>& state, const Act& act) const {
  for (const Spring<D>& spring : model_.springs) act(spring.a.body), act(spring.b.body);
  for (const int i : sprung_)
    act(model_.joints[std::size_t(i)].a.body), act(model_.joints[std::size_t(i)].b.body);
  for (const Grip<D>& grip : state.grips) act(grip.body);
  for (int body = 0; body < int(member_.size()); ++body) {
    const bool pushed = model_.bodies[body].ground_drag != 0 ||
                        (forces_.push(body) && !(leaves_flying_ && forces_.flying().flies(body)));
    if (pushed && (state.frozen.empty() || !state.frozen[body])) act(body);
  }
}

template <int D>
void ForwardDynamics<D>::mark_forced(const State<D>& state, std::vector<char>& forced) const {
  forced.assign(member_.size(), blasting(state));
  each_forced(state, [&](int body) {
    if (body >= 0) forced[std::size_t(body)] = 1;
  });
  for (std::size_t i = 0; i < forced.size(); ++i) forced[i] = forced[i] || model_.bodies[i].drag != 0;
}

template <int D>
void ForwardDynamics<D>::gather(const State<D>& state, bool all_awake, std::span<const int> also) {
  const Subset all{numbers_[0], numbers_[1], numbers_[2]};
  if (all_awake || blasting(state)) return gather(state, all);
  // the same as last time?
  if (only_forces_ && forces_.any() && !bodies_.empty() && also.empty()) {
    bool same = true;
    for (int body = 0; same && body < int(member_.size()); ++body) {
      const bool asleep = model_.bodies[body].fixed || (!state.frozen.empty() && state.frozen[body]);
      const bool takes = forces_.push(body) && !asleep && !(leaves_flying_ && forces_.flying().flies(body));
      same = takes == (member_[body] >= 0);
    }
    if (same) return;
  }
  for (const int body : all_) member_[body] = -1;
  const auto mark = [&](int body) {
    if (body >= 0 && !model_.bodies[body].fixed && !model_.bodies[body].linked) member_[body] = 0;
  };
  each_forced(state, mark);
  for (const int body : also) {
    if (state.frozen.empty() || !state.frozen[body]) mark(body);
  }
  gather_marked(state, all);
}

template <int D>
void ForwardDynamics<D>::gather(const State<D>& state, const Subset& of) {
  for (const int body : all_) member_[body] = -1;
  for (const int body : of.bodies) {
    const bool frozen = !state.frozen.empty() && state.frozen[body];
    if (!frozen && !model_.bodies[body].fixed && !model_.bodies[body].linked) member_[body] = 0;
  }
  gather_marked(state, of);
}

// gathers the bodies of a part of the model whose member_ is not below zero
template <int D>
void ForwardDynamics<D>::gather_marked(const State<D>& state, const Subset& of) {
  bodies_.clear();
  for (const int body : of.bodies) {
    if (member_[body] < 0) continue;
    member_[body] = int(bodies_.size());
    bodies_.push_back(body);
  }
  turning_ = 0;
  for (const int body : bodies_) turning_ += turning(state, body) >= 0;
  chains_.gather(state, of.chains);
  all_ = bodies_;
  for (const int body : chains_.links()) {
    member_[body] = int(all_.size());
    all_.push_back(body);
  }

  // by what
  ties_.clear();
  for (const int number : of.springs) {
    const Spring<D>& spring = model_.springs[number];
    const Tie tie{hold(state, spring.a), hold(state, spring.b), law(spring)};
    if (tie.a.member >= 0 || tie.b.member >= 0) ties_.push_back(tie);
  }
  for (int mouse = 0; mouse < int(state.grips.size()); ++mouse) {
    const Grip<D>& grip = state.grips[mouse];
    if (grip.body < 0 || member_[grip.body] < 0) continue;
    ties_.push_back(
        {hold(state, {grip.body, grip.local}), {-1, mouse, -1, Vec<D>::Zero()}, law(model_.mice[mouse])});
  }

  joint_ties_.clear();
  for (const int i : sprung_) {
    const Joint<D>& joint = model_.joints[std::size_t(i)];
    JointTie tie{i, joint_side(state, joint.a.body), joint_side(state, joint.b.body)};
    if (tie.a.member >= 0 || tie.b.member >= 0) joint_ties_.push_back(tie);
  }

  // bodies with a limit on the turn of one step: tumbling ones, those held off their centre, and links
  wheels_.clear();
  for (int i = 0; i < int(all_.size()); ++i) {
    if (turning(state, all_[i]) < 0) continue;
    if (i >= int(bodies_.size()) || wobbles<D>(model_.bodies[all_[i]].inertia)) wheels_.push_back(all_[i]);
  }
  for (const Tie& tie : ties_) {
    for (const Hold& end : {tie.a, tie.b}) {
      if (end.member >= 0 && !end.at.isZero(0) && turning(state, all_[end.member]) >= 0)
        wheels_.push_back(all_[end.member]);
    }
  }

  // under what
  gravity_.clear(), drag_.clear();
  bool drag = false;
  for (const int body : bodies_) {
    const Body<D>& b = model_.bodies[body];
    for (int axis = 0; axis < D; ++axis) {
      gravity_.push_back(model_.gravity[axis]);
      drag_.push_back(b.drag / b.mass);
    }
    drag = drag || b.drag != 0;
  }
  if (!drag) drag_.clear();

  if (forces_.any()) forces_.gather(state, member_), pushes_.resize(all_.size());

  dragged_.clear();
  for (int i = 0; i < int(all_.size()); ++i) {
    if (model_.bodies[all_[i]].ground_drag != 0) dragged_.push_back(i);
  }
  braked_.reserve(dragged_.size());

  flying_ = turning_ == 0 && ties_.empty() && joint_ties_.empty() && dragged_.empty() &&
            chains_.size() == 0 && forces_.flying().all() && !books_;

  const std::size_t n = std::size_t(chain_start() + chains_.size() + int(books_));
  x_.resize(bodies_.size()), stances_.assign(all_.size(), {}), turn_.resize(turning_), base_.resize(turning_);
  d_.resize(n), v_.resize(n), d_rate_.resize(n), v_rate_.resize(n);
}

template <int D>
void ForwardDynamics<D>::bear(const State<D>& state, std::span<const PersistentContact<D>> contacts) {
  bearing_.clear();
  for (const PersistentContact<D>& contact : contacts) {
    const PersistentTie tie{contact, joint_side(state, contact.a), joint_side(state, contact.b),
                            coasting(state, contact.a), coasting(state, contact.b)};
    if (tie.a.member >= 0 || tie.b.member >= 0) bearing_.push_back(tie);
  }
}

template <int D>
typename ForwardDynamics<D>::Coasting ForwardDynamics<D>::coasting(const State<D>& state, int body) const {
  Coasting it;
  if (body < 0 || member_[std::size_t(body)] >= 0 || drives_.number(body) >= 0) return it;
  if (model_.bodies[std::size_t(body)].fixed || (!state.frozen.empty() && state.frozen[std::size_t(body)]))
    return it;
  it.goes = true, it.begun = body_motion(state, body);
  if (const int k = turning(state, body); k >= 0) it.turn = state.turn[std::size_t(k)];
  return it;
}

// the tied bodies of a state as d = 0 and v
template <int D>
void ForwardDynamics<D>::load(const State<D>& state) {
  const int n = int(bodies_.size()), still = n - turning_;
  for (int i = 0; i < n; ++i) {
    x_[i] = state.x[bodies_[i]];
    std::copy_n(state.v[bodies_[i]].data(), D, v_.data() + D * i);
  }
  for (int i = 0; i < turning_; ++i) {
    const int k = turning(state, bodies_[still + i]);
    turn_[i] = state.turn[k];
    load_spin(state, k, model_.integrator == Integrator::semi_implicit, base_[i],
              v_.data() + D * n + kAngular<D> * i);
  }
  chains_.load(state, std::span<double>(v_).subspan(std::size_t(chain_start()), std::size_t(chains_.size())));
  if (books_) v_.back() = 0;
  std::fill(d_.begin(), d_.end(), 0.0);
  forces_.refer(state);

  // springs of joints that are whole
  std::erase_if(joint_ties_, [&](const JointTie& tie) {
    return std::size_t(tie.joint) < state.broken.size() && state.broken[std::size_t(tie.joint)] != 0;
  });
  for (JointTie& tie : joint_ties_) {
    for (JointSide* side : {&tie.a, &tie.b}) {
      const int k = side->body < 0 ? -1 : turning(state, side->body);
      if (k < 0) continue;
      side->begun = rotation<D>(state.turn[k]), side->rounds = sim::rounds<D>(state.turn[k]);
    }
  }

  // explosions
  acting_.clear(), held_.clear();
  for (int i = 0; i < int(state.blasts.size()); ++i) {
    const Blast<D>& blast = state.blasts[i];
    if (!blast.on) continue;
    if (blast.forces.empty()) {
      acting_.push_back(i);
      continue;
    }
    held_.resize(all_.size());
    for (std::size_t k = 0; k < all_.size(); ++k)
      held_[k] += Wrench<D>{blast.torques[all_[k]], blast.forces[all_[k]]};
  }

  // friction with the ground
  braked_.clear();
  for (const int member : dragged_) {
    const BodyMotion<D> at = body_motion(state, all_[member]);
    const Body<D>& body = model_.bodies[all_[member]];
    const double h = 1 / value(model_.rate), g = std::sqrt(model_.gravity.squaredNorm());
    // as far as it falls between two impacts of the handout's rest
    const double near = kOnGround * model_.scale + g * h * h;
    for (const Wall<D>& wall : model_.walls) {
      if (g > 0 && !(wall.normal.dot(model_.gravity) < 0)) continue;
      double least = 1e300;
      for (const SupportVertex<D>& tip : tips_[all_[member]])
        least = std::min(least, (at.x + at.arm(tip.at) - wall.point).dot(wall.normal) - tip.radius);
      if (least > near) continue;
      braked_.push_back({member, body.ground_drag / body.mass, wall.normal});
      break;
    }
  }
}

template <int D>
std::span<const double> ForwardDynamics<D>::accelerations(const State<D>& state, double t) {
  load(state);
  posed_ = true;
  rates(t, d_, v_, d_rate_, v_rate_);
  return v_rate_;
}

// The number of pieces of a step: as many as the fastest turn needs. But one if the step is too long for a
// spring: the spin that this causes is to be reported, not hidden.
template <int D>
int ForwardDynamics<D>::pieces(const State<D>& state, double h) const {
  int most = 1;
  for (const int body : wheels_)
    most = std::max(most, pieces_of_turn<D>(state.spin[turning(state, body)], h));
  return most > 1 && tightest(model_, state.grips).body < 0 ? most : 1;
}

template <int D>
void ForwardDynamics<D>::step(Integrate* integrate, State<D>& state, double t, double h, Stages& stages,
                              System* with) {
  work_ = rough_ = 0, begun_ = t;
  if (all_.empty()) return;
  if (flying_ && !with && bearing_.empty() && !blasting(state)) return fly(integrate, state, t, h, stages);
  posed_ = with != nullptr;
  System& rates = with ? *with : *this;
  if (!passages_.any()) return go(integrate, state, t, h, stages, rates);
  step_by_passages(
      model_.integrator, t, h, state.step, state.limits_met.passages,
      [&](double now) { return passages_.fastest(state, now, h, member_); },
      [&](double from, double length) { go(integrate, state, from, length, stages, rates); });
}

// in as many pieces as the fastest turn needs
template <int D>
void ForwardDynamics<D>::go(Integrate* integrate, State<D>& state, double t, double h, Stages& stages,
                            System& rates) {
  const int n = pieces(state, h);
  for (int i = 0; i < n; ++i) piece(integrate, state, t + i * (h / n), h / n, stages, rates);
}

// bodies that nothing but forces on each alone acts on, in blocks that stay in the nearest cache
template <int D>
void ForwardDynamics<D>::fly(Integrate* integrate, State<D>& state, double t, double h, Stages& stages) {
  const int n = int(bodies_.size());
  for (int first = 0, count; first < n; first += count) {
    count = 1;
    while (count < ForcedFlight<D>::kMost && first + count < n &&
           bodies_[first + count] == bodies_[first] + count)
      ++count;
    forced_flight_.step(integrate, state, bodies_[first], count, t, h, stages);
  }
}

template <int D>
void ForwardDynamics<D>::piece(Integrate* integrate, State<D>& state, double t, double h, Stages& stages,
                               System& rates) {
  const int n = int(bodies_.size()), still = n - turning_;
  load(state);
  stage_ = 0;
  integrate(rates, t, h, d_, v_, stages);
  if (model_.integrator == Integrator::rk4 && rates.smooth()) {
    // contacts press anew in each step, and whatever they do in it is not the springs'
    for (std::size_t k = 0; k < from_contacts_.size() && !bearing_.empty(); ++k) {
      const std::span<double> rate = stages.row(kRk4Rates[k], v_.size());
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] -= from_contacts_[k][i];
    }
    const auto note = [&](const VelocityRows& rows, double least, bool of_spins) {
      const Roughness found = roughness(rows, h, v_, least, stages, rates.tied());
      note_roughness(state.limits_met, state.step, found, of_spins);
      rough_ = std::max(rough_, found.ratio);
    };
    const std::size_t spins = std::size_t(turning_), axes = std::size_t(kAngular<D>);
    note({bodies_.size(), D, D, 1}, kFaintest * model_.scale, false);
    note({spins, axes, axes, 1, D * bodies_.size()}, kFaintest, true);
  }

  for (int i = 0; i < n; ++i) {
    state.x[bodies_[i]] += Eigen::Map<const Vec<D>>(d_.data() + D * i);
    state.v[bodies_[i]] = Eigen::Map<const Vec<D>>(v_.data() + D * i);
  }
  each(model_.workers.get(), turning_, kTurningPiece, [&](int first, int end) {
    for (int i = first; i < end; ++i) {
      const int k = turning(state, bodies_[still + i]), at = D * n + kAngular<D> * i;
      store_spin<D>(state, k, turn_[i], d_.data() + at, base_[i], v_.data() + at);
    }
  });
  const std::size_t chains = std::size_t(chain_start()), joints = std::size_t(chains_.size());
  chains_.give(std::span<const double>(d_).subspan(chains, joints),
               std::span<const double>(v_).subspan(chains, joints), state);
  if (books_) work_ += v_.back();
}

template <int D>
typename ForwardDynamics<D>::Moving ForwardDynamics<D>::moving(const Hold& hold, double t) const {
  if (hold.mouse >= 0) {
    const auto hand = paths_[hold.mouse].at(t);
    return {Vec<D>::Zero(), hand.place, hand.velocity};
  }
  if (hold.member < 0 && hold.drive < 0) return {Vec<D>::Zero(), hold.at, Vec<D>::Zero()};
  const BodyMotion<D>& at = hold.drive < 0 ? stances_[hold.member] : driven_[std::size_t(hold.drive)].at;
  const Vec<D> arm = at.arm(hold.at);
  return {arm, at.x + arm, at.velocity(arm)};
}

template <int D>
typename ForwardDynamics<D>::JointSide ForwardDynamics<D>::joint_side(const State<D>& state, int body) const {
  JointSide side;
  side.body = body;
  if (body < 0) return side;
  side.member = member_[std::size_t(body)];
  if (side.member >= 0) return side;
  side.drive = drives_.number(body);
  side.still = body_motion(state, body);
  if (side.drive < 0) side.still.v.setZero(), side.still.w.setZero();
  return side;
}

template <int D>
const BodyMotion<D>& ForwardDynamics<D>::motion_of(const JointSide& side) const {
  if (side.member >= 0) return stances_[std::size_t(side.member)];
  return side.drive >= 0 ? driven_[std::size_t(side.drive)].at : side.still;
}

// its angle in the plane, with whole rounds: a stage turns it by less than half a one
template <int D>
AngularVec<D> ForwardDynamics<D>::rounds_of(const JointSide& side) const {
  if constexpr (D == 2) {
    if (side.drive >= 0) return driven_[std::size_t(side.drive)].turn;
    if (side.member < 0) return side.rounds;
    const Rotation<2> turn = motion_of(side).room_from_body * side.begun.transpose();
    return AngularVec<2>(side.rounds[0] + elementary::atan2(turn(1, 0), turn(0, 0)));
  } else {
    return AngularVec<D>::Zero();
  }
}

// the spring of a joint, along its free coordinate; the power of what is moved, W
template <int D>
double ForwardDynamics<D>::push_joint(const JointTie& tie, std::span<double> v_rate) {
  const Joint<D>& joint = model_.joints[std::size_t(tie.joint)];
  const BodyMotion<D>&a = motion_of(tie.a), &b = motion_of(tie.b);
  Row<D> row;
  double c = 0;
  free_row(joint, a, b, AngularVec<D>(rounds_of(tie.a) - rounds_of(tie.b)), row, c);
  const double of_a = row.along.dot(a.v) + row.angular_a.dot(a.w),
               of_b = row.along.dot(b.v) + row.angular_b.dot(b.w);
  const double f = joint.coil->force(c, of_a - of_b);
  if (tie.a.member >= 0) push(tie.a.member, Wrench<D>{row.angular_a, row.along} * f, v_rate);
  if (tie.b.member >= 0) push(tie.b.member, Wrench<D>{row.angular_b, row.along} * -f, v_rate);
  return (tie.b.drive >= 0 ? f * of_b : 0) - (tie.a.drive >= 0 ? f * of_a : 0);
}

template <int D>
void ForwardDynamics<D>::push(const Hold& hold, const Vec<D>& arm, const Vec<D>& force,
                              std::span<double> v_rate) {
  if (hold.member >= 0) push(hold.member, {moment<D>(arm, force), force}, v_rate);
}

// by a force at the centre and a torque, in the room's frame
template <int D>
void ForwardDynamics<D>::push(int member, const Wrench<D>& by, std::span<double> v_rate) {
  const int n = int(bodies_.size()), spinning = member - (n - turning_);
  if (member >= n) return chains_.pull(member - n, by);
  const Body<D>& body = model_.bodies[bodies_[member]];
  Eigen::Map<Vec<D>>(v_rate.data() + D * member) += by.f / body.mass;
  if (spinning < 0) return;
  Eigen::Map<AngularVec<D>>(v_rate.data() + D * n + kAngular<D> * spinning) +=
      from_room<D>(stances_[member].room_from_body, by.n).cwiseQuotient(body.inertia);
}

template <int D>
void ForwardDynamics<D>::rates(double t, std::span<const double> d, std::span<const double> v,
                               std::span<double> d_rate, std::span<double> v_rate) {
  const int n = int(bodies_.size()), still = n - turning_;

  // bodies without springs: x' = v, v' = g - (c/m) v
  std::copy_n(v.begin(), D * n, d_rate.begin());
  unconstrained_rates(gravity_, drag_, v.first(D * n), v_rate.first(D * n));

  // poses at this stage, where anything asks for them, and the torque-free rotation
  const bool pushed =
      posed_ || forces_.any() ||
      !(ties_.empty() && joint_ties_.empty() && bearing_.empty() && acting_.empty() && held_.empty());
  for (int i = 0; i < n; ++i) {
    stances_[i].x = x_[i] + Eigen::Map<const Vec<D>>(d.data() + D * i);
    stances_[i].v = Eigen::Map<const Vec<D>>(v.data() + D * i);
  }
  const auto turn_one = [&](int i) {
    const int at = D * n + kAngular<D> * i;
    const AngularVec<D> by = Eigen::Map<const AngularVec<D>>(d.data() + at);
    const AngularVec<D> w =
        whole_spin<D>(base_[i], AngularVec<D>(Eigen::Map<const AngularVec<D>>(v.data() + at)));
    if (pushed) {
      BodyMotion<D>& it = stances_[still + i];
      it.room_from_body = rotation<D>(displaced<D>(turn_[i], by));
      it.w = to_room<D>(it.room_from_body, w);
    }
    Eigen::Map<AngularVec<D>>(d_rate.data() + at) = displacement_rate<D>(by, w);
    Eigen::Map<AngularVec<D>>(v_rate.data() + at) =
        gyroscopic_acceleration<D>(model_.bodies[bodies_[still + i]].inertia, w);
  };
  each(model_.workers.get(), turning_, kTurningPiece, [&](int first, int end) {
    for (int i = first; i < end; ++i) turn_one(i);
  });
  const std::size_t chains = std::size_t(chain_start()), joints = std::size_t(chains_.size());
  const int links = int(chains_.links().size());
  if (links > 0) chains_.stand(d.subspan(chains, joints), v.subspan(chains, joints)), chains_.clear_forces();
  for (int k = 0; k < links; ++k) {
    stances_[n + k] = chains_.body_motion(k);
    chains_.pull(k, {AngularVec<D>::Zero(), -model_.bodies[all_[n + k]].drag * stances_[n + k].v});
  }

  for (int i = 0; i < drives_.size(); ++i) driven_[std::size_t(i)] = drives_.at(i, t);
  double power = 0;  // of bodies that are moved, and of drag along the ground
  for (const Tie& tie : ties_) {
    const Moving a = moving(tie.a, t), b = moving(tie.b, t);
    const Vec<D> force = pull<D>(tie.law, a.place, a.velocity, b.place, b.velocity);
    push(tie.a, a.arm, force, v_rate);
    push(tie.b, b.arm, -force, v_rate);
    if (tie.a.drive >= 0) power -= force.dot(a.velocity);
    if (tie.b.drive >= 0) power += force.dot(b.velocity);
  }
  for (const JointTie& tie : joint_ties_) power += push_joint(tie, v_rate);
  if (!bearing_.empty()) {
    std::vector<double>& gives = from_contacts_[std::size_t(stage_++) % from_contacts_.size()];
    gives.assign(v_rate.size(), 0.0);
    for (const PersistentTie& tie : bearing_) {
      const auto at = [&](const JointSide& side, const Coasting& coasts) {
        return coasts.goes ? ahead<D>(coasts.begun, coasts.turn, t - begun_) : motion_of(side);
      };
      const BodyMotion<D> a = at(tie.a, tie.a_coasts), b = at(tie.b, tie.b_coasts);
      const auto [force, point] = tie.contact.at(a, b);
      if (tie.a.member >= 0) push(tie.a.member, {moment<D>(point - a.x, force), force}, gives);
      if (tie.b.member >= 0) push(tie.b.member, {moment<D>(b.x - point, force), -force}, gives);
    }
    for (std::size_t i = 0; i < gives.size(); ++i) v_rate[i] += gives[i];
  }
  for (const int explosion : acting_) {
    for (int i = 0; i < int(all_.size()); ++i)
      push(i, blasts_.push(model_.explosions[explosion], all_[i], stances_[i]), v_rate);
  }
  for (int i = 0; i < int(held_.size()); ++i) push(i, held_[i], v_rate);
  if (forces_.any()) {
    std::fill(pushes_.begin(), pushes_.end(), Wrench<D>{});
    forces_.apply(t, stances_, pushes_);
    power += forces_.driven_power();
    for (int i = 0; i < int(pushes_.size()); ++i) push(i, pushes_[i], v_rate);
  }
  for (const Braked& it : braked_) {
    const Vec<D>& speed = stances_[it.member].v;
    const Vec<D> rate = it.rate * (speed - it.normal * it.normal.dot(speed));
    power -= model_.bodies[all_[std::size_t(it.member)]].mass * rate.dot(speed);
    if (it.member < n)
      Eigen::Map<Vec<D>>(v_rate.data() + D * it.member) -= rate;
    else
      push(it.member, {AngularVec<D>::Zero(), -model_.bodies[all_[it.member]].mass * rate}, v_rate);
  }
  if (links > 0)
    chains_.rates(d.subspan(chains, joints), v.subspan(chains, joints), d_rate.subspan(chains, joints),
                  v_rate.subspan(chains, joints));
  if (books_) d_rate.back() = 0, v_rate.back() = power;
}

template class ForwardDynamics<2>;
template class ForwardDynamics<3>;

}  // namespace obscura::sim
