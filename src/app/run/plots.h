#pragma once

#include <vector>

#include "draw/page/plot.h"
#include "scene/scene.h"

namespace obscura::app {

/// Runs a scene for each of its figure's plots. `marks`: instants that the panels show, s.
std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks);

}  // namespace obscura::app
