#pragma once

#include "app/run/simulation.h"
#include "scene/scene.h"

namespace obscura::app {

/// Runs a scene once, from its start to its duration, for the charts and the marks of its film. Where the run
/// cannot go on they end there. Throws Interrupted.
Ahead ahead(const scene::Scene& scene);

/// The scales of arrows that a scene sets, or that its bodies' own arrows have; 0: of others.
draw::Scales given_scales(const scene::Scene& scene, const sim::SceneInfo& cast);

}  // namespace obscura::app
