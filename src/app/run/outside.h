#pragma once

#include <span>
#include <string>
#include <vector>

#include "draw/compose/depict.h"
#include "scene/scene.h"

namespace obscura::app {

/// The points and labels of a film that stand at a place of the room outside of its picture, at all of these
/// instants: "the label 'far away' is never shown: its place is outside of the picture".
std::vector<std::string> never_shown(const scene::Scene& scene, const draw::Illustrator& artist,
                                     std::span<const sim::Snapshot> moments);

/// The same as the run begins, where the cameras stand; else none.
std::vector<std::string> never_shown(const scene::Scene& scene);

}  // namespace obscura::app
