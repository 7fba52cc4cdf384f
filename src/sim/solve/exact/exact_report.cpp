// What a step of the exact solver says of itself: forces of contacts and joints, what joints are loaded
// beyond their strength, and how watched bodies went.

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/pulley.h"
#include "sim/solve/exact/exact.h"

namespace obscura::sim {

template <int D>
void ExactSolver<D>::report(StepPart<D> step) {
  outcome_.contacts.swap(step_.contacts), outcome_.impulses.swap(step_.impulses);
  const auto sooner = [](const auto& p, const auto& q) { return p.key < q.key; };
  std::sort(outcome_.contacts.begin(), outcome_.contacts.end(), sooner);

  activate_all();
  collect_bodies(step.state);
  write_contacts(step.state);
  step.state.on_piece = step_.on_piece;
}

template <int D>
void ExactSolver<D>::write_contacts(State<D>& state) {
  for (std::size_t i = 0; i < outcome_.joint_loads.size(); ++i)
    state.joint_forces[i] = outcome_.joint_loads[i].f, state.joint_torques[i] = outcome_.joint_loads[i].n;
  for (std::size_t i = 0; i < state.wound.size() && limits_.rubs; ++i)
    state.wound[i].drag = outcome_.drags[i];
  for (const Contact<D>& struck : outcome_.impulses) {
    const auto at = std::lower_bound(outcome_.contacts.begin(), outcome_.contacts.end(), struck,
                                     [](const auto& p, const auto& q) { return p.key < q.key; });
    if (at != outcome_.contacts.end() && at->key == struck.key) {
      at->impulse = struck.impulse;
    } else {
      outcome_.contacts.insert(at, struck);
    }
  }
  // contacts of sleeping bodies keep their forces
  std::size_t kept = 0;
  for (Contact<D>& contact : state.contacts) {
    if (response_.moves(contact.key.a) || response_.moves(contact.key.b)) continue;
    contact.impulse.setZero();
    state.contacts[kept++] = contact;
  }
  state.contacts.resize(kept);
  state.contacts.insert(state.contacts.end(), outcome_.contacts.begin(), outcome_.contacts.end());
  std::sort(state.contacts.begin(), state.contacts.end(),
            [](const auto& p, const auto& q) { return p.key < q.key; });
}

// contacts and joints and their forces as they were chosen last; joints of what is frozen keep theirs
template <int D>
void ExactSolver<D>::record_forces(const State<D>& state) {
  outcome_.contacts.clear(), progress_.known = &outcome_.contacts;
  // one that has broken in this step is shown with what broke it
  for (const int i : active_.joints) {
    const bool holds = moves(model_.joints[i]) || holds_any(state, i);
    if (!holds || state.broken[i] != step_.broken[i]) continue;
    outcome_.joint_loads[i] = {};
    if (limits_.rubs) outcome_.drags[std::size_t(i)] = 0;
  }
  record_chain_forces();
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind == Constraint::Kind::contact) continue;
    outcome_.joint_loads[constraint.of] += load(constraint);
    if (constraint.kind == Constraint::Kind::friction && rubs(model_.joints[constraint.of]))
      outcome_.drags[std::size_t(constraint.of)] = f_[constraint.first];
  }
  for (const int i : active_.joints) {
    if (model_.joints[i].coil && moves(model_.joints[i]) && !state.broken[i])
      outcome_.joint_loads[i] += load_of_coil(state, i);
  }
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact) continue;
    const ModeKind kind = modes_[constraint.block].kind;
    if (kind == ModeKind::open) continue;
    Contact<D> contact;
    contact.key = candidates_[constraint.of].key;
    contact.touching = kind == ModeKind::slide               ? ContactMode::slide
                       : kind == ModeKind::at_friction_limit ? ContactMode::at_friction_limit
                                                             : ContactMode::stick;
    contact.point = constraint.point, contact.normal = constraint.normal, contact.gap = constraint.off;
    for (int i = 0; i < D; ++i) contact.force += f_[constraint.first + i] * rows_[constraint.first + i].along;
    outcome_.contacts.push_back(contact);
  }
}

// what the rows of a constraint of a joint put on its a, at the poses at hand
template <int D>
Wrench<D> ExactSolver<D>::load(const Constraint& constraint) const {
  const Joint<D>& joint = model_.joints[constraint.of];
  Wrench<D> sum;
  for (int k = constraint.first; k < constraint.first + constraint.rows; ++k)
    sum += load_on_a(joint, rows_[k], pose(joint.a.body), pose(joint.b.body)) * f_[k];
  return sum;
}

// what its spring does
template <int D>
Wrench<D> ExactSolver<D>::load_of_coil(const State<D>& state, int i) const {
  const Joint<D>& joint = model_.joints[i];
  return coil_load(joint, pose(joint.a.body), pose(joint.b.body), turn_between(state, joint));
}

// what holds through an interval
template <int D>
void ExactSolver<D>::note_contacts(double begun, double ended) {
  if (!course_) return;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact ||
        interval_.modes[constraint.block].kind == ModeKind::open)
      continue;
    const ContactKey& key = candidates_[constraint.of].key;
    if (!course_->watches(key.a) && !course_->watches(key.b)) continue;
    // what lets go is held until its force is a little below zero: it left where that was zero
    double left = ended;
    const double before = interval_.forces[constraint.first], after = f_[constraint.first];
    if (progress_.released == key && before > 0 && after < 0)
      left = begun + (ended - begun) * before / (before - after);
    course_->meetings.push_back({key.a, key.b, begun, left});
  }
}

// an interval of the bodies at hand, from interval_.begun to `state`
template <int D>
void ExactSolver<D>::note_motion(const State<D>& state, double begun, double ended) {
  if (!course_) return;
  for (const int body : active_.subset.bodies) {
    if (!course_->watches(body) || !response_.moves(body)) continue;
    CoursePiece<D> piece{begun, ended, {}, instant(state, body)};
    piece.from.x = interval_.begun.x[body], piece.from.v = interval_.begun.v[body];
    if (const int k = turning(state, body); k >= 0)
      piece.from.turn = interval_.begun.turn[k], piece.from.spin = interval_.begun.spin[k];
    course_->pieces[std::size_t(body)].push_back(piece);
  }
}

// takes away wires whose beads leave them at this instant and, under `event`, joints that are loaded beyond
// their strength; whether there are any
template <int D>
bool ExactSolver<D>::break_loaded(State<D>& state, double done) {
  scratch_.unheld.clear();
  if (limits_.wires) leave_wires(state);
  for (const int i : active_.joints) {
    const Joint<D>& joint = model_.joints[i];
    if (model_.collision != Collision::event) break;
    if (!holds_any(state, int(i)) || !overloaded(joint, outcome_.joint_loads[i])) continue;
    state.broken[i] = 1;
    joint.each_body([&](int body) {
      if (body >= 0) scratch_.unheld.push_back(body);
    });
  }
  if (scratch_.unheld.empty()) return false;
  break_dependents(model_, state.broken);
  for (const int i : active_.joints) {
    const bool known = !course_ || step_.broken[i] || !state.broken[i] ||
                       std::any_of(course_->breaks.begin(), course_->breaks.end(),
                                   [&](const auto& it) { return it.joint == i; });
    if (!known) course_->breaks.push_back({i, done});
  }
  sleep_.wake(state, scratch_.unheld);
  collect_bodies(state);
  return true;
}

// removes joints that are loaded beyond their strength, from the next step on, and wakes the bodies they held
template <int D>
void ExactSolver<D>::break_joints(State<D>& state) {
  scratch_.unheld.clear();
  let_go_of_wires(state);
  for (std::size_t i = 0; i < model_.joints.size(); ++i) {
    const Joint<D>& joint = model_.joints[i];
    if (state.broken[i] || !overloaded(joint, {state.joint_torques[i], state.joint_forces[i]})) continue;
    state.broken[i] = 1;
    joint.each_body([&](int body) {
      if (body >= 0) scratch_.unheld.push_back(body);
    });
  }
  break_dependents(model_, state.broken);
  if (!scratch_.unheld.empty()) sleep_.wake(state, scratch_.unheld);
}

#define OBSCURA_INSTANTIATE(D)                                                 \
  template void ExactSolver<D>::report(StepPart<D>);                           \
  template void ExactSolver<D>::write_contacts(State<D>&);                     \
  template void ExactSolver<D>::record_forces(const State<D>&);                \
  template Wrench<D> ExactSolver<D>::load(const Constraint&) const;            \
  template Wrench<D> ExactSolver<D>::load_of_coil(const State<D>&, int) const; \
  template void ExactSolver<D>::note_contacts(double, double);                 \
  template void ExactSolver<D>::note_motion(const State<D>&, double, double);  \
  template bool ExactSolver<D>::break_loaded(State<D>&, double);               \
  template void ExactSolver<D>::break_joints(State<D>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
