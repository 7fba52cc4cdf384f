#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sim/model/course.h"
#include "sim/model/script.h"
#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

template <int D>
class Stepper;

/// Steps a model of which fixed or kinematic bodies are released at given times. Between two releases this is
/// a model in which released bodies are free, with a stepper of its own; both follow from State::released.
template <int D>
class Releases {
 public:
  /// Kept by reference.
  explicit Releases(const Model<D>& model);
  ~Releases();

  void begin(State<D>& state);
  /// Goes on within a step, from one fraction of it to another.
  std::optional<Trouble> advance(State<D>& state, double from, double fraction);
  /// After a whole step.
  std::optional<Trouble> check_energy(const State<D>& state);

  /// The model of a state.
  const Model<D>& model(const State<D>& state);

  void watch(Course<D>* course);
  void begin_anew(State<D>& state, double t);

 private:
  bool let_go(State<D>& state, TimeStamp at);
  void make(const State<D>& state);

  const Model<D>& model_;
  std::vector<ScriptEvent> edges_;  // of releases
  Model<D> now_;
  std::vector<char> made_;  // State::released of now_
  std::unique_ptr<Stepper<D>> stepper_;
  Course<D>* course_ = nullptr;
};

}  // namespace obscura::sim
