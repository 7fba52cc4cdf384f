#pragma once

#include <vector>

#include "app/run/simulation.h"
#include "draw/page/plot.h"
#include "scene/scene.h"

namespace obscura::app {

/// Runs a scene for each of its figure's plots. `marks`: instants that the panels show, s.
std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks);

/// Runs a scene once, from its start to its duration, for the charts and the marks of its film. Where the run
/// cannot go on they end there. Throws Interrupted.
Ahead ahead(const scene::Scene& scene);

}  // namespace obscura::app
