#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/expression.h"
#include "sim/model/course.h"
#include "sim/model/script.h"
#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

template <int D>
class Stepper;

/// Steps a model with conditions: looks through each step for those that become true, notes when, and does
/// what they ask for. Between two changes of the room it is a model without conditions, with a stepper of its
/// own. Under `event` each fires at its own time, in other modes at the end of the step; a time always
/// exactly. What was noted and changed is the state's, so copies and resumed runs do the same.
template <int D>
class Events {
 public:
  /// Kept by reference.
  explicit Events(const Model<D>& model);
  ~Events();

  void begin(State<D>& state);
  void begin_anew(State<D>& state, double t);
  bool fits(const State<D>& state);
  std::optional<Trouble> step(State<D>& state);
  std::optional<Trouble> partial_step(State<D>& state, double fraction);

  /// The model of a state.
  const Model<D>& model(const State<D>& state);

 private:
  using On = typename When<D>::On;
  using Action = typename When<D>::Action;

  // a condition that becomes true, as found in a course
  struct Found {
    double at = 0;  // fraction of the step
    int when = 0, which = 0;
    bool exact = false;  // the time needs no search
    char side = 0;       // of crosses: on which it is from then on
    // of values: since when the course has it false, from when and until when true
    double since = 0, seen = 0, until = 0;
    double before =
        0;  // so much earlier, of the step, it is acted upon: two that are joined do not bounce first
  };
  struct Tried {
    bool is = false;
    double margin = 0;
  };
  // two that touch within the course at hand, fractions of the step
  struct Span {
    double begun, ended;
  };

  static constexpr double kSameInstant = 1e-9;  // of a step: what is as near happens together
  static constexpr double kTouchTime = 1e-7;  // of a step: so well the touch of two that are joined is known
  static constexpr double kBefore = 1e-10;    // of a step: at least so much before they bounce two are joined
  static constexpr double kTouchingGap = 1e-9;  // of the room's height: what touches at the start
  static constexpr double kMoment = 1e-9;       // of a step: what is known only a moment later
  static constexpr int kNarrowings = 60;        // of a bracket, by halves

  // whether a joint, or a bond as -1 - bond, is broken
  static bool broken(const State<D>& state, int of) {
    if (of < 0) return !state.intact.empty() && !state.intact[std::size_t(-1 - of)];
    return std::size_t(of) < state.broken.size() && state.broken[std::size_t(of)];
  }
  int slot(int when, int which) const { return slots_[std::size_t(when)] + which; }
  double seconds(double fraction) const;
  double time_at(const State<D>& state, double fraction) const;
  double cut_after(const State<D>& state, double from, double to) const;

  void make(const State<D>& state);
  std::optional<Trouble> advance(State<D>& state, double to);
  std::optional<Trouble> too_many(const State<D>& state) const;

  void sort_meetings();

  // what becomes true between `from` and `to`, begun_ and `state`
  void find(const State<D>& state, double from, double to, bool only_joining);
  void find_times(const State<D>& state, double from, double to);
  void find_touches(const State<D>& state, int when, double from, double to);
  void find_crossings(const State<D>& state, int when, double from, double to);
  void find_values(const State<D>& state, int when, double from, double to);
  void find_breaks(const State<D>& state, int when, double from, double to);
  void spans(const State<D>& state, std::pair<int, int> pair, bool touched, double from, double to);
  void meet(const State<D>& state, std::pair<int, int> pair, bool touched, double from, double to);
  bool returns(const State<D>& state, std::pair<int, int> pair);
  Instant<D> pose_at(const State<D>& state, int body, double from, double to, double at, double inside) const;
  void stretches(const std::vector<int>& bodies, double from, double to);

  // a value at several fractions of the course at hand: whether it is true, and its margins
  void evaluate(const State<D>& state, int when, double from, double to, std::span<const double> at,
                double inside);
  bool true_now(const State<D>& state, int when, double fraction);
  double read(const State<D>& state, const Reading& of);
  bool probe(const State<D>& state, double fraction);
  double side_of(const When<D>& when, const Vec<D>& x) const;
  bool within(const When<D>& when, const Vec<D>& x) const;
  Tried attempt(const Found& found, double from, double at);
  bool confirm(const State<D>& state, Found& found, double from, double to);
  std::optional<double> true_instant(const Found& found, double from, double to);
  std::optional<double> false_before(const Found& found, double from, double at);
  void search(Found& found, double from, double to);
  bool joins(const When<D>& when) const;
  void search_touch(Found& found, double from, double to);

  bool note_fired(State<D>& state, const Found& found, TimeStamp at);
  // an action, and for which of its condition's things
  struct Due {
    const Action* action;
    int which;
  };
  void carry_out(State<D>& state, const std::vector<Due>& actions, TimeStamp at);
  void touch_with_these(const State<D>& state);
  void join_with_these(State<D>& state, TimeStamp at, std::vector<Due>& actions);
  bool joined(const State<D>& state, const When<D>& when, int pair) const;
  bool meets(const State<D>& state, std::pair<int, int> pair) const;
  void kick(State<D>& state, const State<D>& was, const Change<D>& by, double t);
  void known_broken(State<D>& state, int joint, bool broken);
  void take_impulses_of_joining(State<D>& state, double fraction, double t);
  void note_truths(State<D>& state, double from, double to);

  const Model<D>& model_;
  bool exact_ = false;                   // under `event`
  bool probes_ = false;                  // by the exact solver, without bonds
  bool iterates_ = false;                // by the iterative solver
  std::vector<int> slots_;               // of each condition, its first in EventLog::on
  std::vector<Evaluation> evaluations_;  // of values, in the order of the conditions
  std::vector<int> evaluation_of_;
  std::vector<TimeStamp> times_;        // of conditions of time
  std::vector<std::vector<int>> read_;  // of each condition, the bodies that it looks at
  Model<D> now_;
  std::vector<char> made_released_;
  std::vector<int> made_changes_;
  std::vector<Made<D>> made_joints_;  // State::made of now_, of those that are not broken
  std::unique_ptr<Stepper<D>> stepper_;

  Course<D> course_;
  State<D> begun_, tried_, probed_;
  std::vector<Found> found_;
  std::vector<Span> spans_;
  std::vector<double> knots_;
  std::vector<std::vector<double>> inputs_;
  std::vector<double> truth_;
  std::vector<std::vector<double>> margins_;
};

}  // namespace obscura::sim
