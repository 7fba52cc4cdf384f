#pragma once

#include <vector>

#include "draw/page/chart.h"
#include "draw/page/plot.h"
#include "scene/scene.h"

namespace obscura::app {

/// Runs a scene for each of its figure's plots. `marks`: instants that the panels show, s.
std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks);

/// Runs a scene once, from its start to its duration, for the charts of its film. Where the run cannot go on
/// they end. No more points are kept than a line of a picture shows, however long it is. Throws Interrupted.
draw::Charts charts(const scene::Scene& scene);

}  // namespace obscura::app
