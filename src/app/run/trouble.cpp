#include "app/run/trouble.h"

#include <fmt/format.h>

namespace obscura::app {

std::string text(const sim::Trouble& trouble) {
  std::string line = fmt::format("at t = {:g} s the {} of {} {}", trouble.time, trouble.quantity,
                                 trouble.body, trouble.what);
  if (!trouble.likely.empty()) line += "; likely: " + trouble.likely;
  return line;
}

TroubleError::TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept)
    : std::runtime_error(scene + ": " + app::text(of) + (kept.empty() ? "" : "; " + kept)), trouble(of) {}

}  // namespace obscura::app
