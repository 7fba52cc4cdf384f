// A step with conditions: it is gone through, what becomes true in it is found (event_course.cpp,
// event_values.cpp), and where that changes the room, the step is taken again up to there.

#include "sim/step/events.h"

#include <algorithm>
#include <tuple>

#include "sim/collide/pair_candidates.h"
#include "sim/constraint/joints/joint.h"
#include "sim/energy/energy.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/archive.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

namespace {

constexpr double kAtStart = 1e-11;  // of a step: what is as near happens where the course begins
constexpr int kMostCuts = 1000;     // of a step
constexpr std::size_t kMostHappenings = 100'000;

// gives a body another value, forces that act on it too; with a mass moments of inertia in proportion
template <int D>
void give_body(Model<D>& model, const Change<D>& change) {
  using Of = typename Change<D>::Of;
  const auto give = [&](auto& it) {
    switch (change.of) {
      case Of::mass:
        it.mass = change.value;
        break;
      case Of::charge:
        it.charge = change.value;
        break;
      case Of::drag:
        it.drag = change.value;
        break;
      case Of::quadratic_drag:
        it.quadratic_drag = change.value;
        break;
      default:
        break;
    }
  };
  Body<D>& its = model.bodies[std::size_t(change.index)];
  if (change.of == Of::mass) its.inertia *= change.value / its.mass;
  give(its);
  for (Force<D>& force : model.forces) {
    for (Subject<D>& subject : force.subjects)
      if (subject.body == change.index) give(subject);
    if (force.center && force.center->body == change.index) give(*force.center);
  }
}

}  // namespace

template <int D>
Events<D>::Events(const Model<D>& model) : model_(model), exact_(model.collision == Collision::event) {
  // bonded bodies are told of at the ends of steps
  exact_ = exact_ && model.bonds.empty();
  const std::size_t n = model.bodies.size();
  course_.watched.assign(n, 0), course_.pieces.resize(n);
  int slots = 0;
  for (const When<D>& when : model.whens) {
    slots_.push_back(slots);
    slots += when.things();
    times_.push_back(snapped_stamp(when.time, model.rate));
    evaluation_of_.push_back(when.value ? int(evaluations_.size()) : -1);
    std::vector<int>& read = read_.emplace_back();
    if (when.value) {
      evaluations_.emplace_back(*when.value);
      evaluations_.back().begin({});
      for (const Reading& it : when.reads)
        if (!it.of_forces()) read.push_back(it.body);
    }
    if (when.on == On::crosses) read = when.those;
    for (const auto& [a, b] : when.pairs) {
      read.push_back(a);
      if (b >= 0) read.push_back(b);
    }
    std::sort(read.begin(), read.end());
    read.erase(std::unique(read.begin(), read.end()), read.end());
    for (const int body : read) course_.watched[std::size_t(body)] = 1;
  }
}

template <int D>
Events<D>::~Events() = default;

template <int D>
double Events<D>::seconds(double fraction) const {
  return fraction * step_length(model_.rate);
}

template <int D>
double Events<D>::time_at(const State<D>& state, double fraction) const {
  return time({state.step, fraction}, model_.rate);
}

// now_ and its stepper for what has been changed in this state
template <int D>
void Events<D>::make(const State<D>& state) {
  std::vector<char> released = state.released;
  released.resize(model_.drives.size());
  std::vector<int> changes = state.events.changes;
  std::erase_if(changes, [&](int number) {
    const Change<D>& it = model_.changes[std::size_t(number)];
    return it.of == Change<D>::Of::join && state.broken[std::size_t(it.index)];
  });
  if (stepper_ && made_released_ == released && made_changes_ == changes && made_joints_ == state.made)
    return;
  made_released_ = std::move(released), made_changes_ = std::move(changes), made_joints_ = state.made;
  stepper_.reset();
  now_ = model_;
  now_.whens.clear();
  // one solver serves all of the run: the one for all that will ever move
  if (now_.collision == Collision::contact && now_.solver == Solver::automatic) {
    for (const Drive<D>& drive : model_.drives)
      if (drive.release || drive.by_event) now_.bodies[std::size_t(drive.body)].fixed = false;
    now_.solver = solver(now_);
    now_.bodies = model_.bodies;
  }
  for (std::size_t i = 0; i < now_.drives.size(); ++i) {
    if (!made_released_[i]) continue;
    now_.drives[i].release.reset();
    Body<D>& body = now_.bodies[std::size_t(now_.drives[i].body)];
    body.fixed = body.driven = false;
  }
  for (const int number : made_changes_) {
    const Change<D>& change = model_.changes[std::size_t(number)];
    switch (change.of) {
      case Change<D>::Of::hold:
        now_.bodies[std::size_t(change.index)].fixed = true;
        now_.bodies[std::size_t(change.index)].driven = false;
        break;
      case Change<D>::Of::motor:
        now_.joints[std::size_t(change.index)].motor = change.motor;
        break;
      case Change<D>::Of::gravity:
        now_.gravity = change.gravity;
        break;
      case Change<D>::Of::force:
        now_.forces[std::size_t(change.index)] = *change.force;
        break;
      case Change<D>::Of::join:
        join_as(now_.joints[std::size_t(change.index)], state.made[std::size_t(change.index)]);
        break;
      case Change<D>::Of::loose:
        now_.springs[std::size_t(change.index)].loose = change.value != 0;
        break;
      case Change<D>::Of::stiffness:
        now_.springs[std::size_t(change.index)].stiffness = change.value;
        break;
      case Change<D>::Of::damping:
        now_.springs[std::size_t(change.index)].damping = change.value;
        break;
      case Change<D>::Of::rest_length:
        now_.springs[std::size_t(change.index)].rest_length = change.value;
        break;
      case Change<D>::Of::rub:
        now_.joints[std::size_t(change.index)].friction = change.value;
        break;
      case Change<D>::Of::belt:
        now_.bodies[std::size_t(change.index)].belt = change.spin;
        break;
      default:
        break;  // of bodies, below: forces have them, too; or of an instant
    }
  }
  for (Spring<D>& spring : now_.springs)
    if (spring.loose) spring.stiffness = spring.damping = 0;
  for (const int number : made_changes_) {
    const Change<D>& change = model_.changes[std::size_t(number)];
    if (change.of >= Change<D>::Of::mass && change.of <= Change<D>::Of::quadratic_drag)
      give_body(now_, change);
  }
  probes_ =
      model_.bonds.empty() && (now_.collision == Collision::event ||
                               (now_.collision == Collision::contact && solver(now_) == Solver::direct));
  iterates_ = now_.collision == Collision::contact && solver(now_) == Solver::iterative;
  stepper_ = std::make_unique<Stepper<D>>(now_);
  stepper_->watch(&course_);
}

template <int D>
const Model<D>& Events<D>::model(const State<D>& state) {
  make(state);
  return stepper_->model(state);
}

template <int D>
bool Events<D>::fits(const State<D>& state) {
  if (has_later_joints(model_) &&
      (state.made.size() != model_.joints.size() || state.broken.size() != model_.joints.size()))
    return false;
  make(state);
  State<D> plain = state;
  plain.events = {};
  return stepper_->fits(plain);
}

template <int D>
void Events<D>::begin_anew(State<D>& state, double t) {
  make(state);
  stepper_->begin_anew(state, t);
}

template <int D>
void Events<D>::begin(State<D>& state) {
  state.events = {};
  state.released.assign(model_.drives.size(), 0);
  if (has_later_joints(model_)) state.made.resize(model_.joints.size());
  make(state);
  stepper_->begin(state);
  int all = 0;
  for (const When<D>& when : model_.whens) all += when.things();
  state.events.on.assign(std::size_t(all), 0);
  state.events.done.assign(model_.whens.size(), 0);
  begun_ = state;
  course_.clear();
  note_truths(state, 0, 0);
  // what touches at the start has not come to touch
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    for (int k = 0; k < int(when.pairs.size()); ++k) {
      const auto [a, b] = when.pairs[std::size_t(k)];
      state.events.on[std::size_t(slot(w, k))] =
          !pair_candidates(model_, state, a, b, kTouchingGap * model_.scale).empty();
    }
  }
  // times that are the start
  std::vector<Due> actions;
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    if (model_.whens[std::size_t(w)].on != On::time || !(times_[std::size_t(w)] == TimeStamp{state.step, 0}))
      continue;
    note_fired(state, {0, w, 0, true, 0}, {state.step, 0});
    for (const Action& action : model_.whens[std::size_t(w)].actions) actions.push_back({&action, 0});
  }
  carry_out(state, actions, {state.step, 0});
}

template <int D>
std::optional<Trouble> Events<D>::step(State<D>& state) {
  if (auto trouble = advance(state, 1)) return trouble;
  return state.events.stopped ? std::nullopt : stepper_->after_step(state);
}

template <int D>
std::optional<Trouble> Events<D>::partial_step(State<D>& state, double fraction) {
  return advance(state, fraction);
}

// where the next time that changes something cuts the step, or the script, or a jump; `to` where none does
template <int D>
double Events<D>::cut_after(const State<D>& state, double from, double to) const {
  double first = to;
  for (std::size_t w = 0; w < model_.whens.size(); ++w) {
    const When<D>& when = model_.whens[w];
    const TimeStamp at = times_[w];
    if (when.on != On::time || when.only_marks() || state.events.done[w] || at.step != state.step) continue;
    if (at.fraction > from && at.fraction < first) first = at.fraction;
  }
  return stepper_->next_cut(state.step, from, first);
}

template <int D>
std::optional<Trouble> Events<D>::too_many(const State<D>& state) const {
  const Happening& last = state.events.happenings.back();
  Trouble trouble;
  trouble.time = time({last.step, last.fraction}, model_.rate);
  trouble.body = model_.whens[std::size_t(last.when)].name;
  trouble.quantity = "condition";
  trouble.what = "becomes true again and again";
  trouble.likely = "its own actions may make it true each time: leave out 'again', or ask for more in it";
  return trouble;
}

// from the beginning of a step to a fraction of it, from event to event
template <int D>
std::optional<Trouble> Events<D>::advance(State<D>& state, double to) {
  make(state);
  double from = 0;
  for (int cuts = 0; from < to && !state.events.stopped; ++cuts) {
    if (cuts > kMostCuts || state.events.happenings.size() > kMostHappenings) return too_many(state);
    const double end = cut_after(state, from, to);
    begun_ = state;
    course_.clear();
    if (auto trouble = stepper_->go(state, from, end)) return trouble;
    sort_meetings();

    // a frame between two steps sees what the step has only at its end
    found_.clear();
    find(state, from, end, !(exact_ || end == 1 || end < to));
    find_times(begun_, from, end);
    std::erase_if(found_, [&](Found& each) { return !confirm(state, each, from, end); });
    for (Found& each : found_) {
      if (exact_) search(each, from, end);
      if (joins(model_.whens[std::size_t(each.when)])) search_touch(each, from, end);
    }
    touch_with_these(state);
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.at < b.at; });

    bool cut = false;
    for (std::size_t i = 0, j; i < found_.size() && !cut; i = j) {
      const double at = found_[i].at;
      const double together = exact_ ? kSameInstant : 2 * kTouchTime;
      for (j = i; j < found_.size() && found_[j].at - found_[j].before - at <= together; ++j) {
      }
      std::sort(found_.begin() + std::ptrdiff_t(i), found_.begin() + std::ptrdiff_t(j),
                [](const Found& a, const Found& b) {
                  return a.when != b.when ? a.when < b.when : a.which < b.which;
                });
      const TimeStamp stamp = at < 1 ? TimeStamp{begun_.step, at} : TimeStamp{begun_.step + 1, 0};
      std::vector<Due> actions;
      double cut_at = at;
      for (std::size_t k = i; k < j; ++k) {
        cut_at = std::max(from, std::min(cut_at, found_[k].at - found_[k].before));
        // two that bounce twice in a step come to touch once where they are joined
        if (k > i && found_[k].when == found_[k - 1].when && found_[k].which == found_[k - 1].which) continue;
        if (!note_fired(state, found_[k], stamp)) continue;
        const When<D>& when = model_.whens[std::size_t(found_[k].when)];
        if (when.only_marks()) continue;
        for (const Action& action : when.actions) actions.push_back({&action, found_[k].which});
      }
      if (actions.empty()) continue;
      cut = true;
      if (cut_at < end) {
        // back, and up to here
        EventLog log = std::move(state.events);
        state = begun_;
        state.events = std::move(log);
        course_.clear();
        if (cut_at - from > kAtStart) {
          if (auto trouble = stepper_->go(state, from, cut_at)) return trouble;
          sort_meetings();
          state.beyond = 0;
        }
      }
      note_truths(state, from, cut_at);
      for (std::size_t k = i; k < j; ++k) {
        const On on = model_.whens[std::size_t(found_[k].when)].on;
        state.events.on[std::size_t(slot(found_[k].when, found_[k].which))] = on == On::crosses
                                                                                  ? found_[k].side
                                                                              : on == On::leaves ? 0
                                                                                                 : 1;
      }
      join_with_these(state, stamp, actions);
      carry_out(state, actions, stamp);
      from = cut_at;
    }
    if (cut) {
      if (from < to) state.beyond = 0;
      continue;
    }
    note_truths(state, from, end);
    if (end < to) state.beyond = 0;
    from = end;
  }
  if (state.events.stopped && from < to) {
    if (to == 1) {
      ++state.step;
      state.touches.clear();
    } else {
      state.beyond = seconds(to);
    }
  }
  return {};
}

// in the order of their pairs
template <int D>
void Events<D>::sort_meetings() {
  using Meeting = typename Course<D>::Meeting;
  std::sort(course_.meetings.begin(), course_.meetings.end(), [](const Meeting& p, const Meeting& q) {
    return std::tuple(p.a, p.b, p.begun, p.ended) < std::tuple(q.a, q.b, q.begun, q.ended);
  });
}

// notes that a condition has become true; whether it fires
template <int D>
bool Events<D>::note_fired(State<D>& state, const Found& found, TimeStamp at) {
  char& done = state.events.done[std::size_t(found.when)];
  if (done && !model_.whens[std::size_t(found.when)].again) return false;
  done = 1;
  state.events.happenings.push_back({found.when, found.which, at.step, at.fraction});
  return true;
}

// does what is asked for at one instant. What the room's hand gives by it of energy is work.
template <int D>
void Events<D>::carry_out(State<D>& state, const std::vector<Due>& actions, TimeStamp at) {
  bool any = false;
  std::vector<const Change<D>*> kicks;
  std::vector<std::size_t> joined;
  for (const auto& [action, which] : actions) {
    if (action->what == Action::Do::stop) state.events.stopped = 1;
    any = any || (action->what != Action::Do::stop && action->what != Action::Do::mark);
  }
  if (!any) return;
  const double t = time(at, model_.rate);
  const double before = energies(stepper_->model(state), state, stepper_->paths(), t).total();
  std::vector<int>& changes = state.events.changes;
  for (const auto& [action, which] : actions) {
    for (std::size_t i = 0; i < action->of.size(); ++i) {
      if (action->of_pair && int(i) != which) continue;
      const int of = action->of[i];
      if (of < 0) continue;
      switch (action->what) {
        case Action::Do::let_go: {
          const int body = model_.drives[std::size_t(of)].body;
          state.released[std::size_t(of)] = 1;
          std::erase_if(changes, [&](int c) {
            const Change<D>& it = model_.changes[std::size_t(c)];
            return it.of == Change<D>::Of::hold && it.index == body;
          });
          break;
        }
        case Action::Do::part:
          if (std::size_t(of) < state.broken.size() && !state.broken[std::size_t(of)])
            state.broken[std::size_t(of)] = 1;
          known_broken(state, of, true);
          std::erase_if(changes, [&](int c) {
            const Change<D>& it = model_.changes[std::size_t(c)];
            return it.of == Change<D>::Of::join && it.index == of;
          });
          break;
        case Action::Do::change: {
          const Change<D>& made = model_.changes[std::size_t(of)];
          const bool joins = made.of == Change<D>::Of::join;
          if (joins && !state.broken[std::size_t(made.index)]) break;
          if (made.of == Change<D>::Of::velocity || made.of == Change<D>::Of::spin) {
            kicks.push_back(&made);
            break;
          }
          std::erase_if(changes, [&](int c) { return model_.changes[std::size_t(c)].replaces(made); });
          changes.push_back(of);
          if (joins) {
            joined.push_back(std::size_t(made.index)), state.broken[joined.back()] = 0;
            known_broken(state, made.index, false);
          }
          if (made.of != Change<D>::Of::hold) break;
          state.v[std::size_t(made.index)].setZero();
          if (const int k = turning(state, made.index); k >= 0) state.spin[std::size_t(k)].setZero();
          break;
        }
        default:
          break;
      }
    }
  }
  const auto on_wheels = [&](std::size_t joint) { return winds(model_.joints[joint]); };
  if (std::any_of(joined.begin(), joined.end(), on_wheels)) leave_wheels(model_, state);
  for (const std::size_t joint : joined) state.made[joint] = as_it_stands(model_.joints[joint], state, joint);
  if (!state.broken.empty()) break_dependents(model_, state.broken);
  make(state);
  // of what is free now
  if (!kicks.empty()) {
    const State<D> was = state;
    for (const Change<D>* by : kicks) kick(state, was, *by, t);
  }
  const auto given = [&] {
    return energies(stepper_->model(state), state, stepper_->paths(), t).total() - before;
  };
  const double worked = state.work.empty() ? 0 : state.work[0];
  if (!state.work.empty()) state.work[0] += given();
  std::fill(state.frozen.begin(), state.frozen.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0.0);
  stepper_->begin_anew(state, t);
  if (!joined.empty() || !kicks.empty()) take_impulses_of_joining(state, at.fraction, t);
  // a kick works as far as what holds the body lets it
  if (joined.empty() && !kicks.empty() && !state.work.empty()) state.work[0] = worked + given();
}

// gives a body another velocity or spin; formulas read what was before
template <int D>
void Events<D>::kick(State<D>& state, const State<D>& was, const Change<D>& by, double t) {
  if (now_.bodies[std::size_t(by.index)].fixed) return;
  Vec<D> velocity = by.velocity;
  AngularVec<D> spin = by.spin;
  if (by.formula) {
    std::vector<double> values;
    for (const Reading& each : by.reads) values.push_back(read(was, each));
    values.push_back(t);
    std::vector<const double*> slots;
    for (const double& each : values) slots.push_back(&each);
    Evaluation evaluation(*by.formula);
    evaluation.begin({});
    evaluation.run(1, slots);
    const bool turns = by.of == Change<D>::Of::spin;
    for (int k = 0; k < by.formula->outputs(); ++k) (turns ? spin[k] : velocity[k]) = evaluation.output(k)[0];
  }
  if (by.of == Change<D>::Of::velocity) {
    state.v[std::size_t(by.index)] = velocity;
  } else if (const int k = turning(state, by.index); k >= 0) {
    state.spin[std::size_t(k)] = spin;
  }
}

// a joint holds from now on, and may break again; or has been let go, which is no break
template <int D>
void Events<D>::known_broken(State<D>& state, int joint, bool broken) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    for (int k = 0; when.on == On::breaks && k < when.things(); ++k)
      if (when.those[std::size_t(k)] == joint) state.events.on[std::size_t(slot(w, k))] = broken;
  }
}

// Velocities with what has just been joined: after the impulses of this instant, which those of a moment
// from it are.
template <int D>
void Events<D>::take_impulses_of_joining(State<D>& state, double fraction, double t) {
  if (!probe(state, fraction)) return;  // the step itself tells of it
  state.v = probed_.v, state.spin = probed_.spin, state.body_spin = probed_.body_spin;
  state.work = probed_.work;  // of what is moved
  for (std::size_t i = 0; i < state.chain_states.size(); ++i)
    state.chain_states[i].v = probed_.chain_states[i].v;
  stepper_->begin_anew(state, t);
}

// what is true where a course ends, from begun_ to `state`
template <int D>
void Events<D>::note_truths(State<D>& state, double from, double to) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    for (int k = 0; k < when.things(); ++k) {
      char& on = state.events.on[std::size_t(slot(w, k))];
      switch (when.on) {
        case On::touches:
        case On::leaves:
          if (to == from) break;
          spans(state, when.pairs[std::size_t(k)], on != 0, from, to);
          on = !spans_.empty() && to - spans_.back().ended <= kSameInstant;
          break;
        case On::crosses:
          if (const double s = side_of(when, state.x[std::size_t(when.those[std::size_t(k)])]); s != 0)
            on = s > 0 ? 2 : 1;
          break;
        case On::value:
          on = true_now(state, w, to);
          break;
        case On::breaks:
          on = broken(state, when.those[std::size_t(k)]);
          break;
        case On::time:
          break;
      }
    }
  }
}

template class Events<2>;
template class Events<3>;

}  // namespace obscura::sim
