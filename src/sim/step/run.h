#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/model/snapshot.h"
#include "sim/model/state.h"
#include "sim/model/trouble.h"

namespace obscura::sim {

/// A run that was asked to stop on its way to an instant. It stands between two steps and may be asked to go
/// on.
struct Stopped {};

/// A run that diverges and is shown all the same.
struct Divergence {
  Trouble trouble;
  bool ended = false;  // the state shown is its last finite one, also at all later instants
};

/// A condition of the model that has fired.
struct RunEvent {
  Rational time;                   // s; not before it, by less than rounding
  int when = 0;                    // which condition of the model
  std::string name;                // its name
  std::string what;                // "touches", "crosses", ...
  std::vector<std::string> of;     // what it was true of: names of bodies, walls, joints
  std::vector<std::string> marks;  // that it made
  bool stop = false;               // it ended the run
};

/// Numbers of a state, row by row: good for as long as the run is there, and of its last whole step.
struct Columns {
  const double* first = nullptr;
  std::size_t rows = 0, columns = 0;
};

/// What a state holds of its bodies: a row a body for `x` (m) and `v` (m/s); for `turn` (rad, in space a unit
/// quaternion x, y, z, w) and `spin` (rad/s) a row a body that turns, which are the last ones.
struct BodyColumns {
  Columns x, v, turn, spin;
};

/// The same to be set; what is empty stays.
struct NewBodyColumns {
  std::span<const double> x{}, v{}, turn{}, spin{};
};

/// A world that is stepped along its own clock and shown at given times. The interface that film and commands
/// use; the loop over steps is in run.cpp. A frame between two steps is a partial step of a copy, so the
/// trajectory does not depend on it.
class Run {
 public:
  virtual ~Run() = default;

  virtual const SceneInfo& scene_info() const = 0;
  virtual Rational rate() const = 0;

  /// Goes on to the instant t (s, >= 0). Throws std::invalid_argument for one in a step before the last one
  /// asked for. Trouble ends the run: the answer to every later call is the same trouble.
  virtual std::variant<Snapshot, Trouble, Stopped> at(Rational t) = 0;

  /// Goes on to a whole step, without a snapshot of it. What a force of a program throws leaves the run where
  /// its last whole step was.
  virtual std::variant<std::monostate, Trouble, Stopped> go(std::int64_t step) = 0;

  /// From now on, `stop` is asked before every step whether to stop there.
  virtual void heed(std::function<bool()> stop) = 0;

  /// From now on, trouble leaves the state as it was after the last whole step, so that it can still be read.
  virtual void keep_whole_steps() = 0;

  /// From now on, a run that diverges is shown: it goes on for as long as its state is finite, and every
  /// later instant is that of the last finite step.
  virtual void show_divergence() = 0;
  /// Of such a run at the last snapshot; none: all is well.
  virtual std::optional<Divergence> divergence() const = 0;

  /// The state at the last whole step, for run() to go on from (sim/step/archive.h), and its time (s). Empty
  /// for a run that may begin anywhere.
  virtual std::vector<std::uint64_t> saved() const = 0;
  virtual Rational now() const = 0;

  /// Goes back, or on, to a state that was saved of a run of the same world. False: it is none, and nothing
  /// has changed. Trouble is forgotten.
  virtual bool restore(std::span<const std::uint64_t> saved) = 0;

  /// The state at the last whole step, without a copy. Empty for a run that may begin anywhere.
  virtual BodyColumns columns() const = 0;
  /// Sets places and velocities of bodies, from which it goes on: what sleeps wakes, and contacts are found
  /// anew. Answers why they do not fit, with nothing changed; empty: they are set.
  virtual std::string set(const NewBodyColumns& columns) = 0;

  /// What has fired up to the last whole step, in the order of time.
  virtual std::vector<RunEvent> events() const = 0;

  /// The words of the state that the last snapshot shows (sim/model/state.h).
  virtual std::vector<std::uint64_t> words() const = 0;

  /// The steps so far in which a limit of a solver's work was met.
  virtual LimitsMet limits_met() const = 0;

  /// From now on, keep the ways of these bodies. Requires: before the first at().
  virtual void track(std::vector<int> bodies) = 0;

  /// The ways since the last call (or since t = 0), up to the last whole step.
  virtual Track take_track() = 0;
};

/// A run in which nothing is stepped: it may begin anywhere, so it has nothing to save, and nothing fires or
/// diverges in it.
class RunWithoutSteps : public Run {
 public:
  void keep_whole_steps() final {}
  void show_divergence() final {}
  std::optional<Divergence> divergence() const final { return {}; }
  std::vector<std::uint64_t> saved() const final { return {}; }
  Rational now() const final { return {0, 1}; }
  bool restore(std::span<const std::uint64_t>) final { return false; }
  BodyColumns columns() const final { return {}; }
  std::vector<RunEvent> events() const final { return {}; }
  LimitsMet limits_met() const final { return {}; }
};

/// What fires up to t, the last instant that the run was asked for, in the order of time. The run goes on to
/// the end of its step for that.
std::vector<RunEvent> events_until(Run& run, Rational t);

/// A run of a world from its state, or from one that was saved of a run of the same world: it goes on to the
/// same bits. None where that is no state of this world. A world that lacks something
/// (sim/model/incomplete.h) gives a run whose every answer is that trouble.
std::unique_ptr<Run> run(World<2> world, std::span<const std::uint64_t> saved = {});
std::unique_ptr<Run> run(World<3> world, std::span<const std::uint64_t> saved = {});

}  // namespace obscura::sim
