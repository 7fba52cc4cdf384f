#pragma once

#include <vector>

#include "draw/page/chart.h"
#include "draw/page/plot.h"
#include "scene/scene.h"

namespace obscura::app {

/// Runs a scene for each of its figure's plots. `marks`: instants that the panels show, s.
std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks);

/// Runs a scene once, from its start to its duration, for the charts of its film. The charts end where the
/// run cannot go on. Keeps no more points than a line of a picture shows, however long the run is. Throws
/// Interrupted.
draw::Charts charts(const scene::Scene& scene);

}  // namespace obscura::app
