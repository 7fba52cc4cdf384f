#pragma once

#include <string>
#include <vector>

#include "app/run/table.h"
#include "scene/scene.h"

namespace obscura::app {

/// Makes a scene show another program's run: its table's columns are matched to the scene's bodies by name,
/// "ball.position.x". Every body that is not fixed needs its position; other columns that are missing are
/// zero. `notes` gets remarks for the user: columns that match no body, bodies that do not turn. Throws
/// media::Error if a body has no position.
void show_run(const Table& table, bool interpolate, scene::Scene& scene, std::vector<std::string>& notes);

}  // namespace obscura::app
