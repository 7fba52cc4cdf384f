#pragma once

#include <memory>
#include <string>

#include "scene/scene.h"
#include "sim/step/run.h"

namespace obscura::app {

// A checkpoint is a file with the whole state of a run between two steps. It begins with a line that names
// what it is, and the hash of what follows: a damaged one is known as such.

/// Writes the state at which `run`, of this scene, stands; with `durable` to the disk itself. Throws
/// media::Error.
void write_checkpoint(const std::string& path, const scene::Scene& scene, const sim::Run& run, bool durable);

/// A run of the scene that goes on from a checkpoint, to the same bits. Throws media::Error naming the path
/// where the file is damaged, or is of another scene; its look, film and duration may differ.
std::unique_ptr<sim::Run> run_from(const std::string& path, const scene::Scene& scene);

}  // namespace obscura::app
