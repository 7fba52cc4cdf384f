#pragma once

#include "scene/scene.h"

namespace obscura::app {

/// The scene with the times of its run's marks in place, and as long as the run until an event stops it: it
/// is run once, where its film or figure asks for that. Says which marks the run does not come to. Throws
/// Interrupted.
scene::Scene with_run_marks(scene::Scene scene);

}  // namespace obscura::app
