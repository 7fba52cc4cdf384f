// obscura states: the states, as data, without GL. 17 significant digits, so that every double reads
// back.

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "app/run/checkpoint.h"
#include "app/run/columns.h"
#include "app/run/measures.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/shots.h"
#include "app/run/trouble.h"
#include "media/error.h"
#include "media/file.h"
#include "scene/scene.h"
#include "sim/solve/contact_solver.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

std::string number(double x) { return fmt::format("{:.17g}", x == 0 ? 0.0 : x); }

std::string vector(const sim::Vec3& v, int dimension) {
  std::string text = "[" + number(v.x()) + ", " + number(v.y());
  if (dimension == 3) text += ", " + number(v.z());
  return text + "]";
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

// standard output, or a file that has its name when it is whole
class Sink {
 public:
  explicit Sink(const std::optional<std::string>& path) {
    if (!path || *path == "-") return;
    media::make_folder_of(*path);
    file_.emplace(*path);
  }
  void put(const std::string& text) {
    if (file_) return file_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    clear_waiting();
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size())
      throw media::Error("standard output cannot be written");
  }
  void finish() {
    if (file_) return file_->place(false);
    if (std::fflush(stdout) != 0) throw media::Error("standard output cannot be written");
  }

 private:
  std::optional<media::File> file_;
};

const std::string& name(const sim::SceneInfo& cast, int body) { return cast.bodies[std::size_t(body)].name; }

// a spin or turning momentum: one number in the plane
std::string spin(const sim::Vec3& w, int dimension) {
  return dimension == 2 ? number(w.z()) : vector(w, dimension);
}

// "angle": rad; in space "orientation": a unit quaternion x, y, z, w
std::string turn(const sim::Snapshot::Body& body, int dimension) {
  if (dimension == 2) return "\"angle\": " + number(body.angle);
  const Eigen::Quaterniond& q = body.orientation;
  return fmt::format("\"orientation\": [{}, {}, {}, {}]", number(q.x()), number(q.y()), number(q.z()),
                     number(q.w()));
}

// one instant as a JSON object
std::string json(const sim::Snapshot& now, const sim::SceneInfo& cast, const std::string& hash) {
  const int d = cast.dimension;
  const sim::Energies& e = now.energies;
  std::string text = fmt::format(
      "    {{\"time\": {}, \"step\": {}, \"hash\": \"{}\",\n"
      "     \"energy\": {{\"kinetic\": {}, \"potential\": {}, \"gravity\": {}, \"springs\": {}, \"total\": "
      "{}, "
      "\"displacement\": {}, \"impacts\": {}{}{}}},\n"
      "     \"momentum\": {}, \"angular_momentum\": {},\n     \"bodies\": [",
      number(now.time), now.step, hash, number(e.kinetic), number(e.potential()), number(e.gravity),
      number(e.springs), number(e.total()), number(e.displacement), number(e.impacts),
      cast.mice.empty() ? "" : fmt::format(", \"hand\": {}", number(e.hand)),
      (cast.forces ? fmt::format(", \"fields\": {}", number(e.fields)) : "") +
          (cast.books_work ? fmt::format(", \"work\": {}", number(e.work)) : ""),
      vector(now.momentum, d), spin(now.angular_momentum, d));
  for (std::size_t i = 0; i < now.bodies.size(); ++i) {
    const auto& body = now.bodies[i];
    text += fmt::format(
        "{}\n       {{\"name\": {}, \"position\": {}, {}, \"velocity\": {}, \"spin\": {}, "
        "\"at_rest\": "
        "{}}}",
        i ? "," : "", quoted(cast.bodies[i].name), vector(body.position, d), turn(body, d),
        vector(body.velocity, d), spin(body.spin, d), body.at_rest);
  }
  text += "],\n     \"contacts\": [";
  for (std::size_t i = 0; i < now.contacts.size(); ++i) {
    const auto& contact = now.contacts[i];
    text += fmt::format(
        "{}\n       {{\"body\": {}, {}, \"point\": {}, \"normal\": {}, \"gap\": {}, \"force\": {}, "
        "\"impulse\": "
        "{}, \"mode\": \"{}\"}}",
        i ? "," : "", quoted(name(cast, contact.body)),
        contact.other < 0 ? fmt::format("\"wall\": {}", contact.wall)
                          : fmt::format("\"other\": {}", quoted(name(cast, contact.other))),
        vector(contact.point, d), vector(contact.normal, d), number(contact.gap), vector(contact.force, d),
        vector(contact.impulse, d),
        !contact.holds    ? "bouncing"
        : contact.sliding ? "sliding"
                          : "sticking");
  }
  text += "],\n     \"joints\": [";
  for (std::size_t i = 0; i < now.joints.size(); ++i) {
    const auto& joint = now.joints[i];
    text += fmt::format(
        "{}\n       {{\"name\": {}, \"a\": {}, \"b\": {}, \"force\": {}, \"torque\": {}, \"broken\": {}}}",
        i ? "," : "", quoted(cast.joints[i].name), vector(joint.a, d), vector(joint.b, d),
        vector(joint.force, d), spin(joint.torque, d), joint.broken);
  }
  return text + "]}";
}

// the columns are the paths that --set and --measure know, one row an instant; the hash stands third
constexpr std::size_t kHash = 2;

std::string csv_header(const std::vector<Column>& all) {
  std::string line;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == kHash) line += ",hash";
    line += (i ? "," : "") + all[i].name;
  }
  return line + "\n";
}

std::string csv_row(const sim::Snapshot& now, const std::string& hash, const std::vector<Column>& all) {
  std::string line;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == kHash) line += "," + hash;
    line += (i ? "," : "") + number(all[i].read(now));
  }
  return line + "\n";
}

// the solver in use; none in the handout's mode
template <int D>
std::string solver_name(const sim::Model<D>& model) {
  if (model.collision == sim::Collision::handout) return "null";
  return fmt::format("\"{}\"", sim::solver_kind(sim::solver(model)).name);
}

struct StatesFlags {
  std::string scene;
  std::optional<std::string> at, every, from_checkpoint, format, measure, out;
  std::vector<std::string> sets;
  bool events = false;
  int jobs = 1;
};

// as asked for, or by the ending of the file
std::string form(const StatesFlags& flags) {
  if (flags.format) return *flags.format;
  if (!flags.out || *flags.out == "-") return "json";
  const std::string ending = std::filesystem::path(*flags.out).extension().string();
  if (ending == ".csv" || ending == ".json") return ending.substr(1);
  throw UsageError(
      fmt::format("-o {}: expected a name that ends with .csv or .json, or --format", *flags.out));
}

std::vector<sim::Rational> times_of(const StatesFlags& flags, const scene::Scene& scene) {
  if (flags.at && flags.every) throw UsageError("--at and --every exclude each other");
  if (flags.at) return instants(with_instants(scene, "--at", *flags.at));
  const sim::Rational every =
      flags.every ? sim::parse_rational(*flags.every).value_or(sim::Rational{0, 1}) : sim::rational(1);
  if (!(sim::Rational{0, 1} < every))
    throw UsageError(fmt::format("--every {}: expected seconds above 0", *flags.every));
  return instants(fmt::format("0:{}:{}", sim::text(scene.duration), sim::text(every)));
}

// what has fired, as a list
std::string events_text(const std::vector<sim::RunEvent>& events, bool as_json, const std::string& file) {
  const auto list = [](const std::vector<std::string>& words) { return nlohmann::json(words).dump(); };
  std::string text = as_json ? fmt::format("{{\"version\": \"{}\", \"scene\": {},\n \"events\": [",
                                           OBSCURA_VERSION, quoted(file))
                             : "time,event,condition,of,marks\n";
  for (std::size_t i = 0; i < events.size(); ++i) {
    const sim::RunEvent& it = events[i];
    const double t = sim::value(it.time);
    text +=
        as_json
            ? fmt::format(
                  "{}\n  {{\"time\": {}, \"event\": {}, \"condition\": \"{}\", \"of\": {}, \"marks\": {}}}",
                  i > 0 ? "," : "", number(t), quoted(it.name), it.what, list(it.of), list(it.marks))
            : fmt::format("{},{},{},{},{}\n", number(t), it.name, it.what, fmt::join(it.of, " "),
                          fmt::join(it.marks, " "));
  }
  return as_json ? text + "\n ]}\n" : text;
}

int list_events(const StatesFlags& flags, const scene::Scene& scene, sim::Run& run, sim::Rational to) {
  Sink sink(flags.out);
  doing("simulating", sim::value(run.now()), sim::value(to), "s");
  const auto outcome = run.at(to);
  if (std::holds_alternative<sim::Stopped>(outcome)) return kInterrupted;
  sink.put(events_text(sim::events_until(run, to), form(flags) == "json", scene.file));
  tell_limits(scene, limit_notes(run));
  if (const auto* trouble = std::get_if<sim::Trouble>(&outcome)) {
    std::fflush(stdout);
    throw TroubleError(scene.file, *trouble, "");
  }
  sink.finish();
  return kDone;
}

// what --measure asks for, as sweeps measure it
int measure(const StatesFlags& flags, const scene::Scene& scene) {
  for (const auto& [word, given] :
       {std::pair("--at", flags.at.has_value()), std::pair("--every", flags.every.has_value()),
        std::pair("--events", flags.events),
        std::pair("--from-checkpoint", flags.from_checkpoint.has_value())})
    if (given)
      throw UsageError(
          fmt::format("--measure and {} exclude each other; a measure has its own time, as in x@2", word));
  const std::vector<Question> asked = questions(*flags.measure);
  check(asked, scene);
  const bool as_json = form(flags) == "json";
  Sink sink(flags.out);
  const Answers found = answers(scene, asked);
  tell_limits(scene, found.limit_notes);
  std::string names, values;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const std::string value = i < found.values.size() ? found.values[i] : "";
    const bool hash = asked[i].path == "hash";
    names += (i > 0 ? "," : "") + asked[i].text;
    values += as_json ? fmt::format("{}\n  {}: {}", i > 0 ? "," : "", quoted(asked[i].text),
                                    value.empty() ? "null"
                                    : hash        ? quoted(value)
                                                  : value)
                      : (i > 0 ? "," : "") + value;
  }
  sink.put(as_json ? fmt::format("{{\"version\": \"{}\", \"scene\": {},\n \"measures\": {{{}\n }}}}\n",
                                 OBSCURA_VERSION, quoted(scene.file), values)
                   : names + "\n" + values + "\n");
  if (found.trouble) {
    std::fflush(stdout);
    throw TroubleError(scene.file, *found.trouble, "");
  }
  sink.finish();
  return kDone;
}

int states(const StatesFlags& flags) {
  scene::Scene read = scene::read(flags.scene, flags.sets);
  read.share_steps(flags.jobs);
  const scene::Scene& scene = read;
  if (flags.out) spare(*flags.out, flags.scene);
  warn_of_steps(scene);
  if (flags.measure) return measure(flags, scene);
  auto times = times_of(flags, scene);
  const auto run = flags.from_checkpoint ? run_from(*flags.from_checkpoint, scene) : scene.run();
  if (scene.show_divergence) run->show_divergence();
  std::erase_if(times, [&](sim::Rational t) { return !flags.at && t < run->now(); });
  if (!times.empty() && times.front() < run->now())
    throw UsageError(fmt::format("{}: is of t = {:g} s, after {:g} s", *flags.from_checkpoint,
                                 sim::value(run->now()), sim::value(times.front())));
  run->heed(interrupted);
  if (flags.events) return list_events(flags, scene, *run, flags.at ? times.back() : scene.duration);
  const bool as_json = form(flags) == "json";
  Sink sink(flags.out);
  const auto put = [&](const std::string& text) { sink.put(text); };
  // rows that run over the terminal are progress enough
  std::optional<Hushed> rows;
  if (isatty(STDOUT_FILENO) == 1 && !flags.out) rows.emplace();
  const std::vector<Column> all = columns(run->scene_info(), scene.axes);
  if (as_json) {
    put(
        fmt::format("{{\"version\": \"{}\", \"scene\": {}, \"scene_hash\": \"{}\", \"dimension\": {},\n"
                    " \"units\": {{\"length\": \"m\", \"time\": \"s\", \"angle\": \"rad\", \"energy\": "
                    "\"J\", \"force\": \"N\", \"impulse\": \"N s\"}},\n"
                    " \"solver\": {},\n \"states\": [\n",
                    OBSCURA_VERSION, quoted(scene.file), hash(scene.text), run->scene_info().dimension,
                    std::visit([](const auto& world) { return solver_name(world.model); }, scene.world)));
  } else {
    put(csv_header(all));
  }
  std::optional<sim::Trouble> trouble;
  bool first = true;
  for (const sim::Rational t : times) {
    if (interrupted()) return kInterrupted;
    doing("simulating", sim::value(run->now()), sim::value(times.back()), "s");
    auto outcome = run->at(t);
    if (const auto* bad = std::get_if<sim::Trouble>(&outcome)) {
      trouble = *bad;
      break;
    }
    if (std::holds_alternative<sim::Stopped>(outcome)) return kInterrupted;
    auto& now = std::get<sim::Snapshot>(outcome);
    if (const auto divergence = run->divergence(); divergence && divergence->ended) {
      say(stderr, "{}: {}; its states end there\n", scene.file, app::text(divergence->trouble));
      break;
    }
    const std::string state = state_hash(run->words());
    if (as_json) {
      // turned as it was typed, not as its principal axes lie
      for (std::size_t i = 0; i < now.bodies.size(); ++i)
        now.bodies[i].orientation = now.bodies[i].orientation * scene.axes[i].conjugate();
      put((first ? "" : ",\n") + json(now, run->scene_info(), state));
    } else {
      put(csv_row(now, state, all));
    }
    first = false;
  }
  if (as_json) put("\n ]}\n");
  tell_limits(scene, limit_notes(*run));
  if (trouble) {
    std::fflush(stdout);
    throw TroubleError(scene.file, *trouble, "");
  }
  sink.finish();
  return kDone;
}

}  // namespace

OBSCURA_COMMAND(60, states) {
  const Command command(program, exit, "states",
                        "Print the state at given instants as data, without drawing");
  auto flags = std::make_shared<StatesFlags>();
  add_scene(command, flags->scene);
  command
      .option("--at", flags->at,
              "Instants (s), as in 0,0.5,2 or 0:10:0.5, or marks of the run, as in hit,hit[2]")
      .type("LIST");
  command.option("--every", flags->every, "Instants from 0 to the duration, this far apart (s) [1]")
      .type("SECONDS");
  command
      .option("--from-checkpoint", flags->from_checkpoint,
              "Start from the state in this file (render --checkpoint-every)")
      .type("FILE");
  command
      .option("-o,--output", flags->out, "The output: a name that ends with .json or .csv [standard output]")
      .type("OUT");
  command.flag("--events", flags->events,
               "List what conditions ([[when]]) have fired, up to the last instant of --at or the duration");
  command
      .option(
          "--measure", flags->measure,
          "Print only these numbers of the run, as sweep measures them: ball.position.x@2, energy.total@max, "
          "ball.speed@hit")
      .type("LIST");
  command.option("--format", flags->format, "json or csv [by OUT's ending, json]").one_of({"json", "csv"});
  command
      .option("-j,--jobs", flags->jobs,
              "Threads that share the steps of some hundred bodies or more; the bits are the same [1]")
      .range(1, 256);
  add_sets(command, flags->sets);
  add_memory_limit(command);
  command.footer(
      "SI units; angles in radians, counter-clockwise; in space an orientation is a unit quaternion x, y, z, "
      "w, and a spin a vector in the axes of the room. Numbers have 17 significant digits: they read back to "
      "the bit.\n"
      "A contact is between a body and a wall (floor, left, right, ceiling, then the scene's own: 0, 1, ...) "
      "or another body; the normal points to the body, and the force (N) and the impulse (N s) of the last "
      "step act on it. A joint's force acts on its first body; broken: it holds nothing, as it has broken, "
      "was "
      "let go or is not joined yet. at_rest: proved to stay.\n"
      "energy.displacement: what pushing bodies out of walls and each other has gained since the start; "
      "energy.impacts: what impacts of collision = \"handout\" have lost; energy.hand: in the springs of "
      "mice, "
      "beside the total.\n\n"
      "Examples:\n"
      "  obscura states scenes/room.toml --at 0,0.5,2\n"
      "  obscura states scenes/room.toml --every 0.1 -o room.csv\n"
      "  obscura states scenes/swing.toml --measure bob.speed@max,energy.total@end\n"
      "  obscura states scenes/room.toml --at 5 --set physics.rate=1200");
  command.run([flags] { return states(*flags); });
}

}  // namespace obscura::app
