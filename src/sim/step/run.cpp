#include "sim/step/run.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "sim/constraint/joints/joint.h"
#include "sim/model/body_motion.h"
#include "sim/model/incomplete.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/archive.h"
#include "sim/step/outside_room.h"
#include "sim/step/snapshots.h"

namespace obscura::sim {

namespace {

constexpr double kTrackRate = 120;              // points a second of a way, about
constexpr double kRounding = 1e-9;              // of a step: of the time of an event
constexpr double kFirst = 1 - 1.0 / (1 << 20);  // of a step: so far the first is tried for its forces

template <int D>
class RunOf final : public Run {
 public:
  RunOf(World<D> world, std::optional<State<D>> saved)
      : model_(std::move(world.model)), state_(std::move(world.state)) {
    stepper_.emplace(model_);
    cast_ = sim::cast(model_, state_, stepper_->paths());
    sound_ = !saved || stepper_->fits(*saved);
    if (saved)
      state_ = std::move(*saved);
    else
      stepper_->begin(state_);
    for (const Force<D>& force : model_.forces) called_ = called_ || force.law == Force<D>::Law::function;
    keeps_ = called_;
    stride_ = std::max<std::int64_t>(1, std::llround(value(model_.rate) / kTrackRate));
    iterates_ = model_.collision != Collision::handout && !solver_kind(solver(model_)).exact;
    jointed_.assign(model_.bodies.size(), 0);
    for (const Joint<D>& joint : model_.joints)
      joint.each_body([&](int body) {
        if (body >= 0) jointed_[std::size_t(body)] = 1;
      });
  }

  const SceneInfo& scene_info() const override { return cast_; }
  Rational rate() const override { return model_.rate; }

  void heed(std::function<bool()> stop) override { stop_ = std::move(stop); }

  void show_divergence() override { shown_ = true; }
  std::optional<Divergence> divergence() const override { return divergence_; }

  std::variant<Snapshot, Trouble, Stopped> at(Rational t) override {
    const TimeStamp to = time_stamp(t, model_.rate);
    if (!trouble_ && to.step < state_.step)
      throw std::invalid_argument("a run goes on: it was asked for an instant before the last");
    if (std::holds_alternative<Stopped>(go(to.step))) return Stopped{};
    divergence_.reset();
    if (trouble_) return shown_ ? last_finite(*trouble_) : Answer(*trouble_);
    if (shown_)
      if (const auto much = stepper_->diverges(state_)) divergence_ = Divergence{*much, false};
    between_ = to.fraction > 0;
    if (!between_) {
      Snapshot now = snapshot(model_, state_, *stepper_, to, value(t));
      if (to.step == 0) show_first_forces(now);
      return now;
    }
    copy_ = state_;
    if (auto trouble = guarded([&] { return stepper_->partial_step(copy_, to.fraction); })) {
      // the step as a whole decides whether the run ends here
      if (shown_) return last_finite(*trouble);
      trouble_ = trouble;
      return *trouble_;
    }
    keep_forces(to.fraction);
    return snapshot(model_, copy_, *stepper_, to, value(t));
  }

  std::variant<std::monostate, Trouble, Stopped> go(std::int64_t step) override {
    between_ = false;
    if (state_.step < step) check_set();
    while (!trouble_ && state_.step < step) {
      if (stop_ && stop_()) return Stopped{};
      if (shown_ || keeps_) last_ = state_;
      try {
        trouble_ = guarded([&] { return stepper_->step(state_); });
      } catch (...) {
        if (keeps_) state_ = last_;
        throw;
      }
      // what comes after a whole step is too much energy, in finite numbers
      if (shown_ && trouble_ && state_.step > last_.step) trouble_.reset();
      if (trouble_ && (shown_ || keeps_)) state_ = last_;
      if (!trouble_) keep_ways();
    }
    if (trouble_) return *trouble_;
    return std::monostate{};
  }

  void keep_whole_steps() override { keeps_ = true; }

  /// Whether it had a state to begin with.
  bool sound() const { return sound_; }

  std::vector<std::uint64_t> saved() const override { return sim::saved(state_); }
  Rational now() const override { return rational(state_.step) / model_.rate; }

  bool restore(std::span<const std::uint64_t> words) override {
    const std::optional<State<D>> state = loaded<D>(words);
    if (!state || !stepper_->fits(*state)) return false;
    // a copy: columns stay where they are
    state_ = *state;
    stepper_.emplace(model_);
    trouble_.reset(), divergence_.reset(), before_set_.reset();
    between_ = false;
    return true;
  }

  BodyColumns columns() const override {
    const auto of = [](const auto& all) {
      using StateRow = typename std::decay_t<decltype(all)>::value_type;
      return Columns{all.empty() ? nullptr : all[0].data(), all.size(),
                     std::size_t(StateRow::RowsAtCompileTime)};
    };
    return {of(state_.x), of(state_.v), of(state_.turn), of(state_.spin)};
  }

  std::string set(const NewBodyColumns& columns) override;

  std::vector<std::uint64_t> words() const override { return sim::words(between_ ? copy_ : state_); }

  std::vector<RunEvent> events() const override {
    std::vector<RunEvent> all;
    for (const Happening& it : state_.events.happenings) all.push_back(told(it));
    return all;
  }

  LimitsMet limits_met() const override { return state_.limits_met; }

  void track(std::vector<int> bodies) override {
    track_.bodies = std::move(bodies);
    track_.points.assign(track_.bodies.size(), {});
    touched_.assign(model_.bodies.size(), false);
    keep_ways();
  }

  Track take_track() override {
    Track taken{track_.bodies, std::vector<std::vector<Track::Point>>(track_.bodies.size())};
    taken.points.swap(track_.points);
    return taken;
  }

 private:
  using Answer = std::variant<Snapshot, Trouble, Stopped>;

  RunEvent told(const Happening& it) const {
    constexpr const char* kWords[] = {"touches", "leaves", "crosses", "value", "time", "breaks"};
    const When<D>& when = model_.whens[std::size_t(it.when)];
    RunEvent event;
    event.time = instant_of({it.step, it.fraction});
    event.when = it.when, event.name = when.name, event.what = kWords[int(when.on)];
    const auto body = [&](int i) { return model_.bodies[std::size_t(i)].name; };
    if (!when.pairs.empty()) {
      const auto [a, b] = when.pairs[std::size_t(it.which)];
      event.of = {body(a), b < 0 ? "wall[" + std::to_string(-1 - b) + "]" : body(b)};
    } else if (when.on == When<D>::On::value) {
      for (const Reading& read : when.reads)
        if (std::find(event.of.begin(), event.of.end(), body(read.body)) == event.of.end())
          event.of.push_back(body(read.body));
    } else if (when.on == When<D>::On::crosses) {
      event.of = {body(when.those[std::size_t(it.which)])};
    } else if (when.on == When<D>::On::breaks) {
      const int of = when.those[std::size_t(it.which)];
      if (of >= 0)
        event.of = {model_.joints[std::size_t(of)].name};
      else
        event.of = {body(model_.bonds[std::size_t(-1 - of)].a)};
      if (of < 0 && model_.bonds[std::size_t(-1 - of)].b >= 0)
        event.of.push_back(body(model_.bonds[std::size_t(-1 - of)].b));
    }
    for (const auto& action : when.actions) {
      if (action.what == When<D>::Action::Do::mark) event.marks.push_back(action.mark);
      event.stop = event.stop || action.what == When<D>::Action::Do::stop;
    }
    return event;
  }

  // a time at which a run stands there, or beyond by less than 1e-12 of a step
  Rational instant_of(TimeStamp at) const {
    constexpr std::int64_t kParts = std::int64_t(1) << 40;
    const auto part = std::int64_t(std::ceil(at.fraction * double(kParts)));
    return (rational(at.step) + rational(part, kParts)) / model_.rate;
  }

  // Between two steps what goes on touching has the force of the last whole step: the part of a step, however
  // short, puts right all that the last has left, which is no force. So have joints of what touches, by the
  // solver for many; and what it finds touching anew has its impulse in the mean of a whole step. Before the
  // first all is new.
  void keep_forces(double fraction) {
    const std::vector<Contact<D>>& known = state_.contacts;
    std::size_t at = 0;  // both are in one order
    bool borne = false;
    for (Contact<D>& contact : copy_.contacts) {
      if (contact.force.isZero(0)) continue;
      borne = borne || jointed_[std::size_t(contact.key.a)] ||
              (contact.key.b >= 0 && jointed_[std::size_t(contact.key.b)]);
      for (std::size_t looked = 0; looked < known.size() && known[at].key != contact.key; ++looked)
        at = at + 1 < known.size() ? at + 1 : 0;
      const bool held = !known.empty() && known[at].key == contact.key && !known[at].force.isZero(0);
      if (held)
        contact.force = known[at].force;
      else if (iterates_ && state_.step > 0)
        contact.force *= fraction;
    }
    if (!iterates_ || !borne || state_.step == 0) return;
    for (std::size_t i = 0; i < copy_.joint_forces.size() && i < state_.joint_forces.size(); ++i) {
      if (copy_.broken[i] || state_.broken[i]) continue;
      copy_.joint_forces[i] = state_.joint_forces[i], copy_.joint_torques[i] = state_.joint_torques[i];
    }
  }

  // what a program throws from within a step: nothing that the stepper keeps counts any more
  template <class Act>
  auto guarded(Act&& act) {
    try {
      return act();
    } catch (...) {
      stepper_.emplace(model_);
      throw;
    }
  }

  // At the start no step has been taken yet: the forces shown there are those of the first.
  void show_first_forces(Snapshot& now) {
    if (model_.collision == Collision::handout || called_) return;
    copy_ = state_;
    if (stepper_->partial_step(copy_, kFirst)) return;
    const Snapshot then = snapshot(model_, copy_, *stepper_, {0, kFirst}, kFirst / value(model_.rate));
    for (std::size_t i = 0; i < now.joints.size(); ++i) {
      Snapshot::Joint& joint = now.joints[i];
      joint.force = then.joints[i].force, joint.torque = then.joints[i].torque;
      joint.holds = then.joints[i].holds;
    }
    // what joints turn bodies by; other torques are known at the start
    for (Vec<D>& force : copy_.joint_forces) force.setZero();
    for (AngularVec<D>& torque : copy_.joint_torques) torque.setZero();
    for (Wound& rope : copy_.wound) rope.drag = 0;
    const Snapshot loose = snapshot(model_, copy_, *stepper_, {0, kFirst}, kFirst / value(model_.rate));
    for (std::size_t i = 0; i < now.bodies.size(); ++i) {
      now.bodies[i].held = then.bodies[i].held;
      now.bodies[i].torque += then.bodies[i].torque - loose.bodies[i].torque;
    }
    // what lies there, if only after a fall that is shorter than the step
    const double step = 1 / value(model_.rate);
    for (Snapshot::Contact each : then.contacts) {
      if (!each.holds || each.impulse.norm() > step * each.force.norm()) continue;
      each.impulse.setZero();
      now.contacts.push_back(each);
    }
  }

  // what has been set since the last step, when all of it is: trouble where a body is outside the room
  void check_set() {
    if (trouble_ || !before_set_) return;
    const auto found = outside(model_, *before_set_, state_, false);
    if (!found) return before_set_.reset();
    trouble_ = {value(now()), model_.bodies[std::size_t(found->body)].name, "position",
                "is outside the room: " + found->where,
                "positions and turns were set that do not go together"};
  }

  Snapshot last_finite(const Trouble& trouble) {
    between_ = false;
    divergence_ = Divergence{trouble, true};
    return snapshot(model_, state_, *stepper_, {state_.step, 0}, time({state_.step, 0}, model_.rate));
  }

  // a point of every way that this step belongs to: all at equal steps, and bodies that have just had an
  // impact
  void keep_ways() {
    if (track_.bodies.empty()) return;
    const bool all = state_.step % stride_ == 0;
    const auto struck = [&](bool now) {
      bool any = false;
      for (const Touch<D>& touch : state_.touches) touched_[touch.body] = now, any = true;
      for (const Contact<D>& contact : state_.contacts) {
        if (contact.impulse == Vec<D>::Zero()) continue;
        touched_[contact.key.a] = now, any = true;
        if (contact.key.b >= 0) touched_[contact.key.b] = now;
      }
      return any;
    };
    if (!struck(true) && !all) return;
    const double t = time({state_.step, 0}, model_.rate);
    for (std::size_t i = 0; i < track_.bodies.size(); ++i) {
      const int body = track_.bodies[i];
      if (!all && !touched_[body]) continue;
      Track::Point point{t, to_3d<D>(state_.x[body])};
      point.velocity = to_3d<D>(state_.v[body]), point.smooth = !touched_[body];
      if (const int k = turning(state_, body); k >= 0) {
        point.orientation = quaternion<D>(state_.turn[k]);
        if constexpr (D == 2)
          point.spin.z() = state_.spin[k][0];
        else
          point.spin = state_.spin[k];
      }
      track_.points[i].push_back(point);
    }
    struck(false);
  }

  Model<D> model_;
  State<D> state_, copy_, last_;  // last_: before the step, where divergence is shown or programs are called
  std::optional<Stepper<D>> stepper_;
  bool called_ = false;  // a force is a program's
  bool keeps_ = false;   // what fails leaves the last whole step
  bool sound_ = true;
  SceneInfo cast_;
  std::optional<Trouble> trouble_;
  std::optional<State<D>> before_set_;    // what is set since then is not yet stepped
  std::optional<Divergence> divergence_;  // at the last snapshot
  std::function<bool()> stop_;
  bool shown_ = false;    // a run that diverges
  bool between_ = false;  // the last instant lay between two steps: copy_ shows it
  Track track_;
  std::vector<char> touched_;  // all false between two calls
  std::vector<char> jointed_;  // one a body
  bool iterates_ = false;      // whether the solver for many steps it
  std::int64_t stride_ = 1;    // steps
};

template <int D>
std::string RunOf<D>::set(const NewBodyColumns& columns) {
  const auto wrong_size = [](std::span<const double> given, const auto& all, const char* what) {
    using StateRow = typename std::decay_t<decltype(all)>::value_type;
    const std::size_t wanted = all.size() * std::size_t(StateRow::RowsAtCompileTime);
    return given.empty() || given.size() == wanted
               ? std::string()
               : std::string(what) + " have " + std::to_string(given.size()) + " numbers, expected " +
                     std::to_string(wanted);
  };
  for (const std::string& why :
       {wrong_size(columns.x, state_.x, "positions"), wrong_size(columns.v, state_.v, "velocities"),
        wrong_size(columns.turn, state_.turn, "turns"), wrong_size(columns.spin, state_.spin, "spins")})
    if (!why.empty()) return why;
  for (const auto& [what, all] : {std::pair("positions", columns.x), std::pair("velocities", columns.v),
                                  std::pair("turns", columns.turn), std::pair("spins", columns.spin)})
    if (const auto at = std::find_if(all.begin(), all.end(), [](double x) { return !std::isfinite(x); });
        at != all.end())
      return "number " + std::to_string(at - all.begin()) + " of the " + what + " is not finite";
  if (!model_.bonds.empty()) return "bodies with bonds move together: only a saved state can be restored";

  State<D> next = state_;
  const auto take = [](std::span<const double> given, auto& all) {
    if (!given.empty()) std::copy(given.begin(), given.end(), all[0].data());
  };
  take(columns.x, next.x), take(columns.v, next.v), take(columns.turn, next.turn),
      take(columns.spin, next.spin);
  for (int i = 0; i < int(model_.bodies.size()); ++i) {
    const Body<D>& body = model_.bodies[std::size_t(i)];
    const int k = turning(next, i);
    const auto other = [&](const State<D>& a, const State<D>& b) {
      return a.x[std::size_t(i)] != b.x[std::size_t(i)] || a.v[std::size_t(i)] != b.v[std::size_t(i)] ||
             (k >= 0 && (a.turn[std::size_t(k)] != b.turn[std::size_t(k)] ||
                         a.spin[std::size_t(k)] != b.spin[std::size_t(k)]));
    };
    if (body.linked && other(next, state_))
      return body.name + " is a link, moved by the joints of its chain: only a saved state can be restored";
    if (body.fixed &&
        (!next.v[std::size_t(i)].isZero(0) || (k >= 0 && !next.spin[std::size_t(k)].isZero(0))) &&
        !body.driven)
      return body.name + " is fixed: it has no velocity and no spin";
    if (D == 2 || k < 0) continue;
    Orientation<D>& turn = next.turn[std::size_t(k)];
    if (!(turn.squaredNorm() > 0) || !std::isfinite(turn.squaredNorm()))
      return "the turn of " + body.name + " is no quaternion";
    // a unit quaternion stays as it is, to the bit
    if (std::fabs(turn.squaredNorm() - 1) > 1e-14) turn /= std::sqrt(turn.squaredNorm());
  }

  // nothing of the steps before counts any more
  next.contacts.clear(), next.touches.clear();
  std::fill(next.frozen.begin(), next.frozen.end(), 0);
  std::fill(next.quiet.begin(), next.quiet.end(), 0.0);
  if (!stepper_->fits(next))
    return "a body would be farther, or faster, than a million room heights, or those a second";
  if (const auto found = outside(model_, state_, next, true))
    return model_.bodies[std::size_t(found->body)].name + " would be outside the room: " + found->where;
  if (!before_set_) before_set_ = state_;
  state_ = next;
  stepper_.emplace(model_);
  leave_wheels(stepper_->model(state_), state_);
  stepper_->begin_anew(state_, time({state_.step, 0}, model_.rate));
  trouble_.reset(), divergence_.reset();
  between_ = false;
  return "";
}

// The run of a world that cannot be stepped.
template <int D>
class NoRun final : public RunWithoutSteps {
 public:
  NoRun(World<D> world, Trouble why) : model_(std::move(world.model)), why_(std::move(why)) {
    cast_.dimension = D;
  }

  const SceneInfo& scene_info() const override { return cast_; }
  Rational rate() const override { return model_.rate; }
  std::variant<Snapshot, Trouble, Stopped> at(Rational) override { return why_; }
  std::variant<std::monostate, Trouble, Stopped> go(std::int64_t) override { return why_; }
  void heed(std::function<bool()>) override {}
  std::string set(const NewBodyColumns&) override { return why_.what; }
  std::vector<std::uint64_t> words() const override { return {}; }
  void track(std::vector<int>) override {}
  Track take_track() override { return {}; }

 private:
  Model<D> model_;
  Trouble why_;
  SceneInfo cast_;
};

template <int D>
std::unique_ptr<Run> begun(World<D> world, std::span<const std::uint64_t> words) {
  std::optional<State<D>> state;
  if (auto lacking = incomplete(world))
    return std::make_unique<NoRun<D>>(std::move(world), std::move(*lacking));
  if (!words.empty() && !(state = loaded<D>(words))) return {};
  auto run = std::make_unique<RunOf<D>>(std::move(world), std::move(state));
  return run->sound() ? std::move(run) : nullptr;
}

}  // namespace

std::vector<RunEvent> events_until(Run& run, Rational t) {
  const Rational steps = t * run.rate();
  if (const std::int64_t whole = floor(steps); rational(whole) < steps) run.go(whole + 1);
  std::vector<RunEvent> all = run.events();
  // their times may be later by rounding
  const double end = value(t) + kRounding / value(run.rate());
  std::erase_if(all, [&](const RunEvent& it) { return value(it.time) > end; });
  return all;
}

std::unique_ptr<Run> run(World<2> world, std::span<const std::uint64_t> saved) {
  return begun(std::move(world), saved);
}
std::unique_ptr<Run> run(World<3> world, std::span<const std::uint64_t> saved) {
  return begun(std::move(world), saved);
}

}  // namespace obscura::sim
