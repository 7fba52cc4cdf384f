// obscura sweep: many runs that differ in the values of keys, and what is measured of each, as a table.

#include "app/study/sweep.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/progress.h"
#include "app/console/say.h"
#include "app/film/film.h"
#include "app/film/film_page.h"
#include "app/film/ordered_pipeline.h"
#include "app/run/compared.h"
#include "app/run/measures.h"
#include "app/run/run_marks.h"
#include "app/run/shard.h"
#include "app/run/shots.h"
#include "app/run/trouble.h"
#include "app/run/variation.h"
#include "app/study/mosaic.h"
#include "app/study/rows.h"
#include "media/error.h"
#include "scene/error.h"
#include "scene/scene.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kMostTiles = 144;

struct SweepFlags {
  std::string scene;
  std::vector<std::string> sets, vary, measure;
  std::optional<std::string> out, format, shard, at;
  bool resume = false, anew = false;
  int workers = 0;
  ProgressKind progress = ProgressKind::automatic;
  gl::ContextOptions context;  // of pictures
};

// the line of a run in the table, and the exit code of the run
struct RunResult {
  std::string line;
  int exit = kDone;
};

RowForm form(const SweepFlags& flags) {
  const std::string ending =
      flags.out ? std::filesystem::path(*flags.out).extension().string() : std::string(".csv");
  const auto named = [](const std::string& name) { return name == "csv" ? RowForm::csv : RowForm::jsonl; };
  if (flags.format) return named(*flags.format);
  if (ending == ".csv" || ending == ".jsonl") return named(ending.substr(1));
  throw UsageError(fmt::format(
      "-o {}: expected a name that ends with .csv, .jsonl, .png, .html or as a movie, or --format",
      *flags.out));
}

/// The runs of a sweep: which there are, and the row of each.
class Sweep {
 public:
  /// Reads the scene; run 0 must be one, and have what is asked. Throws UsageError, scene::Error.
  explicit Sweep(const SweepFlags& flags)
      : file_(flags.scene), sets_(flags.sets), form_(form(flags)), variations_(flags.vary) {
    if (flags.measure.empty())
      throw UsageError(
          "--measure says what is measured in each run, as in --measure energy.total@5,crate.position.y@max");
    for (const std::string& list : flags.measure)
      for (Question& each : questions(list)) asked_.push_back(std::move(each));
    heads_.push_back("run");
    for (const Variation& key : variations_.keys) heads_.push_back(key.path);
    for (const Question& each : asked_) heads_.push_back(each.text);
    heads_.push_back("trouble");
    for (auto head = heads_.begin(); head != heads_.end(); ++head)
      if (std::find(heads_.begin(), head, *head) != head)
        throw UsageError(fmt::format("'{}' would head two columns", *head));
    const scene::Scene first =
        varied_by_flag(variations_, 0, sets_,
                       [&](const std::vector<std::string>& with) { return scene::read(file_, with); });
    check(asked_, first);
    if (flags.out) spare(*flags.out, file_);
    warn_of_steps(first);
    text_ = first.text;
  }

  std::int64_t size() const { return variations_.size; }
  std::string head() const { return app::head(form_, heads_); }

  /// The row of run `run`, from 0. Throws Interrupted; UsageError if the run does not have what is measured.
  RunResult row(std::int64_t run) const {
    Answers found;
    found.values.resize(asked_.size());
    std::string trouble;
    RunResult made;
    try {
      found = answers(varied_by_flag(variations_, run, sets_,
                                     [&](const std::vector<std::string>& with) {
                                       return scene::parse(text_, file_, with);
                                     }),
                      asked_);
      for (const std::string& note : found.limit_notes)
        say(stderr, "{}: note: run {}: {}\n", file_, run + 1, note);
      if (found.trouble) trouble = app::text(*found.trouble), made.exit = kDiverged;
    } catch (const scene::Error& error) {
      trouble = error.complaints.front().text(), made.exit = kScene;
    } catch (const UsageError& error) {
      trouble = error.what(), made.exit = kUsage;
    }
    std::vector<std::string> cells{fmt::format("{}", run + 1)};
    for (std::string& value : variations_[run]) cells.push_back(std::move(value));
    for (std::string& value : found.values) cells.push_back(std::move(value));
    cells.push_back(std::move(trouble));
    made.line = app::row(form_, heads_, cells);
    return made;
  }

 private:
  std::string file_, text_;
  std::vector<std::string> sets_;
  RowForm form_;
  Variations variations_;
  std::vector<Question> asked_;
  std::vector<std::string> heads_;
};

// finds where to continue: how many of the runs from `from` on have their rows; makes the last of them again,
// to check that it is this sweep's
std::int64_t earlier(const Sweep& sweep, const RowFile& file, std::int64_t from, const std::string& head) {
  const RowFile::Earlier& left = file.earlier();
  if (left.lines == 0) return 0;
  const std::int64_t heads = head.empty() ? 0 : 1, rows = left.lines - heads;
  const auto refuse = [&](const std::string& why) {
    throw media::Error(fmt::format("{}: {}; --anew instead of --resume discards it", file.name(), why));
  };
  if (heads && left.first + "\n" != head) refuse("it has other columns");
  if (rows > 0 && sweep.row(from + rows - 1).line != left.last + "\n")
    refuse(fmt::format("its row {} is of another scene or sweep", rows));
  return rows;
}

// all runs in one picture, or one movie
int pictures(const SweepFlags& flags, bool still) {
  if (!flags.measure.empty() || flags.shard || flags.resume || flags.anew || flags.format)
    throw UsageError(
        fmt::format("-o {}: --measure, --shard, --resume, --anew and --format are for tables", *flags.out));
  if (still != flags.at.has_value())
    throw UsageError(still ? fmt::format("-o {}: --at gives the instant (s)", *flags.out)
                           : fmt::format("-o {}: --at is for a picture, which ends in .png", *flags.out));
  const auto at = sim::parse_rational(flags.at.value_or("0"));
  if (!at || *at < sim::Rational{0, 1} || kLongest < *at)
    throw UsageError(fmt::format("--at {}: expected seconds from 0 to 1e6", *flags.at));
  const Variations variations(flags.vary);
  if (variations.size > kMostTiles)
    throw UsageError(fmt::format("-o {}: {} runs are more than {}, the most a picture has", *flags.out,
                                 variations.size, kMostTiles));
  std::vector<Tile> tiles;
  std::string text;
  for (std::int64_t run = 0; run < variations.size; ++run) {
    const auto read = [&](const std::vector<std::string>& with) {
      return run == 0 ? scene::read(flags.scene, with) : scene::parse(text, flags.scene, with);
    };
    tiles.push_back(
        {with_run_marks(varied_by_flag(variations, run, flags.sets, read)), variations.words(run)});
    text = tiles.back().scene.text;
  }
  const MosaicOptions options{flags.workers, flags.progress, flags.context};
  return still ? mosaic_still(std::move(tiles), *at, *flags.out, options)
               : mosaic_movie(std::move(tiles), *flags.out, options);
}

// all runs on one page that plays, as film.vary has them
int page(const SweepFlags& flags) {
  if (!flags.measure.empty() || flags.shard || flags.resume || flags.anew || flags.format || flags.at)
    throw UsageError(fmt::format(
        "-o {}: --measure, --at, --shard, --resume, --anew and --format are for tables and pictures",
        *flags.out));
  // what is wrong with a value is told as of --vary
  const Variations variations(flags.vary);
  if (variations.size > kMostCompared)
    throw UsageError(fmt::format("-o {}: {} runs are more than {}, the most a page has", *flags.out,
                                 variations.size, kMostCompared));
  std::string text;
  for (std::int64_t run = 0; run < variations.size; ++run)
    text = varied_by_flag(variations, run, flags.sets, [&](const std::vector<std::string>& with) {
             return run == 0 ? scene::read(flags.scene, with) : scene::parse(text, flags.scene, with);
           }).text;
  std::string vary;
  for (const std::string& each : flags.vary) vary += (vary.empty() ? "" : ";") + each;
  std::vector<std::string> sets = flags.sets;
  sets.push_back("film.vary=\"" + vary + "\"");
  const scene::Scene scene = with_run_marks(scene::parse(text, flags.scene, sets));
  FilmOptions options;
  options.progress = flags.progress, options.context = flags.context;
  return film_page(scene, Shots::film(scene.duration, scene.film.fps, scene.film.speed), *flags.out, options);
}

bool ends_in(const std::string& name, std::initializer_list<std::string_view> endings) {
  return std::find(endings.begin(), endings.end(), std::filesystem::path(name).extension().string()) !=
         endings.end();
}

int sweep(SweepFlags flags) {
  if (flags.out == "-") flags.out.reset();
  if (flags.out && ends_in(*flags.out, {".png"})) return pictures(flags, true);
  if (flags.out && ends_in(*flags.out, {".mp4", ".mkv", ".mov", ".webm", ".gif"}))
    return pictures(flags, false);
  if (flags.out && ends_in(*flags.out, {".html"})) return page(flags);
  if (flags.at)
    throw UsageError(
        "--at is for a picture: -o with a name that ends in .png; for a table use --measure NAME@SECONDS");
  const Sweep all(flags);

  // the share of a shard; the first one's table has the heads, so that all of them in order are one table
  const Shard shard = flags.shard ? parse_shard(*flags.shard) : Shard{};
  std::int64_t from = shard.begin(all.size());
  const std::int64_t begin = from, end = shard.end(all.size());
  const std::string head = shard.number == 1 ? all.head() : "";
  if (flags.resume && !flags.out) throw UsageError("--resume needs -o: a stream cannot be continued");
  if (flags.resume && flags.anew) throw UsageError("--resume and --anew exclude each other");
  RowFile file(flags.out, flags.resume ? RowFile::Begin::go_on
                          : flags.anew ? RowFile::Begin::anew
                                       : RowFile::Begin::fresh);
  from += earlier(all, file, from, head);
  if (file.earlier().lines == 0 && !head.empty()) file.add(head);

  // rows that run over the terminal are progress enough
  const ProgressKind kind =
      !flags.out && flags.progress == ProgressKind::automatic ? ProgressKind::none : flags.progress;
  Progress progress(kind, flags.out.value_or("sweep"), end - begin, 0, "runs");
  std::optional<Hushed> rows;
  if (!flags.out && isatty(STDOUT_FILENO) == 1) rows.emplace();
  std::int64_t next = from, done = from;
  std::int64_t diverged = 0, refused = 0;
  Conduct<std::int64_t, RunResult> parts;
  parts.produce = [&]() -> std::optional<std::int64_t> {
    if (next == end || interrupted()) return {};
    return next++;
  };
  parts.hire = [&] { return [&](std::int64_t run) { return all.row(run); }; };
  parts.consume = [&](const RunResult& row) {
    file.add(row.line);
    diverged += row.exit == kDiverged, refused += row.exit == kScene || row.exit == kUsage;
    ++done;
    return true;
  };
  parts.wait = [&] { progress.at(done - begin); };
  const int cores = flags.workers > 0 ? flags.workers : std::max(1, int(std::thread::hardware_concurrency()));
  try {
    conduct(parts, int(std::min<std::int64_t>(cores, std::max<std::int64_t>(1, end - from))));
  } catch (const Interrupted&) {
  }
  if (done < end) {
    progress.finish(done - begin,
                    fmt::format("interrupted: {} of {} runs are in {}{}", done - begin, end - begin,
                                file.name(), flags.out ? "; --resume continues" : ""),
                    false);
    return kInterrupted;
  }
  file.finish();
  std::string summary =
      fmt::format("{}: {} run{}", flags.out.value_or("sweep"), end - begin, end - begin == 1 ? "" : "s");
  if (diverged > 0) summary += fmt::format(", {} diverged", diverged);
  if (refused > 0) summary += fmt::format(", {} of scenes that cannot be", refused);
  progress.finish(done - begin, summary + fmt::format(", made in {:.1f} s", progress.seconds()),
                  flags.out.has_value());
  return diverged > 0 ? kDiverged : refused > 0 ? kScene : kDone;
}

}  // namespace

void check_sweep(const std::string& scene, const std::vector<std::string>& sets,
                 const std::vector<std::string>& vary, const std::vector<std::string>& measure,
                 const std::string& out) {
  SweepFlags flags;
  flags.scene = scene, flags.sets = sets, flags.vary = vary, flags.measure = measure, flags.out = out;
  const Sweep sweep(flags);
}

OBSCURA_COMMAND(70, sweep) {
  const Command command(program, exit, "sweep",
                        "Run a scene many times and write measured values as a table, without drawing");
  auto flags = std::make_shared<SweepFlags>();
  add_scene(command, flags->scene);
  command
      .option("--vary", flags->vary,
              "A key and its values, as in crate.elasticity=0,0.5,1 or 0:1:0.1, seed=1:100 (both ends); "
              "several --vary run all combinations, the last key fastest")
      .type("PATH=VALUES")
      .repeated();
  command
      .option("--measure", flags->measure,
              "Columns of the states, each at an instant (s) or over the run, as in energy.total@5, "
              "crate.position.y@max; also @min @mean @end @argmax @argmin; may be repeated")
      .type("LIST")
      .repeated();
  add_sets(command, flags->sets);
  command
      .option("-o,--output", flags->out,
              "The output: .csv or .jsonl is a table; .png with --at, .mp4 .mkv .mov .webm .gif or a page, "
              ".html, shows all runs side by side [standard output]")
      .type("OUT");
  command.option("--at", flags->at, "The instant (s) of a picture of all runs").type("SECONDS");
  command.option("--format", flags->format, "csv or jsonl [by OUT's ending, csv]").one_of({"csv", "jsonl"});
  command.option("-j,--jobs", flags->workers, "Runs in parallel [one per core]").range(1, 1024);
  command
      .option("--shard", flags->shard,
              "Make only shard i of N; the tables of all shards, one after another, are the whole table")
      .type("i/N");
  command.flag("--resume", flags->resume, "Continue an interrupted sweep");
  command.flag("--anew", flags->anew, "Start again and discard what an interrupted sweep left");
  add_backend(command, flags->context.backend);
  add_progress(command, flags->progress);
  command.footer(
      "Each row has the run's number, the values of its keys, the measured values, and the trouble if there "
      "was any; a run that diverges does not end the sweep. The rows are in order and the same bytes for "
      "every -j.\n"
      "Measures over the run use the ends of its steps, from 0 to the duration; @mean is over time.\n\n"
      "Examples:\n"
      "  obscura sweep scenes/room.toml --vary tumbler.elasticity=0:1:0.1 --measure energy.total@5\n"
      "  obscura sweep scenes/room.toml --vary tumbler.elasticity=0:1:0.1 --vary seed=1:100 \\\n"
      "      --measure 'energy.total@5, tumbler.position.y@max' -o room.csv\n"
      "  obscura sweep scenes/room.toml --vary seed=1:100 --measure hash@end --shard 2/4 -o 2.csv\n"
      "  obscura sweep scenes/room.toml --vary tumbler.elasticity=0:1:0.1 --at 5 -o room.png\n\n"
      "Exit codes: 0 done, 2 usage, 3 scene, 4 files, 6 some runs diverged (their rows say which), 130 "
      "interrupted.");
  command.run([flags] { return sweep(*flags); });
}

}  // namespace obscura::app
