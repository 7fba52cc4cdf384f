#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace obscura::app {

/// Whether a film of the scene needs its run before: it names marks, or an event may stop it.
bool waits_for_run(const scene::Scene& scene);

/// The scene with the times of its run's marks in place, and as long as the run until an event stops it: it
/// is run once, where its film or figure asks for that. Says which marks the run does not come to. Throws
/// Interrupted.
scene::Scene with_run_marks(scene::Scene scene);

/// The marks that a scene's run comes to, in the order of time, s; it is run once, where it makes marks and
/// was not run before. Throws Interrupted.
std::vector<std::pair<std::string, sim::Rational>> passed_marks(const scene::Scene& scene);

/// The marks that conditions of the scene make.
std::vector<std::string> made_marks(const scene::Scene& scene);

/// A list of instants as a flag has it, "0.5,hit[2]" or "hit:4:0.5", with the times of the run's marks (s) in
/// the place of their names: the run is run once, if there is one. Throws UsageError for a mark that no
/// condition makes or that the run does not come to, and Interrupted.
std::string with_instants(const scene::Scene& scene, std::string_view flag, const std::string& list);

}  // namespace obscura::app
