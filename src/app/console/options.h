#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/console/command.h"
#include "app/console/progress.h"
#include "gl/context.h"
#include "sim/math/rational.h"

namespace obscura::app {

/// SCENE, of a command that reads one.
void add_scene(const Command& command, std::string& file);

/// --set, which every command that reads a scene has.
void add_sets(const Command& command, std::vector<std::string>& sets);

/// --progress.
void add_progress(const Command& command, ProgressKind& kind);

/// --memory-limit, which every command has: Command::run() adds it where it stands nowhere before. Held to as
/// soon as it is read. `kept`: as it was written, for a command that hands it on.
void add_memory_limit(const Command& command, std::string* kept = nullptr);

/// --backend, which every command that draws with OpenGL has.
void add_backend(const Command& command, gl::Backend& backend);

/// "60", "30000/1001": the frames per second that --fps says, above 0 and up to 1000. Throws UsageError.
sim::Rational parse_fps(const std::string& text);

/// "1920x1080". Throws UsageError.
std::pair<int, int> parse_size(const std::string& text);

/// Requires that a name that an option gives ends so. Throws UsageError.
void require_ending(std::string_view option, const std::string& path, std::string_view ending);

/// Requires that what is written to `out` does not replace the file `in`, which is read. Throws UsageError.
void spare(const std::string& out, const std::string& in);

}  // namespace obscura::app
