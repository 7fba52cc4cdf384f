#include "sim/step/contact_step.h"

namespace obscura::sim {

namespace {

constexpr double kAll = 1e300;
constexpr double kSinks = 1e-6;   // of what it could fall for
constexpr double kSwings = 1e-2;  // of its motion on joints: the error of a step of second order

}  // namespace

template <int D>
ContactStep<D>::ContactStep(const Model<D>& model, const std::vector<Path<D>>& paths)
    : model_(model),
      direct_(solver(model) == Solver::direct),
      solver_(make_contact_solver(model, paths)),
      energy_guard_(model) {
  if (!direct_) lone_bodies_ = std::make_unique<LoneBodies<D>>(model, paths);
}

template <int D>
void ContactStep<D>::step(State<D>& state, double t, double h) {
  // what lets go within the step is no longer told after it
  touched_.clear();
  for (const Contact<D>& contact : state.contacts) {
    if (!direct_) break;
    touched_.emplace_back(contact.key.a, contact.key.b);
  }
  energy_guard_.open(state, t);
  if (lone_bodies_) lone_bodies_->find(state, h);

  solver_->step(state, t, h);
  if (lone_bodies_) lone_bodies_->step(state, t, h);
  take_energy_back(state);
}

// contact may only take
template <int D>
void ContactStep<D>::take_energy_back(State<D>& state) {
  // what overlaps at the start is to be lifted apart
  if (model_.overlap == Overlap::separate || !energy_guard_.risen(state)) return;
  for (const auto& [a, b] : touched_) energy_guard_.touch(a, b);
  for (const Contact<D>& contact : state.contacts) energy_guard_.touch(contact.key.a, contact.key.b);
  // so is what overlaps by next to nothing; joints of second order give and take; and a heap that is put
  // right sixty times a second has sunk by as much between
  const double share = state.step == 0 ? kAll : D == 2 && !direct_ ? kSinks : 0;
  for (int i = 0; share > 0 && i < int(model_.bodies.size()); ++i) energy_guard_.excuse(i, share);
  for (const Joint<D>& joint : model_.joints) {
    if (direct_) break;
    for (const int body : {joint.a.body, joint.b.body}) {
      if (body >= 0 && state.step > 0) energy_guard_.excuse(body, kSinks, kSwings);
    }
  }
  energy_guard_.take_back(state);
}

template class ContactStep<2>;
template class ContactStep<3>;

}  // namespace obscura::sim
