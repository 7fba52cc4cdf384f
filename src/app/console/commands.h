#pragma once

#include <span>

namespace CLI {
class App;
}

namespace obscura::app {

/// A command is one file of the room app, wherever it fits, with
///   OBSCURA_COMMAND(35, tour) { const Command command(program, exit, "tour", "..."); ... }
/// which adds itself to the program's command line; its callback runs it and leaves its exit code in `exit`.
/// src/app/commands.cmake lists all of them, in the order of their numbers, as help shows them.
#define OBSCURA_COMMAND(place, name) void add_##name(CLI::App& program, int& exit)

using AddCommand = void(CLI::App& program, int& exit);

/// All commands, in order.
std::span<AddCommand* const> commands();

/// The whole program: reads the command line, runs a command, turns every error into one line and an exit
/// code.
int main(int argc, const char* const* argv);

}  // namespace obscura::app
