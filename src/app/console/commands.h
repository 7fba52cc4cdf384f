#pragma once

namespace CLI {
class App;
}

namespace obscura::app {

// One command, one file. Each adds itself to the program's command line; its callback runs it and leaves its
// exit code in `exit`.

void add_render(CLI::App& program, int& exit);
void add_join(CLI::App& program, int& exit);
void add_new(CLI::App& program, int& exit);
void add_check(CLI::App& program, int& exit);
void add_states(CLI::App& program, int& exit);
void add_sweep(CLI::App& program, int& exit);
void add_submit(CLI::App& program, int& exit);
void add_export(CLI::App& program, int& exit);
void add_figure(CLI::App& program, int& exit);
void add_docs(CLI::App& program, int& exit);
void add_compare(CLI::App& program, int& exit);
void add_verify(CLI::App& program, int& exit);
void add_golden(CLI::App& program, int& exit);

/// The whole program: reads the command line, runs a command, turns every error into one line and an exit
/// code.
int main(int argc, const char* const* argv);

}  // namespace obscura::app
