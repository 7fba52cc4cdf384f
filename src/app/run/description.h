#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "sim/model/snapshot.h"
#include "sim/model/trouble.h"

namespace obscura::app {

/// Something that happens at an instant: an impact, a joint that breaks, a mark of the scene's own.
struct Happening {
  double time = 0;   // s of the run
  double seen = 0;   // s: of the first state after it
  std::string text;  // "the stone hits board[3] at 4.2 m/s"
};

/// What happens in a run of a scene.
struct Story {
  std::vector<std::string> sentences;
  std::vector<Happening> events;          // in the order of time; of very many impacts the hardest
  std::optional<sim::Trouble> trouble{};  // what ended it, unless the scene shows runs that diverge
};

/// Runs a scene once. The sentences say what is there, what hits what when, what comes to rest, what becomes
/// of the energy, what the film says. Throws Interrupted.
Story story(const scene::Scene& scene);

/// What a picture of an instant shows, in sentences: the alternative text of a still.
std::string picture_text(const scene::Scene& scene, const sim::SceneInfo& cast, const sim::Snapshot& now);

/// The same without its title: the second panel of a figure, and the third.
std::string instant_text(const sim::SceneInfo& cast, const sim::Snapshot& now);

}  // namespace obscura::app
