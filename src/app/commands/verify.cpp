// obscura verify: makes a picture or a movie again from the origin that it carries, and says whether it is
// still true.

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/compare/comparison.h"
#include "app/compare/format.h"
#include "app/compare/github.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "app/film/film.h"
#include "app/film/film_page.h"
#include "app/film/pictures.h"
#include "app/run/diagnosis.h"
#include "app/run/frames.h"
#include "app/run/table.h"
#include "app/run/trouble.h"
#include "media/error.h"
#include "page/html.h"
#include "scene/document.h"
#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

struct VerifyFlags {
  std::vector<std::string> files;
  std::vector<std::shared_ptr<const Table>> runs;  // tables among the files
  std::optional<std::string> scene;
  std::string scene_text;  // of it
  bool states = false;
  Format format = Format::text;
  FilmOptions film;
};

// a folder that is gone when it is no longer needed
struct Workbench {
  fs::path folder = fs::temp_directory_path() / fmt::format("obscura-verify-{}", ::getpid());
  Workbench() { fs::create_directories(folder); }
  ~Workbench() {
    std::error_code none;
    fs::remove_all(folder, none);
  }
};

struct Verdict {
  bool good = true;
  std::string only;  // what of it alone is known to be true
  std::vector<std::string> lines;
  void no(std::string line) { good = false, lines.push_back(std::move(line)); }
};

gl::ContextOptions context_of(const Origin& origin, const VerifyFlags& flags) {
  gl::ContextOptions context = flags.film.context;
  context.native = origin.native;
  return context;
}

// name the cause of different pixels unless different states already name it
void judge_still(const media::Image& image, const Origin& origin, const Origin& now, const VerifyFlags& flags,
                 Verdict& verdict) {
  const bool told = !verdict.good;
  const scene::Scene scene = scene_of(now);
  const auto again = pictures(scene, shots_of(now, scene),
                              {.context = context_of(origin, flags), .transparent = origin.transparent});
  if (again.empty()) return;
  const Pictured& made = again.front();
  if (made.image.width != image.width || made.image.height != image.height)
    return verdict.no(fmt::format("pixels: it is {}x{}, and says {}x{}", image.width, image.height,
                                  made.image.width, made.image.height));
  const media::Difference d = media::difference(image, made.image);
  if (d.same()) return verdict.lines.push_back("pixels: the same");
  verdict.no("pixels: " + sentence(d));
  if (told) return;
  for (const std::string& line : cause(origin, made.origin).lines) verdict.lines.push_back("  " + line);
}

// what made other states of the same scene
std::string by_whom(const Origin& origin) {
  if (!origin.trajectory.empty()) return "it shows other numbers than the table has";
  if (origin.version != OBSCURA_VERSION)
    return fmt::format("it is by obscura {}, and this is {}", origin.version, OBSCURA_VERSION);
  return fmt::format("it is by obscura {}, as this is: another build made it, or it was changed since",
                     origin.version);
}

// the states that a file's origin tells of, and those that are there now
void judge_states(const Origin& origin, const Origin& now, Verdict& verdict) {
  const bool still = origin.frames == 0;
  const std::string first = fmt::format("state at t = {:g} s", sim::value(origin.shot->time));
  const std::string what =
      still || !origin.states ? first : fmt::format("states of {} frames", origin.states->frames());
  if (same_states(origin, now)) {
    verdict.lines.push_back(what + ": the same");
  } else {
    verdict.no(origin.state == now.state ? what + ": others"
                                         : fmt::format("{}: {}, and now {}", first, origin.state, now.state));
    if (origin.scene_text == now.scene_text) {
      if (const std::string line = first_difference(origin, now); !line.empty())
        verdict.lines.push_back("  " + line);
      verdict.lines.push_back("  " + by_whom(origin));
    } else {
      for (const std::string& line : cause(origin, now).lines) verdict.lines.push_back("  " + line);
    }
  }
  if (!still && !origin.states) verdict.only = first + ", the only state in its origin";
}

// makes the movie anew, at another place; `now` becomes its origin
bool film_again(const std::string& file, const VerifyFlags& flags, const std::string& again, Origin& now) {
  scene::Scene scene = scene_of(now);
  if (fs::path(file).extension() == ".gif") scene.film.codec.clear();
  FilmOptions options = flags.film;
  options.progress = ProgressKind::none;
  options.context = context_of(now, flags), options.transparent = now.transparent;
  if (film(scene, shots_of(now, scene), {Output::Form::movie, again}, options) != kDone) return false;
  if (const auto made = Frames(again).origin()) now.state = made->state, now.states = made->states;
  return true;
}

void judge_movie(const std::string& file, const std::string& again, Verdict& verdict) {
  const bool told = !verdict.good;
  const Comparison found = compare(file, again);
  if (found.same_bytes) return verdict.lines.push_back("movie: the same, byte by byte");
  if (found.same()) return verdict.lines.push_back("movie: the same pixels in all frames");
  verdict.no(found.differing.empty()
                 ? "movie: the same pixels, but not the same film"
                 : fmt::format("movie: {} of {} frames differ", found.differing.size(), found.compared));
  for (const std::string& line : found.plain) verdict.lines.push_back("  " + line);
  if (found.worst >= 0) {
    const auto& worst = found.differing[std::size_t(found.worst)];
    verdict.lines.push_back(fmt::format("  worst is {}: {}", worst.name, sentence(worst)));
  }
  if (found.cause && !told)
    for (const std::string& line : found.cause->lines) verdict.lines.push_back("  " + line);
}

// makes the page anew, at another place; `now` becomes its origin
bool page_again(const VerifyFlags& flags, const std::string& again, Origin& now) {
  const scene::Scene scene = scene_of(now);
  FilmOptions options = flags.film;
  options.progress = ProgressKind::none;
  if (film_page(scene, shots_of(now, scene), again, options) != kDone) return false;
  const auto made = origin_in({{"obscura", page::origin_in_html(file_bytes(again))}});
  now.state = made->state, now.states = made->states;
  return true;
}

// the table of the run that a file shows: the one of its name, or the only one
std::shared_ptr<const Table> run_of(const std::string& file, const Origin& origin, const VerifyFlags& flags) {
  for (const auto& run : flags.runs)
    if (fs::path(run->file).filename() == origin.trajectory || flags.runs.size() == 1) return run;
  throw media::Error(fmt::format(
      "{0}: shows {1}, another program's run, which cannot be simulated again: name its table too, "
      "as in `obscura verify {0} {1}`",
      file, origin.trajectory));
}

// A flag of render takes the place of what the scene says: where the file is as its scene said, it was not
// given, and what the scene says today counts.
template <typename T>
void take(T& now, const T& then, const T& today) {
  if (now == then) now = today;
}

bool reads_scene(const Origin& origin) {
  try {
    (void)scene::parse(origin.scene_text, origin.scene_file, origin.sets);
    return true;
  } catch (const scene::Error&) {
    return false;
  }
}

// what the same command would make of another scene: what no flag said is as that scene says
void take_film(const Origin& origin, Origin& now) {
  const auto said = [](const Origin& by) {
    const scene::Scene scene = scene::parse(by.scene_text, by.scene_file, by.sets);
    Origin origin_said = origin_of(scene);
    origin_said.preset = scene.film.preset, origin_said.crf = scene.film.crf;
    return std::pair(origin_said, scene.film.codec);
  };
  const auto [then, codec_then] = said(origin);
  const auto [today, codec_today] = said(now);
  if (now.width == then.width && now.height == then.height)
    now.width = today.width, now.height = today.height;
  take(now.fps, then.fps, today.fps), take(now.theme, then.theme, today.theme);
  take(now.camera, then.camera, today.camera);
  take(now.preset, then.preset, today.preset), take(now.crf, then.crf, today.crf);
  if (codec_then != codec_today) now.encoder = codec_today;
  if (origin.frames == 0) return;
  // all frames that there were are all that there are
  const auto all = [](Origin of) {
    of.shots.clear();
    return shots_of(of, scene_of(of)).text();
  };
  if (origin.shots == all(origin)) now.shots = all(now);
}

// The origin of what is made again. None where the scene of today is another film, which is told.
std::optional<Origin> made_again(const Origin& origin, const std::string& file, const VerifyFlags& flags,
                                 Verdict& verdict) {
  Origin now = origin;
  if (!origin.trajectory.empty()) now.run = run_of(file, origin, flags);
  if (!flags.scene) return now;
  if (!origin.sets.empty())
    verdict.lines.push_back(fmt::format("of the scene with {}, as it was made", origin.set_flags()));
  now.scene_text = flags.scene_text;
  now.scene_hash = hash(now.scene_text);
  // an old scene that is not read any more does not tell which were flags
  if (!reads_scene(origin)) return now;
  take_film(origin, now);
  const auto otherwise = filmed_otherwise(origin, now, !flags.states);
  if (otherwise.empty()) return now;
  for (const std::string& line : otherwise) verdict.no(line);
  if (const std::string line = other_scene(origin, now); !line.empty()) verdict.lines.push_back("  " + line);
  return {};
}

// only that program can compute them again
void refuse_programs(const std::string& file, const Origin& origin) {
  if (origin.programs.empty()) return;
  throw media::Error(
      fmt::format("{}: cannot be verified: the force '{}' was computed by a program, which is not in "
                  "the file",
                  file, origin.programs.front()));
}

Verdict judge_page(const std::string& file, const VerifyFlags& flags) {
  const std::string bytes = file_bytes(file);
  const auto origin = origin_in({{"obscura", page::origin_in_html(bytes)}});
  if (!origin) throw media::Error(file + ": has no origin from obscura: nothing to verify");
  refuse_programs(file, *origin);
  Verdict verdict;
  if (hash(origin->scene_text) != origin->scene_hash) verdict.no("scene: its text does not match its hash");
  std::optional<Origin> now = made_again(*origin, file, flags, verdict);
  if (!now) return verdict;
  if (flags.states) {
    const auto again = simulated(*now);
    if (again) judge_states(*origin, *again, verdict);
    return verdict;
  }
  const Workbench bench;
  const std::string again = (bench.folder / fs::path(file).filename()).string();
  if (!page_again(flags, again, *now)) return verdict;
  judge_states(*origin, *now, verdict);
  verdict.only.clear();
  if (file_bytes(again) == bytes)
    verdict.lines.push_back("page: the same, byte by byte");
  else
    verdict.no("page: others are the keys, the words or the player that it carries");
  return verdict;
}

Verdict judge(const std::string& file, const VerifyFlags& flags) {
  if (fs::path(file).extension() == ".html") return judge_page(file, flags);
  Frames frames(file);
  if (frames.kind() == Frames::Kind::folder)
    throw media::Error(file + ": is a folder; name its pictures, as in frames/*.png");
  media::Image image;
  if (!frames.next(image)) throw media::Error(file + ": has no picture in it");
  if (!frames.origin()) throw media::Error(file + ": has no origin from obscura: nothing to verify");
  const Origin& origin = *frames.origin();
  refuse_programs(file, origin);
  Verdict verdict;
  if (hash(origin.scene_text) != origin.scene_hash) verdict.no("scene: its text does not match its hash");
  std::optional<Origin> now = made_again(origin, file, flags, verdict);
  if (!now) return verdict;
  if (flags.states || frames.kind() == Frames::Kind::still) {
    const auto again = simulated(*now);
    if (interrupted()) return verdict;
    if (!again) {
      verdict.no(fmt::format("state at t = {:g} s: the run ends before it", sim::value(origin.shot->time)));
      return verdict;
    }
    judge_states(origin, *again, verdict);
    if (!flags.states) judge_still(image, origin, *now, flags, verdict);
    return verdict;
  }
  const Workbench bench;
  const std::string again = (bench.folder / fs::path(file).filename()).string();
  if (!film_again(file, flags, again, *now)) return verdict;
  judge_states(origin, *now, verdict);
  verdict.only.clear();
  judge_movie(file, again, verdict);
  return verdict;
}

// the results of each file, in the order of the command line
struct Findings {
  struct Of {
    std::string file, text;
    Verdict verdict;
  };
  std::vector<Of> all;

  std::string json(int exit) const {
    auto top = json_head("verify", exit);
    top["files"] = nlohmann::ordered_json::array();
    for (const Of& each : all)
      top["files"].push_back(
          {{"file", each.file}, {"good", each.verdict.good}, {"lines", each.verdict.lines}});
    return text_of(top);
  }

  // an annotation for each that is not true any more, and all in the summary
  void tell_github() const {
    std::string wrong;
    std::size_t number = 0;
    for (const Of& each : all) {
      if (each.verdict.good) continue;
      ++number, wrong += each.text;
      fmt::print("{}", github::command({.file = each.file, .title = "verify", .message = each.text}));
    }
    github::add_to_summary(
        number == 0
            ? fmt::format("### Verified: {} still true\n\n", all.size())
            : fmt::format("### Verified: {} of {} no longer true, or not readable\n\n", number, all.size()) +
                  github::quoted(wrong));
  }
};

// The scene that all files are compared with: a fault in it is no verdict on a file.
std::string scene_text(const std::string& file) {
  std::error_code none;
  if (file != "-" && !fs::exists(file, none))
    throw media::Error(fmt::format("--scene {}: there is no such file", file));
  std::string text = scene::contents(file);
  (void)scene::parse(text, file, {});
  return text;
}

int verify(VerifyFlags flags) {
  if (flags.scene) flags.scene_text = scene_text(*flags.scene);
  const auto is_run = [](const std::string& file) {
    const fs::path ending = fs::path(file).extension();
    return ending == ".csv" || ending == ".json";
  };
  for (const std::string& file : flags.files)
    if (is_run(file)) flags.runs.push_back(std::make_shared<Table>(read_table(file)));
  std::erase_if(flags.files, is_run);
  if (flags.files.empty())
    throw UsageError("a table is no picture or movie: name those that show its run too");
  int exit = kDone;
  Findings findings;
  for (const std::string& file : flags.files) {
    Verdict verdict;
    try {
      verdict = judge(file, flags);
    } catch (const scene::Error& error) {
      verdict.no(fmt::format("this obscura does not read its scene: {}", error.what()));
    } catch (const TroubleError& error) {
      verdict.no(error.what());
    } catch (const UsageError& error) {
      // frames or a camera that the scene no longer has
      verdict.no(error.what());
    } catch (const media::Error& error) {
      // no verdict on this file; the others have theirs
      std::fflush(stdout);
      fmt::print(stderr, "obscura: {}\n", error.what());
      exit = kFiles;
      verdict.no(error.what());
      findings.all.push_back({file, fmt::format("cannot be verified: {}\n", error.what()), verdict});
      continue;
    }
    if (interrupted()) return kInterrupted;
    std::string text = fmt::format("{}: {}{}\n", file, verdict.good ? "still true" : "no longer true",
                                   verdict.good && !verdict.only.empty() ? " of its " + verdict.only : "");
    for (const std::string& line : verdict.lines) text += "  " + line + "\n";
    clear_waiting();
    if (flags.format != Format::json)
      say_lines(stdout, flags.format == Format::github ? github::verbatim(text) : text);
    if (!verdict.good && exit == kDone) exit = kDiffers;
    findings.all.push_back({file, text, std::move(verdict)});
  }
  if (flags.format == Format::json) fmt::print("{}", findings.json(exit));
  if (flags.format == Format::github) findings.tell_github();
  return exit;
}

}  // namespace

OBSCURA_COMMAND(110, verify) {
  const Command command(program, exit, "verify",
                        "Make pictures and movies again from their origin, and check that they are the same");
  auto flags = std::make_shared<VerifyFlags>();
  command
      .option("FILE", flags->files,
              "PNGs, movies and pages (.html) that obscura wrote; and, if they show another program's run, "
              "its table (.csv)")
      .required();
  command
      .option("--scene", flags->scene,
              "Compare with this scene as it is now, with the flags and --set of then")
      .type("SCENE");
  command.flag("--states", flags->states, "Only simulate, and draw nothing");
  add_format(command, flags->format);
  command.option("-j,--jobs", flags->film.workers, "Workers for a movie [one per core]").range(1, 256);
  add_backend(command, flags->film.context.backend);
  command.footer(
      "Every PNG and movie that obscura writes carries its origin: the scene's text, the keys set, the "
      "instant, the hash of the state, what drew it. verify simulates the scene again, compares the states "
      "of all frames, draws it again and compares pixels; for a movie it compares bytes, and if they differ "
      "all frames.\n\n"
      "Exit codes: 0 all are the same, 1 one differs, 4 one cannot be read or has no origin, or SCENE is "
      "missing; the others are verified anyway.\n\n"
      "Examples:\n"
      "  obscura verify room.png\n"
      "  obscura verify docs/*.png --states\n"
      "  obscura verify room.mp4 --scene scenes/room.toml\n"
      "  obscura verify student.mp4 student.csv");
  command.run([flags] { return verify(*flags); });
}

}  // namespace obscura::app
