#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// What happens in a run of a scene, in sentences: what is there, what hits what when, what comes to rest,
/// what becomes of the energy, what the film says. Runs the scene once. Throws Interrupted.
std::vector<std::string> description(const scene::Scene& scene);

/// What a picture of an instant shows, in sentences: the alternative text of a still.
std::string picture_text(const scene::Scene& scene, const sim::SceneInfo& cast, const sim::Snapshot& now);

/// The same without its title: the second panel of a figure, and the third.
std::string instant_text(const sim::SceneInfo& cast, const sim::Snapshot& now);

}  // namespace obscura::app
