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

std::vector<std::string> limit_notes(const sim::Run& run) {
  std::vector<std::string> notes;
  const auto note = [&](const sim::LimitMet& met, std::string_view what) {
    if (met.steps == 0) return;
    notes.push_back(fmt::format("{} step{} t = {:.6g} s, {}", met.steps,
                                met.steps > 1 ? "s, the first at" : ", at",
                                double(met.first) / sim::value(run.rate()), what));
  };
  const sim::LimitsMet met = run.limits_met();
  note(met.work,
       "met a limit of the direct solver's work and went on to the first order only; a higher physics.rate "
       "shares the work out");
  note(met.substeps, "had bodies meet faster than 4,800 substeps a second follow; a physics.rate above does");
  return notes;
}

void tell_limits(const scene::Scene& scene, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) say(stderr, "{}: note: {}\n", scene.file, note);
}

TroubleError::TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept)
    : std::runtime_error(scene + ": " + app::text(of) + (kept.empty() ? "" : "; " + kept)), trouble(of) {}

}  // namespace obscura::app
