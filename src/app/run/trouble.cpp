#include "app/run/trouble.h"

#include <fmt/format.h>

#include "app/console/say.h"

namespace obscura::app {

std::string text(const sim::Trouble& trouble) {
  std::string line = fmt::format("at t = {:g} s the {} of {} {}", trouble.time, trouble.quantity,
                                 trouble.body, trouble.what);
  if (!trouble.likely.empty()) line += "; likely: " + trouble.likely;
  return line;
}

void warn_of_steps(const scene::Scene& scene) {
  for (const sim::Trouble& ahead : scene.stability_warnings())
    say(stderr, "{}: warning: {}\n", scene.file, ahead.likely);
}

TroubleError::TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept)
    : std::runtime_error(scene + ": " + app::text(of) + (kept.empty() ? "" : "; " + kept)), trouble(of) {}

}  // namespace obscura::app
