// Conditions are looked for along the course of a step, which solvers note as cubics between impacts:
//   s(t) = n . (x(t) - p)          crosses: all roots of the cubic, from one extremum to the next
//   g(t) = b(t) - a(t)             value: margins of its comparisons a < b, by samples; where samples turn
//   back
//                                  before zero, the extremum between them
// Under `event` the time is then sought on the motion itself: by steps of a part of the step, from its
// beginning, between one before and one after, until both are 1e-12 of a step apart.

#include "sim/step/events.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "sim/collide/narrow_phase.h"
#include "sim/constraint/joints/joint.h"
#include "sim/energy/energy.h"
#include "sim/force/spring.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/archive.h"
#include "sim/step/stepper.h"

namespace obscura::sim {

namespace {

constexpr double kSameInstant = 1e-9;   // of a step: what is as near happens together
constexpr double kAtStart = 1e-11;      // of a step: what is as near happens where the course begins
constexpr double kFound = 1e-12;        // of a step
constexpr double kFirstBracket = 1e-8;  // of a step
constexpr double kLastBracket = 1e-2;
constexpr double kSmooth = 0.2;      // of its speeds: how far they differ in a smooth step
constexpr double kLettingGo = 1e-5;  // of a step
constexpr double kMoment = 1e-9;     // of a step
constexpr int kMostTries = 60;       // partial steps of a search
constexpr int kSamples = 16;         // of a smooth piece
constexpr int kNarrowings = 60;
constexpr double kBeside = 1e-3;  // of the way between two samples
constexpr double kGolden = 0.3819660112501051;
constexpr int kMostCuts = 1000;  // of a step
constexpr std::size_t kMostHappenings = 100'000;
constexpr double kTouchingGap = 1e-9;  // of the room's height: what touches at the start

// whether a joint, or a bond as -1 - bond, is broken
template <int D>
bool broken(const State<D>& state, int of) {
  if (of < 0) return !state.intact.empty() && !state.intact[std::size_t(-1 - of)];
  return std::size_t(of) < state.broken.size() && state.broken[std::size_t(of)];
}

template <int D>
double read(const Instant<D>& at, Reading::Of of) {
  using enum Reading::Of;
  switch (of) {
    case x:
      return at.x[0];
    case y:
      return at.x[1];
    case z:
      return at.x[D - 1];
    case vx:
      return at.v[0];
    case vy:
      return at.v[1];
    case vz:
      return at.v[D - 1];
    case speed:
      return std::sqrt(at.v.squaredNorm());
    case angle:
      return at.turn[0];
    case spin:
      return D == 2 ? at.spin[0] : std::sqrt(at.spin.squaredNorm());
    default:
      return 0;
  }
}

// how a point of a body, or a place of the room, is and moves
template <int D>
std::pair<Vec<D>, Vec<D>> place_and_velocity(const State<D>& state, const End<D>& end) {
  if (end.body < 0) return {end.local, Vec<D>(Vec<D>::Zero())};
  const BodyMotion<D> at = body_motion(state, end.body);
  return {at.x + at.arm(end.local), at.velocity(at.arm(end.local))};
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

// a quantity in a state; of forces how long the sum of what it has from all that touches or holds it is
template <int D>
double Events<D>::read(const State<D>& state, const Reading& of) {
  using enum Reading::Of;
  const int body = of.body;
  if (!of.of_forces()) return sim::read(instant(state, body), of.of);
  const auto known = [&](int joint) { return std::size_t(joint) < state.joint_forces.size(); };
  if (of.of == force) return known(body) ? std::sqrt(state.joint_forces[std::size_t(body)].squaredNorm()) : 0;
  const Model<D>& model = stepper_->model(state);
  Vec<D> sum = Vec<D>::Zero();
  const auto touch = [&](const Vec<D>& push, const Vec<D>& normal) {
    const Vec<D> pressed = push.dot(normal) * normal;
    sum += of.of == contact ? push : of.of == normal_force ? pressed : Vec<D>(push - pressed);
  };
  if (of.of == spring_force) {
    for (const Spring<D>& spring : model.springs) {
      if (spring.a.body != body && spring.b.body != body) continue;
      const auto [a, va] = place_and_velocity(state, spring.a);
      const auto [b, vb] = place_and_velocity(state, spring.b);
      sum += (spring.a.body == body ? 1 : -1) * pull<D>(law(spring), a, va, b, vb);
    }
  } else if (of.of == joint_force) {
    for (int i = 0; i < int(model.joints.size()); ++i) {
      const Joint<D>& joint = model.joints[std::size_t(i)];
      if (known(i) && (joint.a.body == body || joint.b.body == body))
        sum += (joint.a.body == body ? 1 : -1) * state.joint_forces[std::size_t(i)];
    }
  } else {
    for (const Contact<D>& it : state.contacts)
      if (it.touching != ContactMode::open && (it.key.a == body || it.key.b == body))
        touch((it.key.a == body ? 1 : -1) * it.force, it.normal);
    for (const Touch<D>& it : state.touches)
      if (it.body == body) touch(it.impulse * value(model.rate), model.walls[std::size_t(it.wall)].normal);
  }
  return std::sqrt(sum.squaredNorm());
}

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
  if (stepper_ && made_released_ == released && made_changes_ == state.events.changes) return;
  made_released_ = std::move(released), made_changes_ = state.events.changes;
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
    }
  }
  probes_ =
      model_.bonds.empty() && (now_.collision == Collision::event ||
                               (now_.collision == Collision::contact && solver(now_) == Solver::direct));
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
  make(state);
  State<D> plain = state;
  plain.events = {};
  return stepper_->fits(plain);
}

template <int D>
void Events<D>::begin(State<D>& state) {
  state.events = {};
  state.released.assign(model_.drives.size(), 0);
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
  std::vector<ContactCandidate<D>> near;
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    for (int k = 0; k < int(when.pairs.size()); ++k) {
      const auto [a, b] = when.pairs[std::size_t(k)];
      near.clear();
      const double margin = kTouchingGap * model_.scale;
      const Shape<D>& shape = model_.bodies[std::size_t(a)].shape;
      if (b < 0)
        collide(a, shape, body_motion(state, a), -1 - b, model_.walls[std::size_t(-1 - b)], margin, near);
      else
        collide(a, shape, body_motion(state, a), b, model_.bodies[std::size_t(b)].shape,
                body_motion(state, b), margin, near);
      state.events.on[std::size_t(slot(w, k))] = !near.empty();
    }
  }
  // times that are the start
  std::vector<const Action*> actions;
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    if (model_.whens[std::size_t(w)].on != On::time || !(times_[std::size_t(w)] == TimeStamp{state.step, 0}))
      continue;
    act(state, {0, w, 0, true, 0}, {state.step, 0});
    for (const Action& action : model_.whens[std::size_t(w)].actions) actions.push_back(&action);
  }
  change(state, actions, {state.step, 0});
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

// where the next time that changes something cuts the step; `to` where none does
template <int D>
double Events<D>::cut_after(const State<D>& state, double from, double to) const {
  double first = to;
  for (std::size_t w = 0; w < model_.whens.size(); ++w) {
    const When<D>& when = model_.whens[w];
    const TimeStamp at = times_[w];
    if (when.on != On::time || when.only_marks() || state.events.done[w] || at.step != state.step) continue;
    if (at.fraction > from && at.fraction < first) first = at.fraction;
  }
  return first;
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
    if (exact_ || end == 1 || end < to) find(state, from, end);
    find_times(begun_, from, end);
    if (exact_)
      for (Found& each : found_) search(each, from, end);
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.at < b.at; });

    bool cut = false;
    for (std::size_t i = 0, j; i < found_.size() && !cut; i = j) {
      const double at = found_[i].at;
      for (j = i; j < found_.size() && found_[j].at - at <= kSameInstant; ++j) {
      }
      std::sort(found_.begin() + std::ptrdiff_t(i), found_.begin() + std::ptrdiff_t(j),
                [](const Found& a, const Found& b) {
                  return a.when != b.when ? a.when < b.when : a.which < b.which;
                });
      const TimeStamp stamp = at < 1 ? TimeStamp{begun_.step, at} : TimeStamp{begun_.step + 1, 0};
      std::vector<const Action*> actions;
      for (std::size_t k = i; k < j; ++k) {
        if (!act(state, found_[k], stamp)) continue;
        const When<D>& when = model_.whens[std::size_t(found_[k].when)];
        if (when.only_marks()) continue;
        for (const Action& action : when.actions) actions.push_back(&action);
      }
      if (actions.empty()) continue;
      cut = true;
      if (at < end) {
        // back, and up to here
        EventLog log = std::move(state.events);
        state = begun_;
        state.events = std::move(log);
        course_.clear();
        if (at - from > kAtStart) {
          if (auto trouble = stepper_->go(state, from, at)) return trouble;
          sort_meetings();
          state.beyond = 0;
        }
      }
      note_truths(state, from, at);
      for (std::size_t k = i; k < j; ++k) {
        const On on = model_.whens[std::size_t(found_[k].when)].on;
        state.events.on[std::size_t(slot(found_[k].when, found_[k].which))] = on == On::crosses
                                                                                  ? found_[k].side
                                                                              : on == On::leaves ? 0
                                                                                                 : 1;
      }
      change(state, actions, stamp);
      from = at;
    }
    if (cut) continue;
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
bool Events<D>::act(State<D>& state, const Found& found, TimeStamp at) {
  char& done = state.events.done[std::size_t(found.when)];
  if (done && !model_.whens[std::size_t(found.when)].again) return false;
  done = 1;
  state.events.happenings.push_back({found.when, found.which, at.step, at.fraction});
  return true;
}

// does what is asked for at one instant. What the room's hand gives by it of energy is work.
template <int D>
void Events<D>::change(State<D>& state, const std::vector<const Action*>& actions, TimeStamp at) {
  bool any = false;
  for (const Action* action : actions) {
    if (action->what == Action::Do::stop) state.events.stopped = 1;
    any = any || (action->what != Action::Do::stop && action->what != Action::Do::mark);
  }
  if (!any) return;
  const double t = time(at, model_.rate);
  const double before = energies(stepper_->model(state), state, stepper_->paths(), t).total();
  std::vector<int>& changes = state.events.changes;
  for (const Action* action : actions) {
    for (const int of : action->of) {
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
          if (std::size_t(of) < state.broken.size()) state.broken[std::size_t(of)] = 1;
          break;
        case Action::Do::change: {
          const Change<D>& made = model_.changes[std::size_t(of)];
          std::erase_if(changes, [&](int c) { return model_.changes[std::size_t(c)].replaces(made); });
          changes.push_back(of);
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
  if (!state.broken.empty()) break_ropes(model_, state.broken);
  make(state);
  if (!state.work.empty())
    state.work[0] += energies(stepper_->model(state), state, stepper_->paths(), t).total() - before;
  std::fill(state.frozen.begin(), state.frozen.end(), 0);
  std::fill(state.quiet.begin(), state.quiet.end(), 0.0);
  stepper_->begin_anew(state, t);
}

// finds all that becomes true in the course at hand, from begun_ to `state`
template <int D>
void Events<D>::find(const State<D>& state, double from, double to) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    const When<D>& when = model_.whens[std::size_t(w)];
    switch (when.on) {
      case On::touches:
      case On::leaves:
        find_touches(state, w, from, to);
        break;
      case On::crosses:
        find_crossings(state, w, from, to);
        break;
      case On::value:
        find_values(state, w, from, to);
        break;
      case On::breaks:
        find_breaks(state, w, from, to);
        break;
      case On::time:
        break;
    }
  }
}

template <int D>
void Events<D>::find_times(const State<D>& state, double from, double to) {
  for (int w = 0; w < int(model_.whens.size()); ++w) {
    if (model_.whens[std::size_t(w)].on != On::time || state.events.done[std::size_t(w)]) continue;
    const TimeStamp at = times_[std::size_t(w)];
    double fraction = -1;
    if (at.step == state.step) fraction = at.fraction;
    if (at == TimeStamp{state.step + 1, 0}) fraction = 1;
    if (fraction > from && fraction <= to) found_.push_back({fraction, w, 0, true, 0});
  }
}

template <int D>
void Events<D>::find_breaks(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.those.size()); ++k) {
    const int joint = when.those[std::size_t(k)];
    if (!broken(state, joint) || state.events.on[std::size_t(slot(w, k))]) continue;
    double at = to;
    for (const auto& it : course_.breaks)
      if (exact_ && it.joint == joint) at = std::min(to, from + it.at / step_length(model_.rate));
    found_.push_back({at, w, k, true, 0});
  }
}

// spans_ of a pair in the course at hand
template <int D>
void Events<D>::spans(const State<D>& state, std::pair<int, int> pair, bool touched, double from, double to) {
  spans_.clear();
  const double h = step_length(model_.rate);
  const auto before = [](const auto& it, std::pair<int, int> of) { return std::pair(it.a, it.b) < of; };
  for (auto it = std::lower_bound(course_.meetings.begin(), course_.meetings.end(), pair, before);
       it != course_.meetings.end() && std::pair(it->a, it->b) == pair; ++it)
    spans_.push_back({std::min(to, from + it->begun / h), std::min(to, from + it->ended / h)});
  if (spans_.empty()) {
    bool holds = false, struck = false;
    auto contact = state.contacts.begin();
    // those of bonded parts are in another order
    const bool sorted = model_.bonds.empty();
    if (sorted)
      contact = std::lower_bound(
          contact, state.contacts.end(), pair,
          [](const Contact<D>& it, std::pair<int, int> of) { return std::pair(it.key.a, it.key.b) < of; });
    for (; contact != state.contacts.end(); ++contact) {
      const bool its = std::pair(contact->key.a, contact->key.b) == pair;
      if (sorted && !its) break;
      holds = holds || (its && contact->touching != ContactMode::open);
      struck = struck || (its && !contact->impulse.isZero(0));
    }
    // by the handout's law what rests is struck in each step
    for (const Touch<D>& touch : state.touches)
      holds = holds || (touch.body == pair.first && -1 - touch.wall == pair.second);
    if (holds) spans_.push_back({touched ? from : to, to});
    if (!holds && struck) spans_.push_back({to, to});
    return;
  }
  std::sort(spans_.begin(), spans_.end(), [](const Span& a, const Span& b) { return a.begun < b.begun; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < spans_.size(); ++i) {
    if (spans_[i].begun - spans_[kept].ended <= kSameInstant)
      spans_[kept].ended = std::max(spans_[kept].ended, spans_[i].ended);
    else
      spans_[++kept] = spans_[i];
  }
  spans_.resize(kept + 1);
  // what has just left is held for a moment more, see ExactSolver::note_contacts
  const Span& first = spans_.front();
  if (!touched && first.begun - from <= kSameInstant && first.ended > first.begun &&
      first.ended - first.begun < kLettingGo)
    spans_.erase(spans_.begin());
}

template <int D>
void Events<D>::find_touches(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.pairs.size()); ++k) {
    bool touched = state.events.on[std::size_t(slot(w, k))] != 0;
    spans(state, when.pairs[std::size_t(k)], touched, from, to);
    const auto met = [&](double at) {
      if (when.on == On::touches) found_.push_back({exact_ ? at : to, w, k, true, 0});
    };
    const auto left = [&](double at) {
      if (when.on == On::leaves) found_.push_back({exact_ ? at : to, w, k, true, 0});
    };
    double ended = from;
    for (const Span& span : spans_) {
      if (touched && span.begun - ended > kSameInstant) left(ended), touched = false;
      if (!touched) met(span.begun);
      touched = true, ended = span.ended;
    }
    if (touched && to - ended > kSameInstant) left(ended);
  }
}

// how a body stands at a fraction of the step within the course at hand, on the piece that has `inside`
template <int D>
Instant<D> Events<D>::pose_at(const State<D>& state, int body, double from, double to, double at,
                              double inside) const {
  const double t = seconds(at - from), middle = seconds(inside - from);
  const auto& pieces = course_.pieces[std::size_t(body)];
  for (const CoursePiece<D>& piece : pieces)
    if (middle <= piece.ended) return piece.at(t);
  if (!pieces.empty()) return pieces.back().at(t);
  const CoursePiece<D> whole{0, seconds(to - from), instant(begun_, body), instant(state, body)};
  Instant<D> it = whole.at(t);
  // struck on its way, as far as is known: a cubic would go far beyond both ends
  const double jump = std::sqrt((whole.to.v - whole.from.v).squaredNorm()),
               fast = std::sqrt(whole.from.v.squaredNorm()) + std::sqrt(whole.to.v.squaredNorm()),
               fall = whole.ended * std::sqrt(model_.gravity.squaredNorm());
  if (whole.ended > 0 && jump > kSmooth * fast + 4 * fall) {
    const double s = t / whole.ended;
    it.x = whole.from.x + s * (whole.to.x - whole.from.x);
    it.v = whole.from.v + s * (whole.to.v - whole.from.v);
  }
  return it;
}

// knots_: where smooth pieces of any of these bodies end, fractions of the step, with both ends
template <int D>
void Events<D>::stretches(const std::vector<int>& bodies, double from, double to) {
  const double h = step_length(model_.rate);
  knots_.assign({from, to});
  for (const int body : bodies)
    for (const CoursePiece<D>& piece : course_.pieces[std::size_t(body)])
      knots_.push_back(std::clamp(from + piece.ended / h, from, to));
  std::sort(knots_.begin(), knots_.end());
  std::size_t kept = 0;
  for (std::size_t i = 1; i < knots_.size(); ++i)
    if (knots_[i] - knots_[kept] > 1e-15) knots_[++kept] = knots_[i];
  knots_.resize(kept + 1);
  knots_.back() = to;
}

// the signed distance of a place from the line or plane of a gate, m
template <int D>
double Events<D>::side_of(const When<D>& when, const Vec<D>& x) const {
  if constexpr (D == 2) {
    const Vec<D> along = when.to - when.from, from = x - when.from;
    return (along[0] * from[1] - along[1] * from[0]) / std::sqrt(along.squaredNorm());
  } else {
    for (int axis = 0; axis < D; ++axis)
      if (when.from[axis] == when.to[axis]) return x[axis] - when.from[axis];
    return 0;
  }
}

// whether a place on it is between its ends
template <int D>
bool Events<D>::within(const When<D>& when, const Vec<D>& x) const {
  if constexpr (D == 2) {
    const Vec<D> along = when.to - when.from;
    const double part = along.dot(x - when.from);
    return part >= 0 && part <= along.squaredNorm();
  } else {
    for (int axis = 0; axis < D; ++axis) {
      const double low = std::min(when.from[axis], when.to[axis]),
                   high = std::max(when.from[axis], when.to[axis]);
      if (low < high && (x[axis] < low || x[axis] > high)) return false;
    }
    return true;
  }
}

template <int D>
void Events<D>::find_crossings(const State<D>& state, int w, double from, double to) {
  const When<D>& when = model_.whens[std::size_t(w)];
  for (int k = 0; k < int(when.those.size()); ++k) {
    const int body = when.those[std::size_t(k)];
    char side = state.events.on[std::size_t(slot(w, k))];
    const auto place = [&](double at, double inside) { return pose_at(state, body, from, to, at, inside).x; };
    // one more place on the way: on which side it is
    const auto pass = [&](double before, double at, double inside) {
      const double s = side_of(when, place(at, inside));
      const char now = s > 0 ? 2 : s < 0 ? 1 : side;
      if (now == side) return;
      const char old = side;
      side = now;
      if (old == 0) return;
      double low = before, high = at;
      for (int i = 0; i < kNarrowings; ++i) {
        const double middle = 0.5 * (low + high), value = side_of(when, place(middle, inside));
        (value != 0 && (value > 0) == (now == 2) ? high : low) = middle;
      }
      if (within(when, place(high, inside))) found_.push_back({exact_ ? high : to, w, k, false, now});
    };
    stretches({body}, from, to);
    const std::vector<double> knots = knots_;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const double a = knots[i], b = knots[i + 1], inside = 0.5 * (a + b);
      // its cubic from four of its values, in u from 0 to 1; extrema between
      const double p0 = side_of(when, place(a, inside)), p1 = side_of(when, place(a + (b - a) / 3, inside)),
                   p2 = side_of(when, place(a + 2 * (b - a) / 3, inside)),
                   p3 = side_of(when, place(b, inside));
      const double c1 = -5.5 * p0 + 9 * p1 - 4.5 * p2 + p3, c2 = 9 * p0 - 22.5 * p1 + 18 * p2 - 4.5 * p3,
                   c3 = -4.5 * p0 + 13.5 * p1 - 13.5 * p2 + 4.5 * p3;
      std::array<double, 2> turns{2, 2};
      const double A = 3 * c3, B = 2 * c2, under = B * B - 4 * A * c1;
      if (under > 0) {
        const double q = -0.5 * (B + (B < 0 ? -1 : 1) * std::sqrt(under));
        if (A != 0) turns[0] = q / A;
        if (q != 0) turns[1] = c1 / q;
        if (turns[0] > turns[1]) std::swap(turns[0], turns[1]);
      }
      double before = a;
      pass(a, a, inside);
      for (const double u : turns) {
        if (!(u > 0 && u < 1)) continue;
        pass(before, a + u * (b - a), inside);
        before = a + u * (b - a);
      }
      pass(before, b, inside);
    }
    // what moved it last, beside its solver
    const double s = side_of(when, state.x[std::size_t(body)]);
    if (side != 0 && s != 0 && (s > 0) != (side == 2) && within(when, state.x[std::size_t(body)]))
      found_.push_back({to, w, k, true, char(s > 0 ? 2 : 1)});
  }
}

// truth_ and margins_ of a value at fractions of the step
template <int D>
void Events<D>::evaluate(const State<D>& state, int w, double from, double to, std::span<const double> at,
                         double inside) {
  const When<D>& when = model_.whens[std::size_t(w)];
  const std::size_t reads = when.reads.size(), n = at.size();
  inputs_.resize(std::max(inputs_.size(), reads + 1));
  for (auto& all : inputs_) all.resize(Program::kLanes);
  for (std::size_t i = 0; i < n; ++i) {
    int last = -1;
    Instant<D> it;
    for (std::size_t k = 0; k < reads; ++k) {
      const Reading& read = when.reads[k];
      if (read.body != last) it = pose_at(state, read.body, from, to, at[i], inside), last = read.body;
      inputs_[k][i] = sim::read(it, read.of);
    }
    inputs_[reads][i] = time_at(begun_, at[i]);
  }
  std::vector<const double*> slots;
  for (std::size_t k = 0; k <= reads; ++k) slots.push_back(inputs_[k].data());
  Evaluation& evaluation = evaluations_[std::size_t(evaluation_of_[std::size_t(w)])];
  evaluation.run(int(n), slots);
  truth_.assign(evaluation.output(0), evaluation.output(0) + n);
  margins_.resize(std::size_t(when.value->outputs() - 1));
  for (std::size_t m = 0; m < margins_.size(); ++m)
    margins_[m].assign(evaluation.output(int(m) + 1), evaluation.output(int(m) + 1) + n);
}

template <int D>
void Events<D>::find_values(const State<D>& state, int w, double from, double to) {
  bool was = state.events.on[std::size_t(slot(w, 0))] != 0;
  // forces are known at the ends of what has been stepped
  if (model_.whens[std::size_t(w)].of_forces()) {
    if (!was && true_now(state, w, to)) found_.push_back({to, w, 0, false, 0});
    return;
  }
  stretches(read_[std::size_t(w)], from, to);
  const std::vector<double> knots = knots_;
  std::vector<double> at(kSamples + 1), more;
  for (std::size_t s = 0; s + 1 < knots.size(); ++s) {
    const double a = knots[s], b = knots[s + 1], inside = 0.5 * (a + b);
    at.resize(kSamples + 1);
    for (int i = 0; i <= kSamples; ++i) at[std::size_t(i)] = a + (b - a) * i / kSamples;
    at.back() = b;
    evaluate(state, w, from, to, at, inside);
    const std::vector<std::vector<double>> margins = margins_;
    std::vector<double> truth = truth_;
    const auto margin_at = [&](std::size_t m, double x) {
      evaluate(state, w, from, to, std::span(&x, 1), inside);
      return margins_[m][0];
    };
    more.clear();
    for (std::size_t m = 0; m < margins.size(); ++m) {
      const std::vector<double>& g = margins[m];
      const std::size_t last = g.size() - 1;
      for (std::size_t i = 0; i <= last; ++i) {
        // turns back before zero: how near it comes between
        if (!(g[i] != 0)) continue;
        const double sign = g[i] > 0 ? 1 : -1;
        const double before = sign * g[i > 0 ? i - 1 : i], here = sign * g[i],
                     after = sign * g[i < last ? i + 1 : i];
        if (!(here <= before && here <= after)) continue;
        double low = at[i > 0 ? i - 1 : i], high = at[i < last ? i + 1 : i];
        // at an end only what goes towards zero from there
        const double beside = i == 0 ? low + kBeside * (high - low) : high - kBeside * (high - low);
        if ((i == 0 || i == last) && !(sign * margin_at(m, beside) < here)) continue;
        double x = low + kGolden * (high - low), y = high - kGolden * (high - low);
        double gx = sign * margin_at(m, x), gy = sign * margin_at(m, y);
        for (int k = 0; k < kNarrowings && gx > 0 && gy > 0; ++k) {
          if (gx < gy)
            high = y, y = x, gy = gx, x = low + kGolden * (high - low), gx = sign * margin_at(m, x);
          else
            low = x, x = y, gx = gy, y = high - kGolden * (high - low), gy = sign * margin_at(m, y);
        }
        if (gx <= 0 || gy <= 0) more.push_back(gx <= 0 ? x : y);
      }
      // changes its sign between two samples, and with another margin may be true between
      for (std::size_t i = 0; i + 1 < g.size() && margins.size() > 1; ++i) {
        if (!(g[i] * g[i + 1] < 0)) continue;
        double low = at[i], high = at[i + 1];
        for (int k = 0; k < kNarrowings; ++k) {
          const double middle = 0.5 * (low + high);
          (margin_at(m, middle) * g[i] > 0 ? low : high) = middle;
        }
        more.push_back(low), more.push_back(high);
      }
    }
    if (!more.empty()) {
      at.insert(at.end(), more.begin(), more.end());
      std::sort(at.begin(), at.end());
      // and between them
      const std::size_t n = at.size();
      for (std::size_t i = 0; i + 1 < n; ++i) at.push_back(0.5 * (at[i] + at[i + 1]));
      std::sort(at.begin(), at.end());
      truth.clear();
      for (std::size_t i = 0; i < at.size(); i += Program::kLanes) {
        evaluate(state, w, from, to,
                 std::span(at).subspan(i, std::min(at.size() - i, std::size_t(Program::kLanes))), inside);
        truth.insert(truth.end(), truth_.begin(), truth_.end());
      }
    }
    for (std::size_t i = 0; i < at.size(); ++i) {
      const bool now = truth[i] != 0;
      if (now && !was) {
        double low = i == 0 ? at[0] : at[i - 1], high = at[i];
        for (int k = 0; k < kNarrowings && low < high; ++k) {
          const double middle = 0.5 * (low + high);
          evaluate(state, w, from, to, std::span(&middle, 1), inside);
          (truth_[0] != 0 ? high : low) = middle;
        }
        found_.push_back({exact_ ? high : to, w, 0, false, 0});
      }
      was = now;
    }
  }
  if (!was && true_now(state, w, to)) found_.push_back({to, w, 0, true, 0});
}

// whether a value is true in a state
template <int D>
bool Events<D>::true_now(const State<D>& as_it_is, int w, double fraction) {
  const When<D>& when = model_.whens[std::size_t(w)];
  const bool probed = probes_ && when.of_forces();
  if (probed) probe(as_it_is, fraction);
  const State<D>& state = probed ? probed_ : as_it_is;
  const std::size_t reads = when.reads.size();
  inputs_.resize(std::max(inputs_.size(), reads + 1));
  std::vector<const double*> slots;
  for (std::size_t k = 0; k <= reads; ++k) {
    inputs_[k].resize(Program::kLanes);
    inputs_[k][0] = k < reads ? read(state, when.reads[k]) : time_at(begun_, fraction);
    slots.push_back(inputs_[k].data());
  }
  Evaluation& evaluation = evaluations_[std::size_t(evaluation_of_[std::size_t(w)])];
  evaluation.run(1, slots);
  margins_.resize(std::size_t(when.value->outputs() - 1));
  for (std::size_t m = 0; m < margins_.size(); ++m) margins_[m].assign(1, evaluation.output(int(m) + 1)[0]);
  return evaluation.output(0)[0] != 0;
}

// Into probed_: a state with the forces of its instant, which are those that the next moment of its motion
// begins with. The exact solver keeps those of contacts as they were at the last event of a step.
template <int D>
void Events<D>::probe(const State<D>& state, double fraction) {
  probed_ = state;
  stepper_->watch(nullptr);
  const double from = state.step > begun_.step ? 0 : fraction;
  stepper_->go(probed_, from, from + kMoment < 1 ? from + kMoment : 1);
  stepper_->watch(&course_);
}

// the time of what was found on the course, on the motion itself
template <int D>
void Events<D>::search(Found& found, double from, double to) {
  if (found.exact) return;
  const When<D>& when = model_.whens[std::size_t(found.when)];
  const bool gate = when.on == On::crosses;
  struct Tried {
    bool is = false;
    double margin = 0;
  };
  stepper_->watch(nullptr);
  const auto attempt = [&](double at) {
    tried_ = begun_;
    if (at > from && stepper_->go(tried_, from, at)) return Tried{true, 0};
    if (gate) {
      const double s = side_of(when, tried_.x[std::size_t(when.those[std::size_t(found.which)])]);
      const double over = found.side == 2 ? s : -s;
      return Tried{over > 0, over};
    }
    const bool is = true_now(tried_, found.when, at);
    return Tried{is, margins_.size() == 1 ? margins_[0][0] : 0};
  };
  const bool forces = when.of_forces();
  double low = 0, high = 0;
  Tried at_low, at_high;
  bool before = false, after = false;
  int tries = 0;
  for (double d = kFirstBracket; d <= kLastBracket && !after; d *= 100, ++tries)
    high = std::min(to, found.at + d), at_high = attempt(high), after = at_high.is;
  for (double d = kFirstBracket; d <= kLastBracket && after && !before; d *= 100, ++tries) {
    low = found.at - d;
    if (low <= from)
      low = from, before = true, at_low = attempt(from);
    else
      at_low = attempt(low), before = !at_low.is;
  }
  // forces may have changed anywhere in the step
  if (forces && after && !before) low = from, before = true, at_low = attempt(from);
  // its margin is a straight line there, nearly: then a little before and a little after it
  for (; before && after && high - low > kFound && tries < kMostTries; ++tries) {
    double middle = 0.5 * (low + high);
    const double part = at_low.margin / (at_low.margin - at_high.margin);
    const bool line = at_low.margin < 0 && at_high.margin > 0 && tries % 4 != 3;
    if (line) middle = low + part * (high - low) + 0.25 * kFound;
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const Tried now = attempt(middle);
    (now.is ? high : low) = middle;
    (now.is ? at_high : at_low) = now;
    if (!line || !now.is || middle - 0.5 * kFound <= low) continue;
    const Tried just = attempt(middle - 0.5 * kFound);
    (just.is ? high : low) = middle - 0.5 * kFound;
    (just.is ? at_high : at_low) = just;
  }
  if (before && after) found.at = high;
  stepper_->watch(&course_);
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
