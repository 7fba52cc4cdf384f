#include "sim/step/contact_step.h"

#include <algorithm>

#include "sim/collide/pair_candidates.h"
#include "sim/multibody/chains.h"
#include "sim/solve/iterate/joint_solver.h"

namespace obscura::sim {

namespace {

// gains that the energy guard allows an island
constexpr double kAll = 1e300;
constexpr double kSinks = 1e-6;    // of m g times the height of the room
constexpr double kTouches = 1e-9;  // of that height: an overlap that is none

}  // namespace

template <int D>
ContactStep<D>::ContactStep(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model), paths_(paths), exact_(solver_kind(solver(model)).exact), energy_guard_(model) {
  apart_.assign(model.joints.size(), 0);
  jointed_.assign(model.bodies.size(), 0);
  for (const Joint<D>& joint : model.joints) {
    joint.each_body([&](int body) {
      if (body >= 0) jointed_[std::size_t(body)] = 1;
    });
  }
  build(model);
}

template <int D>
void ContactStep<D>::build(const Model<D>& model) {
  solver_ = make_contact_solver(model, paths_);
  if (!exact_) lone_bodies_ = std::make_unique<LoneBodies<D>>(model, paths_);
  watch(course_);
}

// bodies whose joint has gone, and which have been apart since, may touch
template <int D>
void ContactStep<D>::let_touch(const State<D>& state) {
  bool changed = false, any = false;
  for (std::size_t i = 0; i < apart_.size(); ++i) {
    const char now = state.broken[i] == kGoneApart;
    changed = changed || now != apart_[i], any = any || now;
    apart_[i] = now;
  }
  if (!changed) return;
  auto freed = any ? std::make_unique<Model<D>>(model_) : nullptr;
  for (std::size_t i = 0; i < apart_.size(); ++i)
    if (apart_[i]) freed->joints[i].touching = true;
  build(freed ? *freed : model_);
  freed_ = std::move(freed);
}

// those that are
template <int D>
void ContactStep<D>::find_apart(State<D>& state) {
  for (std::size_t i = 0; i < apart_.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    const int a = joint.a.body, b = joint.b.body;
    if (state.broken[i] != 1 || joint.touching || joint.later || a < 0 || b < 0 ||
        joint.kind == JointKind::pulley || joint.kind == JointKind::gear)
      continue;
    const auto near = pair_candidates(model_, state, a, b, 0);
    const auto deep = [&](const ContactCandidate<D>& it) { return it.value < -kTouches * model_.scale; };
    if (std::none_of(near.begin(), near.end(), deep)) state.broken[i] = kGoneApart;
  }
}

// Velocities that all joints allow, those of chains with those that close their loops; beads come onto their
// wires in the first step.
template <int D>
void ContactStep<D>::begin(State<D>& state) const {
  if (model_.joints.empty() || state.step != 0) return;
  const std::vector<char> broken = state.broken;
  for (std::size_t i = 0; i < model_.joints.size(); ++i)
    if (model_.joints[i].kind == JointKind::wire) state.broken[i] = 1;
  if (model_.chains.empty()) {
    JointSolver<D>(model_).project_initial_velocities(state);
  } else {
    Model<D> jointed = model_;
    jointed.chains.clear();
    for (Body<D>& body : jointed.bodies) body.linked = false;
    for (Joint<D>& joint : jointed.joints) joint.linked = false;
    if (JointSolver<D>(jointed).project_initial_velocities(state)) take_velocities(model_, state);
  }
  state.broken = broken;
}

template <int D>
void ContactStep<D>::step(State<D>& state, double t, double h) {
  let_touch(state);
  // contacts that separate within the step are not reported after it
  touched_.clear();
  for (const Contact<D>& contact : state.contacts)
    if (exact_ || contact.touching != ContactMode::open) touched_.emplace_back(contact.key.a, contact.key.b);
  energy_guard_.open(state, t);
  if (lone_bodies_) lone_bodies_->find(state, t, h);

  solver_->step(state, t, h);
  if (lone_bodies_) lone_bodies_->step(state, t, h);
  take_energy_back(state);
  find_apart(state);
}

// contacts may only take energy
template <int D>
void ContactStep<D>::take_energy_back(State<D>& state) {
  // the work of pushing bodies out of overlaps is recorded and stays
  if (const Vec<D>* ways = solver_->corrections()) {
    pushed_.assign(ways, ways + model_.bodies.size());
    for (int i = 0; i < int(pushed_.size()); ++i)
      if (lone_bodies_ && lone_bodies_->moved(i)) pushed_[std::size_t(i)].setZero();
    state.ledger.displacement += energy_guard_.book_ways(state, pushed_);
  }
  // with overlap = "separate" bodies that overlap at the start may be lifted
  if (model_.overlap == Overlap::separate || !energy_guard_.risen(state)) return;
  for (const auto& [a, b] : touched_) energy_guard_.touch(a, b);
  for (const Contact<D>& contact : state.contacts) {
    // what is near and has given nothing has added none
    if (exact_ || contact.touching != ContactMode::open || !contact.force.isZero(0) ||
        !contact.impulse.isZero(0))
      energy_guard_.touch(contact.key.a, contact.key.b);
  }
  if (const std::vector<char>* pushed = solver_->pushed_by_joints()) {
    for (int i = 0; i < int(pushed->size()); ++i) {
      if ((*pushed)[std::size_t(i)]) energy_guard_.touch(i);
    }
  }
  // The first step may lift bodies out of tiny overlaps. In the plane iterations end before all contacts have
  // settled; their error has both signs, and taking away its gains alone would brake a pile that topples
  // slowly.
  const double share = state.step == 0 ? kAll : D == 2 && !exact_ ? kSinks : 0;
  for (int i = 0; share > 0 && i < int(model_.bodies.size()); ++i) {
    if (state.step == 0 || !jointed_[std::size_t(i)]) energy_guard_.excuse(i, share);
  }
  state.ledger.displacement += energy_guard_.take_back(state, exact_);
}

template class ContactStep<2>;
template class ContactStep<3>;

}  // namespace obscura::sim
