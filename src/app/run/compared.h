#pragma once

#include <cstdint>
#include <vector>

#include "app/run/simulation.h"
#include "scene/scene.h"

namespace obscura::app {

/// The most runs that a film shows.
inline constexpr std::int64_t kMostCompared = 16;

/// The runs of a film that varies keys (film.vary), each with its scene as its panel shows it: one clock, one
/// camera, one scale. None where the film is of one run. Throws UsageError and scene::Error.
std::vector<Ahead::Run> compared(const scene::Scene& scene);

/// Makes lines of a scene that is shown in a panel as heavy as those of its page, and words large enough to
/// be read. `aspect`: of the page; `height`: of the panel, page units.
void suit_panel(double aspect, double height, scene::Scene& one);

/// The scenes of the runs that a film shows: those of `compared`, or the scene itself.
std::vector<scene::Scene> filmed(const scene::Scene& scene);

/// How many runs a film shows.
std::int64_t runs_of(const scene::Scene& scene);

}  // namespace obscura::app
