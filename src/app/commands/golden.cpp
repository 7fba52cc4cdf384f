// obscura golden: draws what scenes' [golden] tables name, and holds it against references.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "app/compare/format.h"
#include "app/compare/github.h"
#include "app/compare/golden_case.h"
#include "app/compare/golden_output.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "app/film/ordered_pipeline.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "gl/context.h"
#include "media/error.h"
#include "scene/complaints.h"
#include "scene/error.h"

namespace obscura::app {

namespace {

namespace fs = std::filesystem;

struct GoldenFlags {
  std::vector<std::string> scenes, sets, only;
  Format format = Format::text;
  std::optional<std::string> junit, report;
  int workers = 0;
  GoldenOptions golden;
};

// the result of one scene
struct Outcome {
  std::string name;
  std::vector<GoldenCase> cases;
  double seconds = 0;
};

GoldenCase failed(const std::string& scene, const std::string& file, int exit, const std::string& why) {
  GoldenCase it;
  it.scene = scene, it.state = "failed", it.file = scene, it.exit = exit, it.scene_file = file;
  it.lines = lines(why);
  return it;
}

// the scenes of a folder are those with a [golden]; a scene that is named needs none
bool wanted(const std::string& file) {
  try {
    return scene::read(file).golden.given;
  } catch (const scene::Error&) {
    return true;  // the error is reported later
  }
}

std::vector<std::string> files(const GoldenFlags& flags) {
  std::vector<std::string> named = flags.scenes;
  if (named.empty()) named = {fs::is_directory("scenes") ? "scenes" : "."};
  std::vector<std::string> all;
  for (const std::string& each : named) {
    if (!fs::is_directory(each)) {
      all.push_back(each);
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(each))
      if (entry.path().extension() == ".toml" && wanted(entry.path().string()))
        found.push_back(entry.path().string());
    if (found.empty()) throw UsageError(each + ": no scene in it has a [golden] table");
    std::sort(found.begin(), found.end());
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

// each scene has its own references and its own pictures of what fails, and the two do not meet
void know_apart(const std::vector<std::string>& all, const GoldenOptions& options) {
  const auto full = [](const std::string& path) { return fs::weakly_canonical(path); };
  std::map<std::string, std::string> names;
  std::set<fs::path> references;
  for (const std::string& file : all) {
    const std::string name = golden_name(file, options);
    references.insert(full(references_of(file, options)));
    const auto [other, fresh] = names.emplace(name, file);
    if (fresh) continue;
    if (full(file) == full(other->second)) throw UsageError(file + ": is named twice");
    const bool folders = full(file).parent_path() != full(other->second).parent_path();
    throw UsageError(
        fmt::format("{} and {} are both called {}: {}", other->second, file, name,
                    folders ? "name a folder that holds both with --root" : "rename one of them"));
  }
  for (const std::string& file : all) {
    if (references.contains(full(actual_of(file, options))))
      throw UsageError(
          fmt::format("--actual {}: the references are there, and would be overwritten", options.actual));
  }
}

// the scenes with a moment named by --only
std::vector<std::string> chosen(const std::vector<std::string>& all, const GoldenOptions& options) {
  if (options.only.empty()) return all;
  std::map<std::string, std::string> files;
  for (const std::string& file : all) files[golden_name(file, options)] = file;
  std::vector<std::string> names;
  for (const GoldenChoice& each : options.only) {
    if (!files.contains(each.scene)) {
      std::vector<std::string_view> known;
      for (const auto& [name, file] : files) known.push_back(name);
      throw UsageError(fmt::format("--only {0}@{1}: there is no scene '{0}' among these{2}", each.scene,
                                   sim::value(each.time), scene::did_you_mean(each.scene, known)));
    }
    names.push_back(each.scene);
  }
  std::vector<std::string> some;
  for (const std::string& file : all)
    if (std::find(names.begin(), names.end(), golden_name(file, options)) != names.end())
      some.push_back(file);
  return some;
}

// a word of a shell
std::string word(const std::string& text) {
  static constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
  if (!text.empty() && text.find_first_not_of(plain) == text.npos) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// the command that makes what a report's reader approves the references: --only follows
std::string update_command(const GoldenFlags& flags) {
  std::string text = "obscura golden";
  const auto option = [&](const char* name, const std::string& value) {
    if (!value.empty()) text += fmt::format(" {} {}", name, word(value));
  };
  for (const std::string& scene : flags.scenes) text += " " + word(scene);
  option("--root", flags.golden.root);
  option("--references", flags.golden.references);
  option("--states", flags.golden.states);
  return text + " --update";
}

Outcome check(const std::string& file, const GoldenFlags& flags) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point began = Clock::now();
  Outcome outcome;
  outcome.name = golden_name(file, flags.golden);
  try {
    outcome.cases = check_golden(with_run_marks(scene::read(file, flags.sets)), flags.golden);
  } catch (const scene::Error& error) {
    outcome.cases = {failed(outcome.name, file, kScene, error.what())};
    outcome.cases[0].error = error;
  } catch (const TroubleError& error) {
    outcome.cases = {failed(outcome.name, file, kDiverged, error.what())};
  } catch (const media::Error& error) {
    outcome.cases = {failed(outcome.name, file, kFiles, error.what())};
  }
  outcome.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  for (GoldenCase& it : outcome.cases) it.seconds = outcome.seconds / double(outcome.cases.size());
  return outcome;
}

// a row a scene; under it what is not as it was
std::string text(const Outcome& outcome) {
  std::map<std::string, int> states;
  for (const GoldenCase& it : outcome.cases) ++states[it.state];
  std::string word, all;
  for (const auto& [state, count] : states)
    word += (word.empty() ? "" : ", ") + (states.size() == 1 ? state : fmt::format("{} {}", count, state));
  all = fmt::format("{:<18} {:>2} {:<8} {:<22} {:6.2f} s\n", outcome.name, outcome.cases.size(),
                    outcome.cases.size() == 1 ? "moment" : "moments", word, outcome.seconds);
  // ctest sets one of the two, interactive or not
  const bool ctest = std::getenv("CTEST_INTERACTIVE_DEBUG_MODE") != nullptr ||
                     std::getenv("DASHBOARD_TEST_FROM_CTEST") != nullptr;
  for (const GoldenCase& it : outcome.cases) {
    for (std::size_t i = 0; i < it.lines.size(); ++i)
      all += fmt::format("    {}{}\n", i == 0 && !it.time.empty() ? "t = " + it.time + " s: " : "  ",
                         it.lines[i]);
    if (ctest)
      for (const std::string& file : it.attachments)
        all += fmt::format("<CTestMeasurementFile type=\"image/png\" name=\"{}\">{}</CTestMeasurementFile>\n",
                           fs::path(file).stem().string(), fs::absolute(file).string());
  }
  return all;
}

// nothing but the object itself goes to standard output where that is JSON
void print(Format format, const std::string& text) {
  if (format == Format::json) return;
  clear_waiting();
  say_lines(stdout, format == Format::github ? github::verbatim(text) : text);
  std::fflush(stdout);
}

void write_page(const GoldenFlags& flags, const std::vector<GoldenCase>& cases) {
  // a scene changed by --set makes no reference of the scene as written
  const auto approvable = [&](const GoldenCase& it) { return !it.good() && flags.sets.empty(); };
  std::vector<Finding> findings;
  for (const GoldenCase& it : cases) {
    Finding finding{it.time.empty() ? it.scene : fmt::format("{}, t = {} s", it.scene, it.time),
                    it.state,
                    it.lines,
                    it.expected,
                    it.actual,
                    it.expected_by,
                    it.actual_by,
                    approvable(it) ? it.choice : std::string()};
    findings.push_back(std::move(finding));
  }
  // results to look at come first
  std::stable_partition(findings.begin(), findings.end(), [](const Finding& f) { return f.state != "same"; });
  write_text(*flags.report, report({"Golden images", update_command(flags)}, findings));
}

int golden(GoldenFlags& flags) {
  if (flags.golden.update && !flags.sets.empty())
    throw UsageError("--update takes the scenes as their files are: leave --set out, or write it into them");
  if (flags.report) require_ending("--report", *flags.report, ".html");
  if (flags.junit) require_ending("--junit", *flags.junit, ".xml");
  for (const std::string& each : flags.only) flags.golden.only.push_back(GoldenChoice::parse(each));
  const std::vector<std::string> named = files(flags);
  know_apart(named, flags.golden);
  const std::vector<std::string> all = chosen(named, flags.golden);
  if (!flags.golden.states.empty() && all.size() > 1)
    throw UsageError(fmt::format(
        "--states {} is one scene's run, and there are {}: name the scene, or say [golden] states = "
        "\"{}\" in it",
        flags.golden.states, all.size(), flags.golden.states));
  const int cores = std::max(1, int(std::thread::hardware_concurrency()));
  const int workers = std::min<int>(flags.workers > 0 ? flags.workers : cores, int(all.size()));
  const auto began = std::chrono::steady_clock::now();

  std::vector<GoldenCase> cases;
  std::size_t next = 0;
  Conduct<std::string, Outcome> parts;
  parts.produce = [&]() -> std::optional<std::string> {
    if (next >= all.size() || interrupted()) return {};
    doing(all[next], double(next), double(all.size()), "scenes");
    return all[next++];
  };
  parts.hire = [&] { return [&](std::string file) { return check(file, flags); }; };
  parts.consume = [&](Outcome outcome) {
    if (interrupted()) return false;
    print(flags.format, text(outcome));
    std::move(outcome.cases.begin(), outcome.cases.end(), std::back_inserter(cases));
    return true;
  };
  gl::ready(flags.golden.picture.context);
  conduct(parts, workers);
  if (interrupted()) return kInterrupted;

  int exit = kDone;
  std::map<std::string, int> states;
  for (const GoldenCase& it : cases) {
    ++states[it.state];
    if (it.exit != kDone) exit = it.exit;
    if (!it.good() && exit == kDone) exit = kDiffers;
  }
  std::string sum;
  for (const auto& [state, count] : states) sum += fmt::format(", {} {}", count, state);
  print(flags.format,
        fmt::format("{}, {}{}; {:.1f} s\n", counted(all.size(), "scene"), counted(cases.size(), "moment"),
                    sum, std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count()));
  if (flags.format == Format::json) fmt::print("{}", golden_json(cases, exit));
  if (flags.format == Format::github) fmt::print("{}", golden_annotations(cases));
  if (flags.junit) write_text(*flags.junit, junit(cases));
  if (flags.report) write_page(flags, cases);
  if (flags.format == Format::github) github::add_to_summary(golden_summary(cases));
  return exit;
}

}  // namespace

OBSCURA_COMMAND(120, golden) {
  const Command command(program, exit, "golden", "Compare pictures and states of scenes with references");
  auto flags = std::make_shared<GoldenFlags>();
  command.option(
      "SCENE", flags->scenes,
      "Scenes, or folders; in a folder and those in it the scenes with a [golden] table [scenes, or .]");
  command
      .option("--references", flags->golden.references,
              "The folder of the references [golden/ beside each scene]")
      .type("DIR");
  command.option("--root", flags->golden.root, "Name scenes by their path from here [the current folder]")
      .type("DIR");
  command
      .option("--states", flags->golden.states,
              "Another program's run, drawn and compared instead of the simulation's [golden.states]")
      .type("RUN.csv");
  command.flag("--update", flags->golden.update, "Take the current pictures and states as references");
  command
      .option("--only", flags->only,
              "Only this moment of this scene, as in room@2.5; with the name given by --report, only if it "
              "is still that picture; may be repeated")
      .type("SCENE@SECONDS")
      .repeated();
  command
      .option("--actual", flags->golden.actual,
              "Folder for the pictures of failures and their differences [render_out/golden]")
      .type("DIR");
  command.option("--junit", flags->junit, "Write the results as JUnit's XML").type("OUT.xml");
  command
      .option("--report", flags->report,
              "Write a page with expected, actual and difference, where single pictures are approved")
      .type("OUT.html");
  add_format(command, flags->format);
  command.flag("--other-gl-states", flags->golden.states_only_on_other_gl,
               "If another OpenGL drew a reference, compare only states");
  command.option("-j,--jobs", flags->workers, "Scenes in parallel [one per core]").range(1, 256);
  add_backend(command, flags->golden.picture.context.backend);
  add_sets(command, flags->sets);
  command.footer(
      "A scene's [golden] table names the moments, the size, and what may differ, with a reason. States are "
      "compared first, then pixels. A reference is a PNG, SCENE-SECONDS.png, with its origin, so golden can "
      "name the cause of a difference. If a reference is missing, the moment fails and its picture is "
      "written. With --references, and for pictures of failures, a scene is named by its path from --root, "
      "without .toml. docs/golden.md has recipes.\n\n"
      "Exit codes: 0 all are the same, 1 something differs or is missing, 3 a scene cannot be read, 4 a "
      "reference or run cannot, 6 one diverged.\n\n"
      "Examples:\n"
      "  obscura golden\n"
      "  obscura golden scenes/room.toml --report report.html\n"
      "  obscura golden room.toml --states student.csv\n"
      "  obscura golden scenes --root scenes --references tests/golden --update");
  command.run([flags] { return golden(*flags); });
}

}  // namespace obscura::app
