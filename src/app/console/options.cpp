#include "app/console/options.h"

#include <charconv>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/console/memory.h"

namespace obscura::app {

void add_scene(const Command& command, std::string& file) {
  command.option("SCENE", file, "The scene, a TOML file; - for standard input").required();
}

void add_sets(const Command& command, std::vector<std::string>& sets) {
  command
      .option("--set", sets, "Change a key of the scene, as in --set crate.elasticity=0.5; may be repeated")
      .type("PATH=VALUE")
      .repeated();
}

void add_progress(const Command& command, ProgressKind& kind) {
  command
      .choice("--progress", kind,
              {{"auto", ProgressKind::automatic},
               {"plain", ProgressKind::plain},
               {"json", ProgressKind::json},
               {"none", ProgressKind::none}},
              "auto, plain, json (one line per event) or none [auto]")
      .type("KIND");
}

void add_memory_limit(const Command& command, std::string* kept) {
  const auto hold = [kept](const std::string& text) {
    hold_memory(parse_bytes(text));
    if (kept) *kept = text;
  };
  command
      .option("--memory-limit", hold,
              "Never use more memory than this, as in 2GB [nine tenths of the machine's]")
      .type("SIZE");
}

void add_backend(const Command& command, gl::Backend& backend) {
  command
      .choice("--backend", backend,
              {{"auto", gl::Backend::automatic}, {"osmesa", gl::Backend::osmesa}, {"egl", gl::Backend::egl}},
              "auto, osmesa or egl: which OpenGL draws, never a GPU unless named [auto]")
      .type("NAME");
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

void require_ending(std::string_view option, const std::string& path, std::string_view ending) {
  if (!path.ends_with(ending) || path.size() == ending.size())
    throw UsageError(fmt::format("{} {}: expected a name that ends with {}", option, path, ending));
}

void spare(const std::string& out, const std::string& in) {
  std::error_code none;
  if (std::filesystem::equivalent(out, in, none))
    throw UsageError(fmt::format("-o {}: would be written over {}, which is read", out, in));
}

}  // namespace obscura::app
