#pragma once

#include <string>

#include "app/console/table.h"

namespace obscura::app {

/// Scripts that complete a line of the program in a shell: commands, options, the words that an option takes,
/// and the files of the kind that it wants, as scenes for SCENE.
std::string bash_completion(const CommandTables& tables);
std::string zsh_completion(const CommandTables& tables);
std::string fish_completion(const CommandTables& tables);

}  // namespace obscura::app
