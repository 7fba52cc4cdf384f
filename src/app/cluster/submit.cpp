// obscura submit: a film, or a sweep, shared out among the tasks of a Slurm array. There is no scheduler of
// our own: plain scripts are written, handed to sbatch, and followed.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cluster/slurm.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/scripts.h"
#include "app/film/film.h"
#include "app/film/output.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/shots.h"
#include "app/study/sweep.h"
#include "media/error.h"
#include "media/file.h"
#include "media/movie.h"
#include "scene/scene.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

struct Flags {
  std::string scene;
  std::vector<std::string> sets, vary, measure, options;
  std::optional<std::string> out;
  std::string memory_limit;
  gl::ContextOptions context;
  int tasks = 0, at_once = 0;
  bool dry_run = false, no_wait = false, anew = false;
  ProgressKind progress = ProgressKind::automatic;
};

/// The files of an errand: the state that one submit leaves to the next.
class Folder {
 public:
  explicit Folder(const Errand& errand) : path_(errand.folder) {}

  std::string file(const std::string& name) const { return path_ + "/" + name; }
  std::string read(const std::string& name) const {
    std::ifstream in(file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& name, const std::string& text) const {
    media::File out(file(name));
    out.write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    out.place(false);
  }
  void forget(const std::string& name) const {
    std::error_code none;
    fs::remove(file(name), none);
  }
  /// The exit code that a step left; none where it has not come to its end.
  std::optional<int> exit(const std::string& step) const {
    std::ifstream in(file(step + ".exit"));
    int code = 0;
    if (in >> code) return code;
    return {};
  }
  std::string last_line(const std::string& log) const {
    std::string text = read(log);
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text.substr(text.rfind('\n') + 1);
  }

 private:
  std::string path_;
};

std::string shard_name(int shard) { return fmt::format("shard-{}", shard); }

/// Jobs that were handed in, by step: "prepare", "shards", "join"; none of a step that had nothing to do.
using Jobs = std::map<std::string, std::string>;

std::string words(const std::vector<std::string>& all) {
  std::string line;
  for (const std::string& word : all) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

// Options of sbatch on which the scripts and their submission rely, and which users must not change: the
// place and order of jobs, arrays, the places of logs and exit codes, the delivery of SIGTERM.
struct Needed {
  std::string_view name;
  char letter;  // 0: none
};
constexpr Needed kNeeded[] = {
    {"array", 'a'},    {"chdir", 'D'},   {"dependency", 'd'}, {"error", 'e'},  {"kill-on-invalid-dep", 0},
    {"no-requeue", 0}, {"open-mode", 0}, {"output", 'o'},     {"parsable", 0}, {"signal", 0},
    {"test-only", 0},  {"wait", 'W'},    {"wrap", 0}};

// letters of sbatch's that take no value: others may stand behind them
constexpr std::string_view kFlags = "HOQksv";

[[noreturn]] void refuse_needed(const std::string& option, std::string_view name) {
  throw UsageError(fmt::format("-- {}: --{} cannot be given: submit sets it itself{}", option, name,
                               name == "array" ? "; --tasks and --at-once say how many" : ""));
}

// sbatch takes the beginning of a name for it: --dep
void refuse_needed(const std::string& option) {
  if (option.starts_with("--")) {
    const std::string name = option.substr(2, option.find('=') - 2);
    for (const Needed& each : kNeeded)
      if (!name.empty() && each.name.starts_with(name)) refuse_needed(option, each.name);
    return;
  }
  for (std::size_t i = 1; i < option.size(); ++i) {
    for (const Needed& each : kNeeded)
      if (option[i] == each.letter) refuse_needed(option, each.name);
    if (kFlags.find(option[i]) == kFlags.npos) return;
  }
}

// "-p debug" is one option
std::vector<std::string> option_lines(const std::vector<std::string>& options) {
  std::vector<std::string> lines;
  for (const std::string& option : options) {
    if (option.starts_with('-')) {
      refuse_needed(option);
      lines.push_back(shell_word(option));
    } else if (lines.empty()) {
      throw UsageError(
          fmt::format("{}: options of sbatch stand behind --, as in -- --partition=long", option));
    } else {
      lines.back() += " " + shell_word(option);
    }
  }
  return lines;
}

/// The submitted work: its commands, and its progress.
struct Work {
  Errand errand;
  std::string made;   // the file, or the first of its frames, that is there when all is done
  std::string parts;  // the folder of what is not whole yet
  std::string plan;   // what must stay the same that an earlier submit is gone on with
  std::string unit = "frames";
  std::int64_t size = 0;
  double frame_seconds = 0;
  std::function<std::int64_t()> done;
};

std::int64_t count(const std::string& folder, const std::function<bool(const fs::path&)>& fits) {
  std::int64_t n = 0;
  std::error_code none;
  for (fs::directory_iterator file(folder, none), end; !none && file != end; file.increment(none))
    n += fits(file->path().filename());
  return n;
}

// the --memory-limit of every task
std::vector<std::string> limits(const Flags& flags) {
  if (flags.memory_limit.empty()) return {};
  return {"--memory-limit", flags.memory_limit};
}

// how the pictures are drawn, by flags of render
std::vector<std::string> drawing(const Flags& flags) {
  std::vector<std::string> all;
  if (flags.context.backend != gl::Backend::automatic)
    all = {"--backend", flags.context.backend == gl::Backend::egl ? "egl" : "osmesa"};
  if (flags.context.native) all.push_back("--native");
  return all;
}

void film_work(const Flags& flags, const scene::Scene& scene, const std::vector<std::string>& program,
               Work& work) {
  const Shots shots = Shots::film(scene.duration, scene.film.fps, scene.film.speed);
  const Output out = output(flags.out, scene.name, false, shots.size());
  if (out.form != Output::Form::movie && out.form != Output::Form::frames)
    throw UsageError(fmt::format("{}: submit makes a movie or a sequence of PNGs", out.path));
  const media::MovieSpec spec = movie_spec(scene);
  const bool movie = out.form == Output::Form::movie;
  if (movie) media::check(out.path, spec);

  work.made = movie ? out.path : out.file(shots[0].frame);
  work.parts = out.parts();
  work.size = shots.size(), work.frame_seconds = 1 / sim::value(scene.film.fps);
  if (movie) {
    const std::string ending = fs::path(out.path).extension().string();
    const auto take = [ending](const fs::path& name) {
      return name.extension() == ending && name.native()[0] != '.';
    };
    work.done = [=, folder = work.parts, size = work.size, each = media::segment_frames(spec)] {
      return std::min(size, each * count(folder, take));
    };
  } else {
    std::set<std::string> frames;
    for (std::int64_t i = 0; i < shots.size(); ++i)
      frames.insert(fs::path(out.file(shots[i].frame)).filename().string());
    work.done = [frames, folder = ("." / fs::path(out.path).parent_path()).string()] {
      return count(folder, [&](const fs::path& name) { return frames.contains(name.native()); });
    };
  }

  std::vector<std::string> render = program, join = program;
  for (const char* word : {"render", flags.scene.c_str(), "-o", out.path.c_str()}) render.push_back(word);
  for (const std::string& set : flags.sets) render.insert(render.end(), {"--set", set});
  for (const std::string& word : limits(flags)) render.push_back(word);
  for (const std::string& word : drawing(flags)) render.push_back(word);
  for (const char* word : {"join", out.path.c_str()}) join.push_back(word);
  for (const std::string& word : limits(flags)) join.push_back(word);
  Errand& errand = work.errand;
  errand.made = out.path;
  const std::string line = words(render) + " --progress none";
  errand.prepare = fmt::format("{} --prepare {}", line, errand.tasks);
  errand.shard = fmt::format("{} --shard \"$shard/{}\" -j \"$cores\"", line, errand.tasks);
  errand.join = words(join);
}

void sweep_work(const Flags& flags, const std::vector<std::string>& program, Work& work) {
  const std::string out = flags.out.value_or("");
  const std::string ending = fs::path(out).extension().string();
  if (ending != ".csv" && ending != ".jsonl")
    throw UsageError("submit makes a table of a sweep: -o with a name that ends with .csv or .jsonl");
  if (!drawing(flags).empty())
    throw UsageError("--backend and --native are for a film: a sweep's table draws nothing");
  check_sweep(flags.scene, flags.sets, flags.vary, flags.measure, out);
  work.made = out;
  work.parts = out + ".parts";
  work.unit = "shards", work.size = work.errand.tasks;
  std::vector<std::string> sweep = program;
  for (const char* word : {"sweep", flags.scene.c_str()}) sweep.push_back(word);
  for (const std::string& set : flags.sets) sweep.insert(sweep.end(), {"--set", set});
  for (const std::string& vary : flags.vary) sweep.insert(sweep.end(), {"--vary", vary});
  for (const std::string& measure : flags.measure) sweep.insert(sweep.end(), {"--measure", measure});
  for (const std::string& word : limits(flags)) sweep.push_back(word);
  Errand& errand = work.errand;
  errand.made = out;
  errand.shard = fmt::format(
      "{} --shard \"$shard/{}\" -j \"$cores\" --progress none --resume -o {}/\"$(printf %06d \"$shard\")\"{}",
      words(sweep), errand.tasks, shell_word(work.parts), ending);
  errand.good.push_back(kDiverged);  // a run that diverges says so in its row
  errand.join = fmt::format("{{ cat {0}/[0-9]*[0-9]{1} >{0}/all && mv {0}/all {2} && rm -r {0}; }}",
                            shell_word(work.parts), ending, shell_word(out));
}

Work work_of(const Flags& flags, int tasks) {
  if (flags.scene == "-") throw UsageError("each task reads the scene itself: name a file");
  // the scripts' comments and #SBATCH lines would end at such a character, and what follows be commands
  const auto refuse_controls = [](const std::string& text) {
    const auto control = [](unsigned char c) { return c < 0x20 || c == 0x7F; };
    if (std::any_of(text.begin(), text.end(), control))
      throw UsageError(fmt::format("{}: has a control character, which no script can carry", text));
  };
  for (const std::string& text : {flags.scene, flags.out.value_or(""), fs::current_path().string()})
    refuse_controls(text);
  for (const std::string& option : flags.options) refuse_controls(option);
  const scene::Scene scene = with_run_marks(scene::read(flags.scene, flags.sets));
  std::error_code none;
  const fs::path self = fs::read_symlink("/proc/self/exe", none);
  const std::vector<std::string> program{none ? "obscura" : self.string()};
  Work work;
  work.errand.tasks = tasks, work.errand.at_once = flags.at_once;
  work.errand.where = fs::current_path().string();
  work.errand.options = option_lines(flags.options);
  if (flags.vary.empty() && flags.measure.empty())
    film_work(flags, scene, program, work);
  else
    sweep_work(flags, program, work);
  work.errand.folder = work.parts.substr(0, work.parts.rfind(".parts")) + ".slurm";
  if (!work.done)
    work.done = [folder = Folder(work.errand), tasks] {
      std::int64_t n = 0;
      for (int i = 1; i <= tasks; ++i) n += folder.exit(shard_name(i)) == 0;
      return n;
    };
  work.plan = fmt::format("obscura {}\nscene {}\n", OBSCURA_VERSION, hash(scene.text));
  for (const std::string& line : {work.errand.prepare, work.errand.shard, work.errand.join})
    work.plan += line + "\n";
  return work;
}

std::string array(const Errand& errand, const std::vector<int>& shards) {
  return "--array=" + ranges(shards) + (errand.at_once > 0 ? fmt::format("%{}", errand.at_once) : "");
}

std::vector<int> missing(const Folder& folder, int tasks) {
  std::vector<int> shards;
  for (int i = 1; i <= tasks; ++i)
    if (folder.exit(shard_name(i)) != 0) shards.push_back(i);
  return shards;
}

void show(const Work& work) {
  const Errand& errand = work.errand;
  const std::string options =
      errand.options.empty() ? "" : fmt::format(" {}", fmt::join(errand.options, " "));
  std::vector<int> all(std::size_t(errand.tasks));
  for (int i = 0; i < errand.tasks; ++i) all[std::size_t(i)] = i + 1;
  std::string after;
  const auto step = [&](const std::string& name, const std::string& script, const std::string& flags) {
    say(stdout, "# {}/{}.sbatch\n", errand.folder, name);
    say_lines(stdout, script + "\n");
    return fmt::format("{}=$(sbatch --parsable{}{}{} {}/{}.sbatch)\n", name, flags, after, options,
                       shell_word(errand.folder), name);
  };
  std::string lines;
  if (!errand.prepare.empty()) {
    lines += step("prepare", prepare_script(errand), "");
    after = " --dependency=afterok:$prepare --kill-on-invalid-dep=yes";
  }
  lines += step("shards", shards_script(errand), " " + array(errand, all));
  after = " --dependency=afterok:$shards --kill-on-invalid-dep=yes";
  lines += step("join", join_script(errand), "");
  say_lines(stdout, "# and then\n" + lines);
}

std::vector<std::string> numbers(const Jobs& jobs) {
  std::vector<std::string> all;
  for (const auto& [name, job] : jobs) all.push_back(job);
  return all;
}

/// Hands in what is missing.
Jobs hand_in(const Work& work, const Folder& folder, const std::vector<std::string>& options) {
  const Errand& errand = work.errand;
  Jobs jobs;
  std::string after;
  const auto step = [&](const std::string& name, std::vector<std::string> flags) {
    if (!after.empty())
      flags.insert(flags.end(), {"--dependency=afterok:" + after, "--kill-on-invalid-dep=yes"});
    flags.insert(flags.end(), options.begin(), options.end());
    after = jobs[name] = slurm::submit(folder.file(name + ".sbatch"), flags);
  };
  try {
    if (!errand.prepare.empty() && folder.exit("prepare") != 0) {
      folder.forget("prepare.exit");
      step("prepare", {});
    }
    const std::vector<int> shards = missing(folder, errand.tasks);
    for (const int shard : shards) folder.forget(shard_name(shard) + ".exit");
    if (!shards.empty()) step("shards", {array(errand, shards)});
    folder.forget("join.exit");
    step("join", {});
    std::string text;
    for (const auto& [name, job] : jobs) text += name + " " + job + "\n";
    folder.write("jobs", text);
  } catch (...) {
    slurm::cancel(numbers(jobs));
    throw;
  }
  return jobs;
}

Jobs earlier_jobs(const Folder& folder) {
  Jobs jobs;
  std::ifstream in(folder.file("jobs"));
  for (std::string name, job; in >> name >> job;) jobs[name] = job;
  return jobs;
}

using States = std::map<std::string, slurm::State>;

bool any_lives(const States& states) {
  return std::any_of(states.begin(), states.end(),
                     [](const auto& each) { return slurm::lives(each.second); });
}

/// The steps that have failed: their names, and what Slurm says of them.
std::vector<std::pair<std::string, std::string>> failures(const Work& work, const Folder& folder,
                                                          const Jobs& jobs, const States& states) {
  std::vector<std::pair<std::string, std::string>> found;
  const auto look = [&](const std::string& step, const std::string& job) {
    if (folder.exit(step) == 0) return;
    const auto state = states.find(job);
    // a job that never began is not the cause
    const bool began = folder.exit(step) || fs::exists(folder.file(step + ".log"));
    if (began || (state != states.end() && !state->second.name.starts_with("CANCELLED")))
      found.emplace_back(step, state == states.end() ? "" : state->second.name);
  };
  if (const auto job = jobs.find("prepare"); job != jobs.end()) look("prepare", job->second);
  if (const auto job = jobs.find("shards"); job != jobs.end())
    for (int i = 1; i <= work.errand.tasks; ++i) look(shard_name(i), fmt::format("{}_{}", job->second, i));
  if (const auto job = jobs.find("join"); job != jobs.end()) look("join", job->second);
  return found;
}

/// The failure, in one line, and its exit code.
int report(const Work& work, const Folder& folder, const Jobs& jobs, const States& states) {
  const auto failed = failures(work, folder, jobs, states);
  if (failed.empty())
    throw media::Error(fmt::format(
        "{}: its jobs are gone and it is not whole; submit again to do what is missing", work.errand.made));
  const auto& [step, state] = failed.front();
  const auto code = folder.exit(step);
  std::string line = fmt::format("{}: {} failed", work.errand.made, step);
  if (step.starts_with("shard-")) line += fmt::format(", of {} shards", work.errand.tasks);
  if (!state.empty()) line += ", " + state;
  if (code) line += fmt::format(", exit {}", *code);
  const std::string log = step + ".log", said = folder.last_line(log);
  line += said.empty() ? fmt::format("; its log: {}", folder.file(log))
                       : fmt::format("; the last line of {}: {}", folder.file(log), said);
  if (failed.size() > 1) line += fmt::format("; {} more failed", failed.size() - 1);
  say(stderr, "obscura: {}; submit again to do what is missing\n", line);
  return code && *code >= kDiffers && *code <= kDiverged ? *code : kFiles;
}

/// Says of jobs that wait for a person, once of each.
void tell_held(const Work& work, const States& states, std::set<std::string>& told) {
  for (const auto& [job, state] : states)
    if (slurm::held(state) && told.insert(job).second)
      say(stderr, "obscura: {}: Slurm holds job {} ({}); scontrol release {} lets it go on\n",
          work.errand.made, job, state.reason, job);
}

int follow(const Work& work, const Folder& folder, const Jobs& jobs, ProgressKind kind) {
  constexpr auto kPause = std::chrono::milliseconds(200);
  constexpr int kAsk = 10;  // pauses from one question to Slurm to the next
  Progress progress(kind, work.errand.made, work.size, work.frame_seconds, work.unit);
  States states;
  std::set<std::string> told;
  for (bool lives = true; lives;) {
    if (interrupted()) {
      progress.finish(
          work.done(),
          fmt::format("interrupted: the jobs go on; submit again to follow them, scancel {} ends them",
                      fmt::join(numbers(jobs), " ")),
          false);
      return kInterrupted;
    }
    States now;
    if (slurm::states(numbers(jobs), now)) {
      for (const auto& [job, state] : now) states[job] = state;
      lives = any_lives(now);
      tell_held(work, now, told);
    }
    progress.at(work.done());
    for (int i = 0; lives && i < kAsk && !interrupted(); ++i) std::this_thread::sleep_for(kPause);
  }
  if (folder.exit("join") != 0) {
    progress.finish(work.done(), "", false);
    return report(work, folder, jobs, states);
  }
  progress.finish(work.size,
                  fmt::format("{}: {} {}, made by {} tasks in {:.0f} s", work.errand.made, work.size,
                              work.unit, work.errand.tasks, progress.seconds()),
                  true);
  return kDone;
}

int submit(Flags flags) {
  // report errors of the scene before asking Slurm
  Work work = work_of(flags, flags.tasks);
  if (!flags.dry_run) {
    if (const int most = slurm::last_task(); flags.tasks > most) {
      say(stderr, "obscura: --tasks {}: arrays have up to {} tasks here: {} are used\n", flags.tasks, most,
          most);
      work = work_of(flags, most);
    }
  }
  if (flags.dry_run) {
    show(work);
    return kDone;
  }

  // with the same plan as before, finished shards and edited scripts stay
  const Errand& errand = work.errand;
  const Folder folder(errand);
  media::make_folder_of(folder.file("plan"));
  const bool same = folder.read("plan") == work.plan;
  const Jobs before = earlier_jobs(folder);
  States states;
  const bool living = slurm::states(numbers(before), states) && any_lives(states);
  if (living && !same)
    throw media::Error(
        fmt::format("{}: jobs of an earlier submit, not of the same, still run: scancel {} ends them",
                    errand.made, fmt::join(numbers(before), " ")));
  if (living) return follow(work, folder, before, flags.progress);
  if (flags.anew) {
    fs::remove_all(work.parts);
  } else if (same && folder.exit("join") == 0 && fs::exists(work.made)) {
    say(stdout, "{}: is complete; without {} it would be made again\n", errand.made, folder.file("plan"));
    return kDone;
  }
  if (!same || !fs::exists(work.parts)) {
    for (const char* name : {"prepare.exit", "join.exit"}) folder.forget(name);
    std::error_code none;
    for (fs::directory_iterator file(errand.folder, none), end; !none && file != end; file.increment(none))
      if (file->path().filename().string().starts_with("shard-")) fs::remove(file->path(), none);
  }
  if (!same) {
    if (!errand.prepare.empty()) folder.write("prepare.sbatch", prepare_script(errand));
    folder.write("shards.sbatch", shards_script(errand));
    folder.write("join.sbatch", join_script(errand));
    folder.write("plan", work.plan);
  }
  const Jobs jobs = hand_in(work, folder, flags.options);
  if (flags.no_wait) {
    say(stdout, "{}: jobs {}; submit again to follow them\n", errand.made,
        fmt::format("{}", fmt::join(numbers(jobs), " ")));
    return kDone;
  }
  return follow(work, folder, jobs, flags.progress);
}

}  // namespace

OBSCURA_COMMAND(80, submit) {
  const Command command(program, exit, "submit", "Split a film or a sweep into the tasks of a Slurm array");
  auto flags = std::make_shared<Flags>();
  add_scene(command, flags->scene);
  command.option("SBATCH", flags->options, "After --: options of sbatch, as in -- --partition=long");
  command.option("--tasks", flags->tasks, "Number of shards; each is a task of the array")
      .type("N")
      .required()
      .range(1, 1'000'000);
  command.option("--at-once", flags->at_once, "At most this many tasks at a time")
      .type("K")
      .range(1, 1'000'000);
  command
      .option("-o,--output", flags->out,
              "The output, as for render: a movie or a sequence of PNGs [render_out/SCENE.mp4]; for a sweep "
              "a table")
      .type("OUT");
  command.option("--vary", flags->vary, "Makes it a sweep instead of a film: as for sweep")
      .type("PATH=VALUES")
      .repeated();
  command.option("--measure", flags->measure, "What a sweep measures: as for sweep").type("LIST").repeated();
  add_sets(command, flags->sets);
  command.flag("--anew", flags->anew,
               "Start again and discard what an earlier submit left, even finished shards");
  command.flag("--dry-run", flags->dry_run, "Only show the scripts; needs no Slurm");
  command.flag("--no-wait", flags->no_wait, "Submit and end");
  add_memory_limit(command, &flags->memory_limit);
  add_backend(command, flags->context.backend);
  command.flag("--native", flags->context.native, "As for render");
  add_progress(command, flags->progress);
  command.footer(
      "Writes plain sbatch scripts into the folder OUT.slurm, where the logs go too: one simulates and "
      "writes a checkpoint for every shard, an array draws the shards, one joins them. The bytes are those "
      "of one render.\n"
      "A second submit does only what is missing; while jobs of the first still run, it follows them.\n\n"
      "Examples:\n"
      "  obscura submit scenes/room.toml --tasks 32 -o room.mp4\n"
      "  obscura submit scenes/room.toml --tasks 100 --at-once 20 -o room.mp4 -- --partition=long "
      "--time=1:00:00\n"
      "  obscura submit scenes/room.toml --tasks 4 --dry-run\n"
      "  obscura submit scenes/room.toml --tasks 8 --vary seed=1:100 --measure hash@end -o room.csv\n\n"
      "Exit codes: 0 done, 2 usage, 3 scene, 4 files, Slurm or a task, 6 the simulation diverged, 130 "
      "interrupted (the jobs go on).");
  command.run([flags] { return submit(*flags); });
}

}  // namespace obscura::app
