// obscura check: reads, validates and builds scenes without opening GL; says what a render would do.

#include <array>
#include <iterator>
#include <memory>
#include <thread>

#include <fmt/format.h>

#include "app/command.h"
#include "app/commands.h"
#include "app/exit.h"
#include "app/film.h"
#include "app/memory.h"
#include "app/needs.h"
#include "app/options.h"
#include "app/shots.h"
#include "media/error.h"
#include "scene/error.h"
#include "sim/contact_step.h"
#include "sim/run.h"

namespace obscura::app {

namespace {

std::string count(std::size_t n, const char* one, const char* many) {
  return fmt::format("{} {}", n, n == 1 ? one : many);
}

// how long the first steps are watched, s
constexpr double kPatience = 0.2;

// what holds bodies apart, and why that
template <int D>
std::string contact(const sim::Model<D>& model) {
  if (model.collision == sim::Collision::handout) return "the handout's: walls alone, put back and pushed";
  const bool direct = sim::solver(model) == sim::Solver::direct;
  const sim::Crowd crowd = sim::crowd(model);
  std::string why;
  if (model.collision == sim::Collision::event)
    why = "every event at its own time";
  else if (!model.chains.empty())
    why = count(model.chains.size(), "chain", "chains");
  else if (!model.joints.empty())
    why = count(model.joints.size(), "joint", "joints");
  else if (model.solver != sim::Solver::automatic)
    why = "as the scene says";
  else
    why = fmt::format("{} and {} that move; up to {} and {} it is the direct one",
                      count(std::size_t(crowd.bodies), "body", "bodies"),
                      count(std::size_t(crowd.points), "point", "points"), sim::kMostBodies<D>,
                      sim::kMostPoints);
  return fmt::format("{} solver: {}{}", direct ? "direct" : "iterative", why,
                     direct ? "" : "; impacts go from pair to pair");
}

// as sim::ShapeKind counts them
constexpr const char* kKinds[][2] = {{"particle", "particles"},
                                     {"ball", "balls"},
                                     {"box", "boxes"},
                                     {"polygon", "polygons"},
                                     {"body of several shapes", "bodies of several shapes"},
                                     {"capsule", "capsules"},
                                     {"hull", "hulls"}};

// "2 particles, 1 ball, 12 boxes", those kinds that there are; bodies by what they are made of
template <int D>
std::string bodies(const sim::Model<D>& model) {
  using sim::ShapeKind;
  std::array<std::size_t, std::size(kKinds)> numbers{};
  for (const sim::Body<D>& body : model.bodies) {
    ShapeKind kind = body.shape.kind;
    // what stands askew and does not turn is a body of one part
    if (kind == ShapeKind::compound && body.shape.parts.size() == 1) kind = body.shape.parts[0].kind;
    if (kind == ShapeKind::ball && !body.turns()) kind = ShapeKind::point;
    ++numbers[std::size_t(kind)];
  }
  std::string text = count(numbers[0], kKinds[0][0], kKinds[0][1]);
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    if (numbers[k] > 0) text += ", " + count(numbers[k], kKinds[k][0], kKinds[k][1]);
  }
  text += ", " + count(model.springs.size(), "spring", "springs");
  if (!model.joints.empty()) text += ", " + count(model.joints.size(), "joint", "joints");
  std::size_t links = 0;
  for (const sim::Articulation<D>& chain : model.chains) links += chain.bodies.size();
  if (links > 0)
    text += ", " + count(model.chains.size(), "chain", "chains") + " with " + count(links, "link", "links");
  return text + ", " + count(model.walls.size(), "wall", "walls") + ", " +
         count(model.mice.size(), "mouse", "mice");
}

template <int D>
void report(const scene::Scene& scene, const sim::Model<D>& model) {
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  fmt::print("{}: good\n", scene.file);
  fmt::print("  bodies   {}\n", bodies(model));
  fmt::print("  time     {:g} s in {} steps of 1/{} s\n", sim::value(scene.duration),
             sim::ceil(scene.duration * model.rate), sim::text(model.rate));
  fmt::print("  contact  {}\n", contact(model));
  fmt::print("  film     {} frames at {} fps, {}x{}\n", shots.size(), sim::text(scene.film.fps),
             scene.film.width, scene.film.height);
  const Needs film = needs(scene, shots, Output::Form::movie, kPatience);
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  fmt::print("  disk     about {} as a movie\n", bytes_text(film.disk));
  fmt::print("  memory   about {} with {}\n", bytes_text(film.memory(cores)),
             count(std::size_t(cores), "worker", "workers"));
  fmt::print("  takes    about {}, of which {} simulating: an estimate, from its first steps\n",
             time_text(film.seconds(cores)), time_text(film.simulate));
  if (film.memory(1) > memory_limit())
    fmt::print("  warning  that is more memory than the {} it may have\n", bytes_text(memory_limit()));
  for (const sim::Trouble& ahead : scene.forebodings()) fmt::print("  warning  {}\n", ahead.likely);
}

int check(const std::vector<std::string>& files, const std::vector<std::string>& sets) {
  int exit = kDone;
  for (const std::string& file : files) {
    try {
      const scene::Scene scene = scene::read(file, sets);
      std::visit([&](const auto& world) { report(scene, world.model); }, scene.world);
      media::check(scene.name + ".mp4", movie_spec(scene));
    } catch (const scene::Error& error) {
      std::fflush(stdout);
      fmt::print(stderr, "{}\n", error.what());
      exit = kScene;
    } catch (const media::Error& error) {
      fmt::print("  warning  {}\n", error.what());
    }
  }
  return exit;
}

}  // namespace

void add_check(CLI::App& program, int& exit) {
  const Command command(program, exit, "check", "Read scenes and say what would be filmed, without drawing");
  auto files = std::make_shared<std::vector<std::string>>();
  auto sets = std::make_shared<std::vector<std::string>>();
  command.option("SCENE", *files, "Scenes to read").required();
  add_sets(command, *sets);
  add_memory_limit(command);
  command.footer("Examples:\n  obscura check scenes/room.toml\n  obscura check scenes/*.toml");
  command.run([=] { return check(*files, *sets); });
}

}  // namespace obscura::app
