#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/run/shots.h"
#include "draw/compose/annotations.h"
#include "draw/compose/comparison.h"
#include "draw/compose/depict.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::app {

using Ways = std::vector<std::shared_ptr<const sim::Track>>;

/// What a run does meanwhile.
struct RunSegment {
  std::vector<sim::Snapshot> moments;
  std::vector<draw::Fate> fates;  // one a moment
  std::vector<std::vector<sim::Snapshot>>
      open;   // while the shutter is, one list a moment; empty: nothing moves
  Ways ways;  // what trails are drawn from
};

/// A closed piece of a film, simulated and not yet drawn.
struct FilmSegment : RunSegment {
  std::int64_t number = 0;
  std::vector<Shot> shots;
  std::vector<std::string> states;  // hashes, one a moment, or of the first alone
  std::vector<RunSegment> others;   // of a film of several runs: all but the first

  const RunSegment& run(std::size_t i) const { return i == 0 ? *this : others[i - 1]; }
  /// An instant with the bodies of all runs, for checksums.
  sim::Snapshot all_bodies(std::size_t frame) const;
};

/// Whether a run is all right at its last snapshot.
draw::Fate fate(const sim::Run& run);

/// The hash of several states together; of one its own.
std::string hash_of_states(const std::vector<std::string>& hashes);

/// What a film knows of its run before it begins: the axes of its charts, and all that its marks need.
struct Ahead {
  draw::Charts charts{};
  std::vector<sim::Vec3> reached{};  // by bodies, where a camera fits them: the outmost places, m
  std::shared_ptr<const draw::Annotations> annotations{};
  /// Of a film of several runs (film.vary): each with its own.
  struct Run {
    scene::Scene scene;  // as its panel shows it
    draw::ComparedRun look;
    draw::Rect panel{};
    std::shared_ptr<const draw::Annotations> annotations{};
  };
  std::shared_ptr<const std::vector<Run>> runs{};
};

/// The illustrator of the scene's instants, at the film's size, with what is known of the run.
draw::Illustrator depictor(const scene::Scene& scene, const Ahead& ahead);
/// The illustrators of the runs of a film: of one, or of each of several.
std::vector<draw::Illustrator> depictors(const scene::Scene& scene, const Ahead& ahead);

/// A run at an instant. Throws TroubleError where it cannot go on, Interrupted where a signal asks for an
/// end.
sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene);

struct SimulationOptions {
  int frames = 1;          // of a take, but for the last
  bool hash_each = false;  // every state of a take, not its first alone
  std::int64_t first = 0, last = std::numeric_limits<std::int64_t>::max();  // takes: [first, last)
  /// Whether a take is to be left out.
  std::function<bool(std::int64_t take)> skip = [](std::int64_t) { return false; };
  /// Run `run` of the film, standing at one of the steps (since, until], to go on from; or none.
  std::function<std::unique_ptr<sim::Run>(std::size_t run, std::int64_t since, std::int64_t until)> nearer =
      [](std::size_t, std::int64_t, std::int64_t) { return nullptr; };
  /// Told before each take of all runs, when they stand before its first frame.
  std::function<void(const std::vector<const sim::Run*>&)> begin_take =
      [](const std::vector<const sim::Run*>&) {};
  /// Told at the last step up to every multiple of `every` s, where that is above 0.
  sim::Rational every = {0, 1};
  std::function<void(const sim::Run&, sim::Rational)> at_every = [](const sim::Run&, sim::Rational) {};
};

/// Simulates the shots of a scene, take after take, keeping the ways that trails need: one run, or all those
/// of a film that varies keys, in step. Ends early when a signal asks for an end.
class Simulation {
 public:
  Simulation(const scene::Scene& scene, const Shots& shots, const Ahead& ahead,
             const SimulationOptions& options);
  ~Simulation();

  /// The next take; none after the last, or where a run cannot go on.
  std::optional<FilmSegment> next();

  /// Of the first run that cannot go on.
  const std::optional<sim::Trouble>& trouble() const;

  std::size_t runs() const { return followed_.size(); }
  /// The run of that number, where it stands.
  const sim::Run& run(std::size_t number) const;
  /// The step up to which a run may stand to show what is to be seen at t, trails and all.
  std::int64_t step_before(sim::Rational t, std::size_t run = 0) const;

 private:
  class Followed;

  Shots shots_;
  SimulationOptions options_;
  std::vector<std::unique_ptr<Followed>> followed_;
  std::int64_t take_ = 0;
};

}  // namespace obscura::app
