#include "app/options.h"

#include <charconv>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/exit.h"
#include "app/memory.h"

namespace obscura::app {

void add_scene(CLI::App& command, std::string& file) {
  command.add_option("SCENE", file, "The scene, a TOML file; - for standard input")->required();
}

void add_sets(CLI::App& command, std::vector<std::string>& sets) {
  command
      .add_option("--set", sets,
                  "Change a key of the scene, as in --set crate.elasticity=0.5; may be given again")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->allow_extra_args(false)  // else it swallows a -- behind it
      ->take_all();
}

void add_progress(CLI::App& command, ProgressKind& kind) {
  command.add_option("--progress", kind, "auto, plain, json (a line an event) or none [auto]")
      ->type_name("KIND")
      ->transform(
          CLI::CheckedTransformer(std::map<std::string, ProgressKind>{{"auto", ProgressKind::automatic},
                                                                      {"plain", ProgressKind::plain},
                                                                      {"json", ProgressKind::json},
                                                                      {"none", ProgressKind::none}})
              .description(""));
}

void add_memory_limit(CLI::App& command) {
  command
      .add_option_function<std::string>(
          "--memory-limit", [](const std::string& text) { hold_memory(parse_bytes(text)); },
          "Never take more memory, as in 2GB [nine tenths of the machine's]")
      ->type_name("SIZE");
}

sim::Rational parse_fps(const std::string& text) {
  const auto fps = sim::parse_rational(text);
  if (!fps || fps->num <= 0 || sim::value(*fps) > 1000)
    throw UsageError(
        fmt::format("--fps {}: expected frames per second up to 1000, as in 60 or 30000/1001", text));
  return *fps;
}

std::pair<int, int> parse_size(const std::string& text) {
  int width = 0, height = 0;
  const char* end = text.data() + text.size();
  const auto w = std::from_chars(text.data(), end, width);
  if (w.ec == std::errc() && w.ptr != end && (*w.ptr == 'x' || *w.ptr == 'X')) {
    const auto h = std::from_chars(w.ptr + 1, end, height);
    if (h.ec == std::errc() && h.ptr == end && width > 0 && height > 0) return {width, height};
  }
  throw UsageError(fmt::format("--size {}: expected WIDTHxHEIGHT in pixels, as in 1920x1080", text));
}

}  // namespace obscura::app
