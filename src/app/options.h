#pragma once

#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace obscura::app {

/// --set, which every command that reads a scene has.
void add_sets(CLI::App& command, std::vector<std::string>& sets);

/// "1920x1080". Throws UsageError.
std::pair<int, int> parse_size(const std::string& text);

}  // namespace obscura::app
