#pragma once

#include <string>
#include <vector>

#include "app/run/table.h"
#include "scene/scene.h"

namespace obscura::app {

/// Makes a scene show another program's run: its table's columns are matched to the scene's bodies by name,
/// "ball.position.x". Positions are needed of every body that is not fixed; what else is left out is zero.
/// `notes` gets remarks for the user: columns that match no body, bodies that do not turn. Throws
/// media::Error where a body has no position.
void show_run(const Table& table, bool interpolate, scene::Scene& scene, std::vector<std::string>& notes);

}  // namespace obscura::app
