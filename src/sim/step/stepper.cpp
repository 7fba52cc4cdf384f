// One step:
//   1. cut at the edges of the script
//   2. integrate: free bodies in blocks, tied bodies and chains together
//   3. collide with the walls
//      where a contact solver has the bodies, it does what 2 and 3 say (sim/step/contact_step.h)
//   4. at an edge, press and release, begin and end explosions
//   5. look for trouble

#include "sim/step/stepper.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sim/force/mouse.h"
#include "sim/math/limits.h"
#include "sim/model/body_spin.h"
#include "sim/motion/free_motion.h"
#include "sim/motion/stability.h"
#include "sim/step/archive.h"
#include "sim/step/bonded_bodies.h"
#include "sim/step/contact_step.h"
#include "sim/step/events.h"
#include "sim/step/releases.h"

namespace obscura::sim {

namespace {

// bodies: the twelve rows of a Runge-Kutta step take 24 KiB
constexpr int kBlock = ForcedFlight<2>::kMost;

template <int D>
std::vector<Path<D>> paths(const Model<D>& model) {
  std::vector<Path<D>> all;
  for (const Mouse<D>& mouse : model.mice) all.emplace_back(mouse.path);
  return all;
}

}  // namespace

template <int D>
Stepper<D>::Stepper(const Model<D>& model)
    : model_(model),
      paths_(sim::paths(model)),
      edges_(edges(model)),
      press_times_(model.mice.size()),
      release_times_(model.mice.size()),
      integrate_(sim::integrate(model.integrator)),
      handout_(model, paths_),
      blasts_(model),
      jumps_(model),
      drives_(model),
      divergence_(model, paths_),
      dynamics_(model, paths_),
      work_(model),
      forces_(model),
      forced_flight_(model, forces_.flying()),
      springs_(!model.springs.empty() || !model.mice.empty() || !stability_warnings(model).empty()) {
  wound_ropes_ = has_wound_ropes(model), pulleys_ = has_pulleys(model);
  for (const Joint<D>& joint : model.joints) springs_ = springs_ || joint.coil.has_value();
  // so do bodies that are moved, and a potential that changes with the time
  for (const Body<D>& body : model.bodies) springs_ = springs_ && !body.carries();
  for (const Force<D>& force : model.forces)
    springs_ = springs_ && !(force.formula && force.formula->potential && force.formula->timed);
  assert(std::is_partitioned(model.bodies.begin(), model.bodies.end(),
                             [](const auto& b) { return !b.turns(); }));
  for (const ScriptEvent& edge : edges_) {
    if (edge.kind == ScriptEvent::Kind::press) press_times_[edge.mouse] = edge.at;
    if (edge.kind == ScriptEvent::Kind::release) release_times_[edge.mouse] = edge.at;
  }
  for (int i = 0; i < kBlock; ++i) {
    for (int axis = 0; axis < D; ++axis) gravity_.push_back(model.gravity[axis]);
  }
  const double fastest = kFarthest * model.scale;
  bool drag = false;
  for (const Body<D>& body : model.bodies) {
    for (int axis = 0; axis < D; ++axis) drag_.push_back(body.drag / body.mass);
    drag = drag || body.drag != 0;
    if (!body.turns()) continue;
    spin_limits_.push_back(fastest / bounding_radius(body.shape));
    if (wobbles<D>(body.inertia))
      spin_limits_.back() = std::min(spin_limits_.back(), kFarthestTurn * value(model.rate));
  }
  if (!drag) drag_.clear();
  dynamics_.leave_flying();
  for (int body = 0; body < int(model.bodies.size()); ++body) {
    if (model.bodies[body].handout) by_handout_.push_back(body);
  }
  for (const Body<D>& body : model.bodies) {
    if (body.turns()) inertia_.push_back(body.inertia);
  }
  d_.resize(std::max(D, kAngular<D>) * kBlock), w_.resize(kAngular<D> * kBlock), base_.resize(kBlock);
  assert(model.bonds.empty() || model.chains.empty());
  if (!model.whens.empty()) {
    events_ = std::make_unique<Events<D>>(model);
    return;
  }
  if (!model.bonds.empty()) bonded_ = std::make_unique<BondedBodies<D>>(model, paths_);
  const auto let_go = [](const Drive<D>& drive) { return drive.release.has_value(); };
  if (std::any_of(model.drives.begin(), model.drives.end(), let_go)) {
    releases_ = std::make_unique<Releases<D>>(model);
    return;
  }
  if (model.collision != Collision::handout && !bonded_)
    contact_ = std::make_unique<ContactStep<D>>(model, paths_);
  suspects_.reserve(model.bodies.size());
  watch_every_ = std::max<std::int64_t>(1, std::llround(value(model.rate) / 60));
}

template <int D>
Stepper<D>::~Stepper() = default;

template <int D>
void Stepper<D>::begin(State<D>& state) {
  // fixed bodies do not move, whatever velocity the scene gives
  for (int body = 0; body < int(model_.bodies.size()); ++body) {
    if (!model_.bodies[body].fixed) continue;
    state.v[body].setZero();
    if (const int k = turning(state, body); k >= 0) state.spin[k].setZero();
  }
  if (events_) return events_->begin(state);
  if (releases_) return releases_->begin(state);
  try {
    drives_.put(state, time({state.step, 0}, model_.rate));
  } catch (const NotFinite&) {
    // the first step tells of it
  }
  state.released.resize(model_.drives.size());
  if (bonded_) return bonded_->begin(state);
  state.grips.resize(model_.mice.size());
  state.blasts.resize(model_.explosions.size());
  state.work.resize(model_.books_work() ? 1 : 0);
  if (D == 3) state.body_spin.resize(state.turn.size());
  if (contact_) {
    state.frozen.resize(model_.bodies.size()), state.quiet.resize(model_.bodies.size());
    state.broken.resize(model_.joints.size());
    state.joint_forces.resize(model_.joints.size(), Vec<D>::Zero());
    state.joint_torques.resize(model_.joints.size(), AngularVec<D>::Zero());
    if (wound_ropes_) state.wound.resize(model_.joints.size());
  }
  follow(model_, state);
  if (contact_) contact_->begin(state);
  state.touches.reserve(2 * model_.bodies.size() + 16);
  touch_script(state, {state.step, 0});
  divergence_.start(state, time({state.step, 0}, model_.rate));
}

template <int D>
bool Stepper<D>::fits(const State<D>& state) {
  return sim::fits(state, model_) && (events_ || sound(state)) && (!bonded_ || bonded_->fits(state)) &&
         (!events_ || events_->fits(state));
}

template <int D>
const Model<D>& Stepper<D>::model(const State<D>& state) const {
  return events_ ? events_->model(state) : releases_ ? releases_->model(state) : model_;
}

// after bodies have been let go, too: this stepper knows nothing of the steps before
template <int D>
void Stepper<D>::begin_anew(State<D>& state, double t) {
  if (events_) return events_->begin_anew(state, t);
  if (releases_) return releases_->begin_anew(state, t);
  if (contact_) contact_->begin_anew();
  divergence_.start(state, t);
}

template <int D>
void Stepper<D>::watch(Course<D>* course) {
  if (releases_) releases_->watch(course);
  if (contact_) contact_->watch(course);
}

template <int D>
std::optional<Trouble> Stepper<D>::step(State<D>& state) {
  if (events_) return events_->step(state);
  if (auto trouble = go(state, 0, 1)) return trouble;
  return after_step(state);
}

// goes on within a step; with bonds only from its beginning
template <int D>
std::optional<Trouble> Stepper<D>::go(State<D>& state, double from, double to) {
  if (bonded_) return to < 1 ? bonded_->partial_step(state, to) : bonded_->step(state);
  if (releases_) return releases_->advance(state, from, to);
  return advance(state, from, to);
}

template <int D>
std::optional<Trouble> Stepper<D>::after_step(const State<D>& state) {
  if (bonded_) return {};
  return releases_ ? releases_->check_energy(state) : check_energy(state);
}

template <int D>
std::optional<Trouble> Stepper<D>::check_energy(const State<D>& state) {
  if (state.step % watch_every_ == 0 && may_gain(state))
    return divergence_.check_energy(state, time({state.step, 0}, model_.rate));
  return {};
}

// whether energy from nowhere would be the scheme's fault
template <int D>
bool Stepper<D>::may_gain(const State<D>& state) const {
  return springs_ && !blasting(state);
}

template <int D>
std::optional<Trouble> Stepper<D>::diverges(const State<D>& state) const {
  if (bonded_ || releases_ || events_ || !may_gain(state)) return {};
  return divergence_.check_energy(state, time({state.step, 0}, model_.rate));
}

template <int D>
std::optional<Trouble> Stepper<D>::partial_step(State<D>& state, double fraction) {
  return events_ ? events_->partial_step(state, fraction) : go(state, 0, fraction);
}

template <int D>
std::optional<Trouble> Stepper<D>::advance(State<D>& state, double from, double fraction) {
  try {
    return advance_pieces(state, from, fraction);
  } catch (const NotFinite& found) {
    return found.trouble;
  }
}

// where a step that goes from one fraction to another is cut: at an edge of the script, at a jump of a
// formula
template <int D>
double Stepper<D>::next_cut(std::int64_t step, double from, double to) {
  if (bonded_) return to;
  const auto edge = std::upper_bound(edges_.begin(), edges_.end(), TimeStamp{step, from},
                                     [](TimeStamp at, const ScriptEvent& e) { return at < e.at; });
  if (edge != edges_.end() && edge->at.step == step && edge->at.fraction < to) to = edge->at.fraction;
  return jumps_.cut(step, from, to);
}

template <int D>
std::optional<Trouble> Stepper<D>::advance_pieces(State<D>& state, double from, double fraction) {
  if (from == 0) state.touches.clear();
  const double h = step_length(model_.rate);
  while (from < fraction) {
    double to = next_cut(state.step, from, fraction);
    if (contact_ && wound_ropes_)
      if (const auto wheel = wheel_time(model_, state, (to - from) * h)) to = from + *wheel / h;
    const double begun = time({state.step, from}, model_.rate), ended = time({state.step, to}, model_.rate);
    divergence_.spring_angles(state, spring_angles_);
    if (!contact_) plan(state);
    books_by_stage_ = !contact_ && dynamics_.size() == 0 && forces_.any();
    if (!books_by_stage_) work_.open(state);
    if (contact_) {
      note_ropes(state);
      contact_->step(state, begun, (to - from) * h);
      drives_.put(state, ended);
      if (!sound(state)) return divergence_.check_bounds(state, ended);
      work_.close(state, begun, (to - from) * h);
      suspects_.clear();
      for (const int body : by_handout_) handout_.look(state, body, 1, suspects_);
      handout_.collide(state, suspects_, ended);
      if (auto trouble = follow_pulleys(state, ended, (to - from) * h)) return trouble;
    } else {
      suspects_.clear();
      const bool sound = integrate(state, begun, (to - from) * h);
      drives_.put(state, ended);
      if (!sound) return divergence_.check_bounds(state, ended);
      if (!books_by_stage_) work_.close(state, begun, (to - from) * h);
      if (!std::is_sorted(suspects_.begin(), suspects_.end())) std::sort(suspects_.begin(), suspects_.end());
      handout_.collide(state, suspects_, ended);
    }
    if (auto trouble = divergence_.check_turns(spring_angles_, state, ended)) return trouble;
    if (to < 1) touch_script(state, {state.step, to});
    from = to;
  }
  if (fraction < 1) {
    state.beyond = fraction * h;
    return {};
  }
  ++state.step;
  touch_script(state, {state.step, 0});
  if (contact_ && state.step % watch_every_ == 0) {
    const double t = time({state.step, 0}, model_.rate);
    if (auto trouble = divergence_.check_squeezed(state, t)) return trouble;
    return divergence_.check_joints(state, t);
  }
  return {};
}

// how bodies on ropes on wheels stand before these go on
template <int D>
void Stepper<D>::note_ropes(const State<D>& state) {
  if (!wound_ropes_) return;
  before_piece_.resize(model_.bodies.size());
  for (const Joint<D>& joint : model_.joints) {
    if (!winds(joint)) continue;
    joint.each_body([&](int body) {
      if (body >= 0) before_piece_[std::size_t(body)] = body_motion(state, body);
    });
  }
}

// ropes to where they are now, after `done` s
template <int D>
std::optional<Trouble> Stepper<D>::follow_pulleys(State<D>& state, double t, double done) const {
  if (!pulleys_) return {};
  const std::optional<EndOfRope> ended = follow_ropes(model_, state, before_piece_, done);
  if (!ended) return {};
  const std::string& name = model_.joints[std::size_t(ended->joint)].name;
  const char* const advice = "end the run before, or release the rope by a condition";
  if (ended->beyond)
    return Trouble{t, name, "rope", "comes around to the other side of a wheel that it has left", advice};
  return Trouble{t, name, "straight piece", "has no length left: its end comes to what the rope runs over",
                 advice};
}

template <int D>
void Stepper<D>::touch_script(State<D>& state, TimeStamp at) {
  auto edge = std::lower_bound(edges_.begin(), edges_.end(), at,
                               [](const ScriptEvent& e, TimeStamp b) { return e.at < b; });
  for (; edge != edges_.end() && edge->at == at; ++edge) {
    if (edge->kind == ScriptEvent::Kind::blast) blasts_.begin(state, edge->mouse);
    if (edge->kind == ScriptEvent::Kind::calm) {
      // its work was counted: it is no unexplained gain of energy
      blasts_.end(state, edge->mouse);
      divergence_.start(state, time(at, model_.rate));
    }
    if (edge->kind != ScriptEvent::Kind::press && edge->kind != ScriptEvent::Kind::release) continue;
    Grip<D>& grip = state.grips[edge->mouse];
    if (edge->kind == ScriptEvent::Kind::press)
      grip = closest(model_, state, model_.mice[edge->mouse].path.front().place);
    if (edge->kind == ScriptEvent::Kind::release) grip = {};
  }
}

template <int D>
bool Stepper<D>::pressed(int mouse, TimeStamp at) const {
  return !(at < press_times_[mouse]) && at < release_times_[mouse];
}

// which bodies move freely and which are coupled by forces, anew whenever a mouse takes or lets go
template <int D>
void Stepper<D>::plan(const State<D>& state) {
  bool known = planned_ && gripped_.size() == state.grips.size() && blasting_ == blasting(state);
  for (std::size_t i = 0; known && i < gripped_.size(); ++i) known = gripped_[i] == state.grips[i].body;
  if (known) return;
  gripped_.clear();
  for (const Grip<D>& grip : state.grips) gripped_.push_back(grip.body);
  planned_ = true, blasting_ = blasting(state);
  dynamics_.gather(state);

  const int bodies = int(model_.bodies.size()), still = bodies - int(state.turn.size());
  const auto free = [&](int body) { return !model_.bodies[body].fixed && !dynamics_.has(body); };
  const auto cut = [&](int from, std::vector<Block>& blocks) {
    blocks.clear();
    for (int body = from; body < bodies;) {
      if (!free(body)) {
        ++body;
        continue;
      }
      const int first = body;
      while (body < bodies && body < first + kBlock && free(body)) ++body;
      blocks.push_back({first, body - first});
    }
  };
  cut(0, flying_);
  cut(still, spinning_);
  for (Block& block : spinning_) block.first -= still;

  stages_.reserve(std::max<std::size_t>(std::size_t(dynamics_.size()), d_.size()));
}

// false where a number ran away
template <int D>
bool Stepper<D>::integrate(State<D>& state, double t, double h) {
  bool sound = true;
  for (const Block& block : flying_) sound = step_flying(state, block, t, h) && sound;
  for (const Block& block : spinning_) sound = step_spins(state, block, t, h) && sound;
  return step_tied(state, t, h) && sound;
}

// whether every number is one, and none ran away
template <int D>
bool Stepper<D>::sound(const State<D>& state) const {
  const double limit = kFarthest * model_.scale;
  std::int64_t sound = within(state.x[0].data(), D * int(state.x.size()), limit) |
                       within(state.v[0].data(), D * int(state.v.size()), limit);
  for (std::size_t k = 0; k < state.turn.size(); ++k) sound |= turn_within_limits(state, k);
  return sound >= 0;
}

// below zero if an orientation or a spin is no number, or ran away
template <int D>
std::int64_t Stepper<D>::turn_within_limits(const State<D>& state, std::size_t k) const {
  return within(state.turn[k].data(), int(state.turn[k].size()), kFarthest * kFarthest) |
         within(state.spin[k].data(), kAngular<D>, spin_limits_[k]);
}

template <int D>
bool Stepper<D>::step_flying(State<D>& state, Block block, double t, double h) {
  const std::size_t n = std::size_t(D) * block.count;
  double* const x = state.x[block.first].data();
  const std::span<double> v(state.v[block.first].data(), n);
  if (forces_.any()) {
    const double work = forced_flight_.step(integrate_, state, block.first, block.count, t, h, stages_);
    if (books_by_stage_) state.work[0] += work;
  } else {
    const auto drag = drag_.empty() ? std::span<const double>()
                                    : std::span<const double>(drag_).subspan(D * block.first, n);
    const std::span<double> d(d_.data(), n);
    std::fill(d.begin(), d.end(), 0.0);
    FreeTranslation flight(gravity_, drag);
    integrate_(flight, t, h, d, v, stages_);
    for (std::size_t i = 0; i < n; ++i) x[i] += d[i];
  }

  const double limit = kFarthest * model_.scale;
  const std::int64_t sound = within(x, int(n), limit) | within(v.data(), int(n), limit);
  handout_.look(state, block.first, block.count, suspects_);
  return sound >= 0;
}

template <int D>
bool Stepper<D>::step_spins(State<D>& state, Block block, double t, double h) {
  const std::size_t n = std::size_t(kAngular<D>) * block.count;
  const std::span<double> w(w_.data(), n), d(d_.data(), n);
  std::fill(d.begin(), d.end(), 0.0);
  const bool whole = model_.integrator == Integrator::semi_implicit;
  for (int i = 0; i < block.count; ++i)
    load_spin(state, block.first + i, whole, base_[i], w.data() + kAngular<D> * i);
  const std::span<const AngularVec<D>> moments(inertia_), base(base_);
  TorqueFreeRotation<D> spinning(moments.subspan(block.first, block.count), base.first(block.count));
  integrate_(spinning, t, h, d, w, stages_);

  std::int64_t sound = 0;
  for (int i = 0; i < block.count; ++i) {
    const int k = block.first + i;
    const int at = kAngular<D> * i;
    const int pieces = wobbles<D>(inertia_[k]) ? pieces_of_turn<D>(state.spin[k], h) : 1;
    if (pieces > 1)
      step_spins(state, k, pieces, t, h);
    else
      store_spin<D>(state, k, Orientation<D>(state.turn[k]), d.data() + at, base_[i], w.data() + at);
    sound |= turn_within_limits(state, std::size_t(k));
  }
  return sound >= 0;
}

// the turn of one body in so many pieces
template <int D>
void Stepper<D>::step_spins(State<D>& state, int k, int pieces, double t, double h) {
  AngularVec<D> base;
  std::array<double, kAngular<D>> d, w;
  for (int i = 0; i < pieces; ++i) {
    load_spin(state, k, model_.integrator == Integrator::semi_implicit, base, w.data());
    d.fill(0);
    TorqueFreeRotation<D> spinning(std::span(&inertia_[k], 1), std::span(&base, 1));
    integrate_(spinning, t + i * (h / pieces), h / pieces, d, w, stages_);
    store_spin<D>(state, k, Orientation<D>(state.turn[k]), d.data(), base, w.data());
  }
}

template <int D>
bool Stepper<D>::step_tied(State<D>& state, double t, double h) {
  dynamics_.step(integrate_, state, t, h, stages_);
  if (!state.work.empty()) state.work[0] += dynamics_.work();
  const double limit = kFarthest * model_.scale;
  std::int64_t sound = 0;
  const auto look = [&](int body) {
    sound |= within(state.x[body].data(), D, limit) | within(state.v[body].data(), D, limit);
    if (const int k = turning(state, body); k >= 0) sound |= turn_within_limits(state, std::size_t(k));
  };
  for (const int body : dynamics_.bodies()) {
    look(body);
    handout_.look(state, body, 1, suspects_);
  }
  for (const int body : dynamics_.chains().links()) look(body);  // which touch nothing by the handout
  return sound >= 0;
}

template class Stepper<2>;
template class Stepper<3>;

}  // namespace obscura::sim
