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
#include "draw/compose/depict.h"
#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::app {

using Ways = std::vector<std::shared_ptr<const sim::Track>>;

/// A closed piece of a film, simulated and not yet drawn.
struct FilmSegment {
  std::int64_t number = 0;
  std::vector<Shot> shots;
  std::vector<sim::Snapshot> moments;
  std::vector<std::vector<sim::Snapshot>>
      open;                         // while the shutter is, one list a moment; empty: nothing moves
  std::vector<std::string> states;  // hashes, one a moment, or of the first alone
  Ways ways;                        // what trails are drawn from
};

/// What a film knows of its run before it begins: the axes of its charts, and all that its marks need.
struct Ahead {
  draw::Charts charts{};
  std::shared_ptr<const draw::Annotations> annotations{};
};

/// The illustrator of the scene's instants, at the film's size, with what is known of the run.
draw::Illustrator depictor(const scene::Scene& scene, const Ahead& ahead);

/// A run at an instant. Throws TroubleError where it cannot go on, Interrupted where a signal asks for an
/// end.
sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene);

struct SimulationOptions {
  int frames = 1;          // of a take, but for the last
  bool hash_each = false;  // every state of a take, not its first alone
  std::int64_t first = 0, last = std::numeric_limits<std::int64_t>::max();  // takes: [first, last)
  /// Whether a take is to be left out.
  std::function<bool(std::int64_t take)> skip = [](std::int64_t) { return false; };
  /// A run that stands at one of the steps (since, until], to go on from; or none.
  std::function<std::unique_ptr<sim::Run>(std::int64_t since, std::int64_t until)> nearer =
      [](std::int64_t, std::int64_t) { return nullptr; };
  /// Told before each take, when the run stands before its first frame.
  std::function<void(const sim::Run&)> begin_take = [](const sim::Run&) {};
  /// Told at the last step up to every multiple of `every` s, where that is above 0.
  sim::Rational every = {0, 1};
  std::function<void(const sim::Run&, sim::Rational)> at_every = [](const sim::Run&, sim::Rational) {};
};

/// Simulates the shots of a scene, take after take, keeping the ways that trails need. Ends early when
/// a signal asks for an end.
class Simulation {
 public:
  /// `artist` draws them.
  Simulation(const scene::Scene& scene, const Shots& shots, const draw::Illustrator& artist,
             const SimulationOptions& options);

  /// The next take; none after the last, or where the run cannot go on.
  std::optional<FilmSegment> next();

  const std::optional<sim::Trouble>& trouble() const { return trouble_; }

  /// The step up to which a run may stand to show what is to be seen at t, trails and all.
  std::int64_t step_before(sim::Rational t) const;

 private:
  void approach(sim::Rational t);
  void begin(std::unique_ptr<sim::Run> run);
  std::variant<sim::Snapshot, sim::Trouble, sim::Stopped> at(sim::Rational t);
  std::vector<sim::Snapshot> open(const sim::Snapshot& moment);
  void keep_ways();

  Shots shots_;
  draw::Illustrator artist_;
  scene::Film film_;
  bool contacts_ = false;  // are drawn
  SimulationOptions options_;
  std::unique_ptr<sim::Run> run_;
  double trail_;  // s, the longest
  std::deque<std::shared_ptr<const sim::Track>> ways_;
  std::int64_t next_ = 0, take_ = 0;
  sim::Rational at_, due_;  // due_: when at_every is next told
  std::optional<sim::Trouble> trouble_;
};

}  // namespace obscura::app
