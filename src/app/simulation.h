#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/shots.h"
#include "draw/depict.h"
#include "scene/scene.h"
#include "sim/run.h"

namespace obscura::app {

using Ways = std::vector<std::shared_ptr<const sim::Track>>;

/// A closed piece of a film, simulated and not yet drawn.
struct Take {
  std::vector<Shot> shots;
  std::vector<sim::Snapshot> moments;
  std::vector<std::vector<sim::Snapshot>>
      open;                         // while the shutter is, one list a moment; empty: nothing moves
  std::vector<std::string> states;  // hashes, one a moment, or of the first alone
  Ways ways;                        // what trails are drawn from
};

/// Who draws the scene's instants, as large as its film is, with these charts beside them.
draw::Depictor depictor(const scene::Scene& scene, const draw::Charts& charts);

/// A run at an instant. Throws TroubleError where it cannot go on, Interrupted where somebody asks for an
/// end.
sim::Snapshot moment(sim::Run& run, sim::Rational t, const scene::Scene& scene);

struct SimulationOptions {
  int frames = 1;          // of a take, at most
  bool hash_each = false;  // every state of a take, not its first alone
};

/// Simulates the shots of a scene, take after take, keeping the ways that trails need. Ends early when
/// somebody asks for an end.
class Simulation {
 public:
  /// `artist`: who is going to draw them.
  Simulation(const scene::Scene& scene, const Shots& shots, const draw::Depictor& artist,
             const SimulationOptions& options);

  /// The next take; none after the last, or where the run cannot go on.
  std::optional<Take> next();

  const std::optional<sim::Trouble>& trouble() const { return trouble_; }

 private:
  void approach(sim::Rational t);
  std::vector<sim::Snapshot> open(const sim::Snapshot& moment);
  void keep_ways();

  Shots shots_;
  draw::Depictor artist_;
  scene::Film film_;
  bool contacts_ = false;  // are drawn
  SimulationOptions options_;
  std::unique_ptr<sim::Run> run_;
  double trail_;  // s, the longest
  std::deque<std::shared_ptr<const sim::Track>> ways_;
  std::int64_t next_ = 0;
  sim::Rational at_;
  std::optional<sim::Trouble> trouble_;
};

}  // namespace obscura::app
