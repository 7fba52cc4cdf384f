// Letting go: the body keeps its place and velocity and is free from then on. What it has then of energy
// enters the books as work: the room's hand gave it.

#include "sim/step/releases.h"

#include <algorithm>

#include "sim/energy/energy.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

template <int D>
Releases<D>::Releases(const Model<D>& model) : model_(model) {
  for (const ScriptEvent& edge : edges(model))
    if (edge.kind == ScriptEvent::Kind::let_go) edges_.push_back(edge);
}

template <int D>
Releases<D>::~Releases() = default;

// now_ and its stepper for what has been let go in this state
template <int D>
void Releases<D>::make(const State<D>& state) {
  std::vector<char> released = state.released;
  released.resize(model_.drives.size());
  if (stepper_ && made_ == released) return;
  made_ = std::move(released);
  stepper_.reset();
  now_ = model_;
  for (std::size_t i = 0; i < now_.drives.size(); ++i) {
    now_.drives[i].release.reset();
    if (!made_[i]) continue;
    Body<D>& body = now_.bodies[std::size_t(now_.drives[i].body)];
    body.fixed = body.driven = false;
  }
  // the solver is the same for the whole run: that of the model with all bodies released
  if (now_.collision == Collision::contact && now_.solver == Solver::automatic) {
    Model<D> all = model_;
    for (const Drive<D>& drive : model_.drives)
      if (drive.release) all.bodies[std::size_t(drive.body)].fixed = false;
    now_.solver = solver(all);
  }
  stepper_ = std::make_unique<Stepper<D>>(now_);
  stepper_->watch(course_);
}

template <int D>
void Releases<D>::begin_anew(State<D>& state, double t) {
  make(state);
  stepper_->begin_anew(state, t);
}

template <int D>
void Releases<D>::watch(Course<D>* course) {
  course_ = course;
  if (stepper_) stepper_->watch(course_);
}

template <int D>
const Model<D>& Releases<D>::model(const State<D>& state) {
  make(state);
  return now_;
}

template <int D>
void Releases<D>::begin(State<D>& state) {
  state.released.assign(model_.drives.size(), 0);
  make(state);
  stepper_->begin(state);
  let_go(state, {state.step, 0});
}

// lets go what is to be let go at this instant
template <int D>
bool Releases<D>::let_go(State<D>& state, TimeStamp at) {
  std::vector<char> now = state.released;
  for (const ScriptEvent& edge : edges_)
    if (edge.at == at) now[std::size_t(edge.mouse)] = 1;
  if (now == state.released) return false;
  const double t = time(at, model_.rate);
  const double before = energies(now_, state, stepper_->paths(), t).total();
  state.released = std::move(now);
  make(state);
  state.work[0] += energies(now_, state, stepper_->paths(), t).total() - before;
  std::fill(state.frozen.begin(), state.frozen.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0.0);
  stepper_->begin_anew(state, t);
  return true;
}

template <int D>
std::optional<Trouble> Releases<D>::advance(State<D>& state, double from, double fraction) {
  make(state);
  const std::int64_t step = state.step;
  for (const ScriptEvent& edge : edges_) {
    const double to = edge.at.fraction;
    if (edge.at.step != step || to <= from || to > fraction) continue;
    if (auto trouble = stepper_->advance(state, from, to)) return trouble;
    state.beyond = 0;
    let_go(state, edge.at);
    from = to;
  }
  if (from < fraction) {
    if (auto trouble = stepper_->advance(state, from, fraction)) return trouble;
  } else {
    state.beyond = fraction * step_length(model_.rate);
  }
  if (fraction == 1) let_go(state, {state.step, 0});
  return {};
}

template <int D>
std::optional<Trouble> Releases<D>::check_energy(const State<D>& state) {
  return stepper_->check_energy(state);
}

template class Releases<2>;
template class Releases<3>;

}  // namespace obscura::sim
