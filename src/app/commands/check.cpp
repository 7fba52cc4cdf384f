// obscura check: reads, validates and builds scenes without opening GL; says what a render would do.

#include <algorithm>
#include <memory>
#include <set>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/compare/format.h"
#include "app/compare/github.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/memory.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "app/film/estimate.h"
#include "app/film/film.h"
#include "app/run/compared.h"
#include "app/run/outside.h"
#include "app/run/run_marks.h"
#include "app/run/shots.h"
#include "media/error.h"
#include "scene/body_kinds.h"
#include "scene/error.h"
#include "sim/solve/contact_solver.h"
#include "sim/solve/iterate/instant_impact.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

using Json = nlohmann::ordered_json;

std::string count(std::size_t n, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

// how long the first steps are watched, s
constexpr double kWatched = 0.5;
// how long a run may take that is run for its marks, s
constexpr double kLongestRun = 20;

// tracks that are touched, and wires, which beads share
template <int D>
std::size_t tracks_of(const sim::Model<D>& model) {
  std::set<const sim::Curve<D>*> all;
  for (const sim::Rail<D>& rail : model.rails) all.insert(rail.curve.get());
  for (const sim::Joint<D>& joint : model.joints)
    if (joint.curve) all.insert(joint.curve.get());
  return all.size();
}

// the contact solver, and why this one
template <int D>
std::string contact(const sim::Model<D>& model) {
  if (model.collision == sim::Collision::handout)
    return "the handout's: only walls; bodies are put back and get an impulse";
  const sim::SolverKind& its = sim::solver_kind(sim::solver(model));
  const sim::BodyCounts crowd = sim::body_counts(model);
  std::string why;
  if (model.collision == sim::Collision::event)
    why = "every event at its own time";
  else if (!model.chains.empty())
    why = count(model.chains.size(), "chain", "chains");
  else if (const std::size_t tracks = tracks_of(model); tracks > 0)
    why = count(tracks, "track", "tracks");
  else if (model.solver != sim::Solver::automatic)
    why = "as the scene says";
  else
    why = fmt::format("{} and {} that move; up to {} and {} the direct solver is used",
                      count(std::size_t(crowd.bodies), "body", "bodies"),
                      count(std::size_t(crowd.points), "point", "points"), sim::kMostBodies<D>,
                      sim::kMostPoints);
  return fmt::format("{} solver: {}{}", its.name, why,
                     its.exact ? ""
                     : model.impacts == sim::Impacts::sequential
                         ? "; impacts are solved pair after pair"
                         : fmt::format("; of one instant, impacts of up to {} contacts are solved together",
                                       sim::InstantImpact<D>::kFew));
}

// how many there are of each kind; bodies by what they are made of
template <int D>
std::vector<std::size_t> numbers_of(const sim::Model<D>& model) {
  std::vector<std::size_t> numbers(scene::body_kinds().size());
  for (const sim::Body<D>& body : model.bodies)
    if (!body.bare) ++numbers[std::size_t(&scene::kind_of(body) - scene::body_kinds().data())];
  return numbers;
}

template <int D>
std::size_t links_of(const sim::Model<D>& model) {
  std::size_t links = 0;
  for (const sim::Articulation<D>& chain : model.chains) links += chain.bodies.size();
  return links;
}

// "2 particles, 1 ball, 12 boxes", those kinds that there are
template <int D>
std::string bodies(const sim::Model<D>& model) {
  const auto numbers = numbers_of(model);
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    const scene::BodyKind& kind = scene::body_kinds()[k];
    if (k > 0 && numbers[k] == 0) continue;
    text += (k > 0 ? ", " : "") + count(numbers[k], kind.called, kind.plural);
  }
  text += ", " + count(model.springs.size(), "spring", "springs");
  const auto joints = std::size_t(std::count_if(model.joints.begin(), model.joints.end(),
                                                [](const auto& joint) { return !joint.curve; }));
  if (joints > 0) text += ", " + count(joints, "joint", "joints");
  if (const std::size_t tracks = tracks_of(model); tracks > 0)
    text += ", " + count(tracks, "track", "tracks");
  const std::size_t links = links_of(model);
  if (links > 0)
    text += ", " + count(model.chains.size(), "chain", "chains") + " with " + count(links, "link", "links");
  return text + ", " + count(model.walls.size(), "wall", "walls") + ", " +
         count(model.mice.size(), "mouse", "mice");
}

// how many forces beside gravity and drag, and between how many pairs of bodies they act
template <int D>
std::pair<std::size_t, double> forces_of(const sim::Model<D>& model) {
  double pairs = 0;
  for (const sim::Force<D>& force : model.forces) {
    const double n = double(force.subjects.size());
    if (force.on == sim::Force<D>::On::among) pairs += 0.5 * n * (n - 1);
    if (force.on == sim::Force<D>::On::between) pairs += 0.5 * n;
  }
  return {model.forces.size(), pairs};
}

// the film that render would make
struct Plan {
  Shots shots;
  Needs film;
  int cores = 1;
  std::vector<std::string> warnings;
  std::vector<std::string> runs;  // that the film shows together
};

// the scene with the times of its run's marks, at which the film may stand still or end, where its run takes
// no long time
scene::Scene with_marks(scene::Scene scene) {
  if (!waits_for_run(scene)) return scene;
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  doing("measuring the first steps of " + scene.file);
  if (needs(scene, shots, {Output::Form::movie, scene.name + ".mp4"}, kWatched).simulate > kLongestRun)
    return scene;
  doing("running " + scene.file + " for its marks");
  return with_run_marks(std::move(scene));
}

Plan plan(const scene::Scene& scene) {
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  doing("measuring the first steps of " + scene.file);
  // all runs of a film have to be scenes
  const std::vector<Ahead::Run> runs = compared(scene);
  Plan it{shots, needs(scene, shots, {Output::Form::movie, scene.name + ".mp4"}, kWatched), 1, {}, {}};
  it.cores = std::max(1, int(std::thread::hardware_concurrency()));
  if (it.film.memory(1) > memory_limit())
    it.warnings.push_back(
        fmt::format("that is more memory than the {} it may have", bytes_text(memory_limit())));
  for (const sim::Trouble& ahead : scene.stability_warnings()) it.warnings.push_back(ahead.likely);
  for (std::string& each : never_shown(scene)) it.warnings.push_back(std::move(each));
  if (waits_for_run(scene))
    it.warnings.push_back(
        "only its run tells where the film stands still or ends at marks and events: frames "
        "are counted without them");
  for (const Ahead::Run& run : runs) it.runs.push_back(run.look.name);
  try {
    media::check(scene.name + ".mp4", movie_spec(scene));
  } catch (const media::Error& error) {
    it.warnings.push_back(error.what());
  }
  return it;
}

template <int D>
std::string report(const scene::Scene& scene, const sim::Model<D>& model, const Plan& plan) {
  std::string all = fmt::format("{}: good\n", scene.file);
  const auto row = [&](const char* name, const std::string& value) {
    all += fmt::format("  {:<8} {}\n", name, value);
  };
  row("bodies", bodies(model));
  if (const auto [forces, pairs] = forces_of(model); forces > 0) {
    std::string said = count(forces, "force", "forces") + " beside gravity and drag";
    if (pairs > 0)
      said += fmt::format(", between {:.0f} {} of bodies in each stage of a step", pairs,
                          pairs == 1 ? "pair" : "pairs");
    row("forces", said);
  }
  row("time", fmt::format("{:g} s in {} steps of 1/{} s", sim::value(scene.duration),
                          sim::ceil(scene.duration * model.rate), sim::text(model.rate)));
  row("contact", contact(model));
  row("film", fmt::format("{} frames at {} fps, {}x{}", plan.shots.size(), sim::text(scene.film.fps),
                          scene.film.width, scene.film.height));
  if (!plan.runs.empty()) row("runs", fmt::format("{}: {}", plan.runs.size(), fmt::join(plan.runs, "; ")));
  row("disk", fmt::format("about {} as a movie", bytes_text(plan.film.disk)));
  row("memory", fmt::format("about {} with {}", bytes_text(plan.film.memory(plan.cores)),
                            count(std::size_t(plan.cores), "worker", "workers")));
  row("takes", fmt::format("about {}, of which {} simulating: an estimate, from its first steps",
                           time_text(plan.film.seconds(plan.cores)), time_text(plan.film.simulate)));
  for (const std::string& warning : plan.warnings) row("warning", warning);
  return all;
}

template <int D>
Json json(const scene::Scene& scene, const sim::Model<D>& model, const Plan& plan) {
  Json bodies = Json::object();
  const auto numbers = numbers_of(model);
  for (std::size_t k = 0; k < numbers.size(); ++k) bodies[scene::body_kinds()[k].plural] = numbers[k];
  return {{"file", scene.file},
          {"good", true},
          {"dimension", D},
          {"bodies", bodies},
          {"springs", model.springs.size()},
          {"joints", model.joints.size()},
          {"tracks", tracks_of(model)},
          {"chains", model.chains.size()},
          {"links", links_of(model)},
          {"walls", model.walls.size()},
          {"mice", model.mice.size()},
          {"forces", model.forces.size()},
          {"force_pairs", forces_of(model).second},
          {"duration", sim::value(scene.duration)},
          {"steps", sim::ceil(scene.duration * model.rate)},
          {"rate", sim::value(model.rate)},
          {"contact", contact(model)},
          {"film",
           {{"frames", plan.shots.size()},
            {"fps", sim::value(scene.film.fps)},
            {"width", scene.film.width},
            {"height", scene.film.height}}},
          {"estimate",
           {{"disk", plan.film.disk},
            {"memory", plan.film.memory(plan.cores)},
            {"workers", plan.cores},
            {"seconds", plan.film.seconds(plan.cores)},
            {"simulate", plan.film.simulate}}},
          {"warnings", plan.warnings},
          {"errors", Json::array()}};
}

int check(const std::vector<std::string>& files, const std::vector<std::string>& sets, Format format) {
  int exit = kDone;
  Json scenes = Json::array();
  std::string summary;
  for (const std::string& file : files) {
    try {
      doing("reading " + file);
      const scene::Scene scene = with_marks(scene::read(file, sets));
      const Plan made = plan(scene);
      std::string said;
      std::visit(
          [&](const auto& world) {
            if (format == Format::json)
              scenes.push_back(json(scene, world.model, made));
            else
              said = report(scene, world.model, made);
          },
          scene.world);
      clear_waiting();
      say_lines(stdout, format == Format::github ? github::verbatim(said) : said);
      if (format != Format::github) continue;
      for (const std::string& warning : made.warnings)
        fmt::print("{}", github::command({.level = github::Annotation::Level::warning,
                                          .file = file,
                                          .title = "check",
                                          .message = warning}));
    } catch (const scene::Error& error) {
      exit = kScene;
      if (format == Format::json) {
        scenes.push_back(
            {{"file", file}, {"good", false}, {"warnings", Json::array()}, {"errors", json_of(error)}});
        continue;
      }
      std::fflush(stdout);
      say_lines(stderr, error.what());
      if (format != Format::github) continue;
      fmt::print("{}", github::commands(error));
      summary += github::quoted(error.what());
    }
  }
  if (format == Format::json) {
    Json top = json_head("check", exit);
    top["scenes"] = std::move(scenes);
    fmt::print("{}", text_of(top));
  }
  if (format == Format::github)
    github::add_to_summary(
        fmt::format("### Scenes checked: {}\n\n",
                    summary.empty() ? fmt::format("{}, all good", files.size()) : "not all good") +
        summary);
  return exit;
}

}  // namespace

OBSCURA_COMMAND(50, check) {
  const Command command(program, exit, "check", "Check scenes and say what would be filmed, without drawing");
  auto files = std::make_shared<std::vector<std::string>>();
  auto sets = std::make_shared<std::vector<std::string>>();
  command.option("SCENE", *files, "Scenes to check").required();
  auto format = std::make_shared<Format>(Format::text);
  add_sets(command, *sets);
  add_format(command, *format);
  add_memory_limit(command);
  command.footer("Examples:\n  obscura check scenes/room.toml\n  obscura check scenes/*.toml");
  command.run([=] { return check(*files, *sets, *format); });
}

}  // namespace obscura::app
