#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/memory.h"
#include "app/console/say.h"
#include "app/run/trouble.h"
#include "draw/picture/error.h"
#include "gl/error.h"
#include "gl/renderer.h"
#include "media/error.h"
#include "media/movie.h"
#include "page/error.h"
#include "page/page.h"
#include "scene/complaints.h"
#include "scene/error.h"
#include "scene/input.h"

namespace obscura::app {

namespace {

// the version, and those of what draws and encodes here
std::string version() {
  std::string gl;
  try {
    const gl::Renderer renderer(16, 16);
    gl = fmt::format("OpenGL {}, {}", renderer.version(), renderer.device());
  } catch (const std::exception& error) {
    gl = fmt::format("OpenGL: {}", error.what());
  }
  return fmt::format("obscura {}\n{}\n{}\n{}", OBSCURA_VERSION, gl, media::libraries(), page::libraries());
}

// CLI11 would only say that a command is missing
void know_command(const CLI::App& program, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) {
    if (command->get_name() == argv[1]) return;
    names.push_back(command->get_name());
  }
  const std::string word = argv[1];
  if (word == "help")
    throw UsageError("there is no command 'help'; see obscura --help, or obscura render --help");
  if (word.ends_with(".toml"))
    throw UsageError(
        fmt::format("'{0}' is a scene, not a command: obscura render {0}", scene::one_line(word)));
  const std::string meant = scene::did_you_mean(argv[1], {names.begin(), names.end()});
  throw UsageError(fmt::format(
      "there is no command '{}'{}", argv[1],
      meant.empty() ? fmt::format("; the commands are {}; see obscura --help", fmt::join(names, ", "))
                    : meant));
}

// of an option that there is not: its name, and the one that was probably meant; else CLI11's words
std::string usage_text(const CLI::App& program, const CLI::ParseError& error) {
  const auto parsed = program.get_subcommands();
  const CLI::App& command = parsed.empty() ? program : *parsed.front();
  const std::string name = parsed.empty() ? "" : command.get_name() + " ";
  std::string text = error.what();
  for (const std::string& word : program.remaining(true)) {
    if (word.size() < 2 || word[0] != '-') continue;
    const std::string option = word.substr(0, word.find('='));
    std::vector<std::string> names;
    for (const CLI::Option* each : command.get_options())
      for (const std::string& known : each->get_lnames()) names.push_back("--" + known);
    text = fmt::format("{} no option {}{}", parsed.empty() ? "there is" : command.get_name() + " has",
                       scene::one_line(option), scene::did_you_mean(option, {names.begin(), names.end()}));
    break;
  }
  return fmt::format("{}; see obscura {}--help", text, name);
}

int complain(int code, const std::string& what) {
  say(stderr, "obscura: {}\n", what);
  return code;
}

// Flush stdout and report write errors; a closed pipe is not an error.
int said(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  if (errno == EPIPE || (code != kDone && code != kDiffers)) return code;
  return complain(kFiles, fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

int run(int argc, const char* const* argv) {
  CLI::App program(
      "Simulates a room of bodies that move, in the plane or in space, and films it without a window.",
      argc > 0 ? argv[0] : "obscura");
  program.footer(
      "Examples:\n"
      "  obscura new ball                        write ball.toml to start from\n"
      "  obscura render ball.toml                film it: render_out/ball.mp4\n"
      "  obscura render ball.toml --at 1.5       one picture of it\n"
      "  obscura figure ball.toml -o ball.pdf    a figure for print\n"
      "  obscura states ball.toml --every 0.1    the states, as data\n"
      "  obscura sweep ball.toml --vary seed=1:100 --measure hash@end    many runs as a table\n"
      "  obscura export ball.toml                the motion as glTF, for another renderer\n"
      "  obscura compare old.png new.png         whether they are the same, and if not, why\n"
      "  obscura golden scenes                   compare scenes with references\n\n"
      "Exit codes: 0 done, 1 pictures or states differ, 2 usage, 3 scene, 4 files, codec or memory, 5 "
      "OpenGL, 6 the "
      "simulation diverged, 130 "
      "interrupted.");
  program.require_subcommand(1);
  program.set_version_flag("--version", version, "Show the versions of obscura, OpenGL, FFmpeg and libpng");
  program.get_formatter()->column_width(34);
  int exit = kDone;
  for (AddCommand* add : commands()) add(program, exit);
  try {
    know_command(program, argc, argv);
    program.parse(argc, argv);
    return exit;
  } catch (const CLI::Success& success) {
    return program.exit(success);
  } catch (const CLI::ParseError& error) {
    return complain(kUsage, usage_text(program, error));
  } catch (const UsageError& error) {
    return complain(kUsage, error.what());
  } catch (const scene::Error& error) {
    say_lines(stderr, error.what());
    return kScene;
  } catch (const TroubleError& error) {
    return complain(kDiverged, error.what());
  } catch (const gl::Error& error) {
    return complain(kGl, error.what());
  } catch (const media::Error& error) {
    return complain(kFiles, error.what());
  } catch (const page::Error& error) {
    return complain(kFiles, error.what());
  } catch (const Interrupted&) {
    return kInterrupted;
  } catch (const scene::Stopped&) {
    return kInterrupted;
  } catch (const draw::Error& error) {
    return complain(kFiles, error.what());
  } catch (const std::bad_alloc&) {
    return complain(kFiles, out_of_memory());
  } catch (const std::length_error&) {
    return complain(kFiles, out_of_memory());
  } catch (const std::system_error& error) {
    // a thread that cannot be had
    if (error.code() == std::errc::resource_unavailable_try_again) return complain(kFiles, out_of_memory());
    // the reader has closed the pipe
    if (error.code() == std::errc::broken_pipe) return kDone;
    return complain(kFiles, error.what());
  }
}

}  // namespace

int main(int argc, const char* const* argv) {
  heed_interrupts();
  scene::heed(interrupted);
  survive_libraries();
  hold_memory(most_memory());
  return said(run(argc, argv));
}

}  // namespace obscura::app
