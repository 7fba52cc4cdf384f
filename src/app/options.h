#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/progress.h"
#include "sim/rational.h"

namespace CLI {
class App;
}

namespace obscura::app {

/// SCENE, of a command that reads one.
void add_scene(CLI::App& command, std::string& file);

/// --set, which every command that reads a scene has.
void add_sets(CLI::App& command, std::vector<std::string>& sets);

/// --progress.
void add_progress(CLI::App& command, ProgressKind& kind);

/// "60", "30000/1001": the frames per second that --fps says, above 0 and up to 1000. Throws UsageError.
sim::Rational parse_fps(const std::string& text);

/// "1920x1080". Throws UsageError.
std::pair<int, int> parse_size(const std::string& text);

}  // namespace obscura::app
