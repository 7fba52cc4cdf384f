#include "app/run/trouble.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/console/say.h"
#include "draw/picture/type.h"
#include "sim/solve/iterate/substeps.h"

namespace obscura::app {

namespace {

// a rough spell: so long in all, s, and in so many of its steps
constexpr double kRoughFor = 0.1, kRoughPart = 0.3;
constexpr double kWild = 0.03;  // of the largest speed

}  // namespace

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

void warn_of_letters(const scene::Scene& scene) {
  const std::vector<std::string> letters = draw::letters_without_glyph();
  if (!letters.empty())
    say(stderr,
        "{}: warning: the font has no {}: a box stands in its place; OBSCURA_FONT=FAMILY chooses another\n",
        scene.file, std::string(fmt::format("{}", fmt::join(letters, " "))));
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
  note(met.substeps,
       sim::value(run.rate()) < sim::kMostSubsteps
           ? "had bodies meet faster than 4,800 substeps a second follow; a physics.rate above does"
           : "had bodies meet faster than its steps follow; a higher physics.rate does");
  note(met.passages,
       "had bodies pass each other, or a centre, more closely than the forces were followed: energy may have "
       "come from nowhere; a softening or a higher physics.rate helps");
  if (const sim::WildestStep& it = met.wildest; it.error > kWild * it.pace)
    note({1, it.step, it.step},
         "had a force on a body change by as much as itself: energy may have come from nowhere; a higher "
         "physics.rate helps");
  // what is damped may be rough for a moment
  const double rough = double(met.rough.steps);
  if (rough > kRoughFor * sim::value(run.rate()) &&
      rough > kRoughPart * double(met.rough.last - met.rough.first + 1))
    note(
        met.rough,
        "had springs, joints or forces swing a body faster than Runge-Kutta follows, which takes energy from "
        "it; a higher physics.rate helps");
  return notes;
}

void tell_limits(const scene::Scene& scene, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) say(stderr, "{}: note: {}\n", scene.file, note);
}

TroubleError::TroubleError(const std::string& scene, const sim::Trouble& of, const std::string& kept)
    : std::runtime_error(scene + ": " + app::text(of) + (kept.empty() ? "" : "; " + kept)), trouble(of) {}

}  // namespace obscura::app
