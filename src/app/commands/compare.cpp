// obscura compare: two pictures, two sequences of them, or two runs as tables: whether they are the same,
// where they are not, and why.

#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/compare/comparison.h"
#include "app/compare/format.h"
#include "app/compare/github.h"
#include "app/compare/report.h"
#include "app/compare/runs.h"
#include "app/console/command.h"
#include "app/console/commands.h"
#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/options.h"
#include "app/console/say.h"
#include "app/console/waiting.h"
#include "media/png.h"

namespace obscura::app {

namespace {

struct CompareFlags {
  std::string a, b;
  Format format = Format::text;
  std::optional<std::string> diff, report;
  std::optional<double> rtol, atol;
  bool interpolate = false;
};

// whether a file lies in a folder, or in one of those in it
bool lies_in(const std::string& file, const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code none;
  if (!fs::is_directory(folder, none)) return false;
  const fs::path way = fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !way.empty() && *way.begin() != "..";
}

// whether a file that is to be written is one of those that are read: A, B, or a picture in either folder
void spare_inputs(const CompareFlags& flags) {
  namespace fs = std::filesystem;
  for (const auto& [name, out] : {std::pair("--diff", flags.diff), {"--report", flags.report}}) {
    if (!out || !fs::exists(*out)) continue;
    for (const std::string& in : {flags.a, flags.b}) {
      std::error_code none;
      const bool inside = fs::path(*out).extension() == ".png" && lies_in(*out, in);
      if (inside || fs::equivalent(*out, in, none))
        throw UsageError(fmt::format("{} {}: would be written over {}, which is compared", name, *out,
                                     inside ? "a picture of " + in : in));
    }
  }
  if (flags.diff) require_ending("--diff", *flags.diff, ".png");
  if (flags.report) require_ending("--report", *flags.report, ".html");
}

void refuse_page(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".html")
    throw UsageError(path + ": is a page, and no page is compared: `obscura verify` makes it again");
}

bool is_table(const std::string& path) {
  const auto ending = std::filesystem::path(path).extension();
  return ending == ".csv" || ending == ".json";
}

// output for people or programs; also for GitHub if the two differ
void tell(const CompareFlags& flags, bool same, const std::string& text, const std::string& json) {
  if (flags.format != Format::github) {
    clear_waiting();
    say_lines(stdout, flags.format == Format::json ? json : text);
    return;
  }
  say_lines(stdout, github::verbatim(text));
  if (!same) fmt::print("{}", github::command({.title = "compare", .message = text}));
  github::add_to_summary(fmt::format("### {} and {} {}\n\n", github::escaped(flags.a),
                                     github::escaped(flags.b), same ? "are the same" : "differ") +
                         (same ? "" : github::quoted(text)));
}

int compare_runs(const CompareFlags& flags) {
  if (flags.diff || flags.report) throw UsageError("--diff and --report are for pictures, not for tables");
  const Tolerance tolerance{flags.rtol.value_or(0), flags.atol.value_or(0)};
  const RunComparison found = compare(read_table(flags.a), read_table(flags.b), tolerance, flags.interpolate);
  tell(flags, found.same(), text(found, tolerance), json(found));
  return found.same() ? kDone : kDiffers;
}

void write_report(const Comparison& found, const std::string& path) {
  std::vector<Finding> findings;
  for (const int i : {found.first, found.worst}) {
    if (i < 0 || (!findings.empty() && found.first == found.worst)) continue;
    const Comparison::Frame& frame = found.differing[std::size_t(i)];
    std::vector<std::string> lines = {sentence(frame)};
    if (findings.empty() && found.cause)
      lines.insert(lines.end(), found.cause->lines.begin(), found.cause->lines.end());
    if (findings.empty()) lines.insert(lines.end(), found.plain.begin(), found.plain.end());
    const char* mark = found.still ? "" : i == found.first ? ", the first" : ", the worst";
    const auto by = [](const std::optional<Origin>& origin) { return origin ? origin->drawn_by() : ""; };
    findings.push_back(
        {frame.name + mark, "differs", lines, frame.a, frame.b, by(frame.origin_a), by(frame.origin_b), ""});
  }
  if (findings.empty())
    findings.push_back({found.a, found.same() ? "same" : "differs", {text(found)}, {}, {}, "", "", ""});
  write_text(path, report({fmt::format("{} and {}", found.a, found.b), ""}, findings));
}

int run(const CompareFlags& flags) {
  for (const std::string& each : {flags.a, flags.b}) refuse_page(each);
  if (is_table(flags.a) != is_table(flags.b))
    throw UsageError(fmt::format("{} is a table and {} is not", is_table(flags.a) ? flags.a : flags.b,
                                 is_table(flags.a) ? flags.b : flags.a));
  if (is_table(flags.a)) return compare_runs(flags);
  if (flags.rtol || flags.atol || flags.interpolate)
    throw UsageError("--rtol, --atol and --interpolate are for tables (.csv, .json)");
  spare_inputs(flags);
  const Comparison found = compare(flags.a, flags.b);
  if (interrupted()) return kInterrupted;
  tell(flags, found.same(), text(found), json(found));
  if (flags.diff && found.worst >= 0) {
    const Comparison::Frame& worst = found.differing[std::size_t(found.worst)];
    media::write_png(*flags.diff, media::difference_picture(worst.a, worst.b));
  }
  if (flags.report) write_report(found, *flags.report);
  return found.same() ? kDone : kDiffers;
}

}  // namespace

OBSCURA_COMMAND(100, compare) {
  const Command command(program, exit, "compare",
                        "Say whether two pictures, sequences or runs are the same, and if not, why");
  auto flags = std::make_shared<CompareFlags>();
  command.option("A", flags->a, "The expected one: a PNG, a folder of them, a movie, or a run as CSV or JSON")
      .required();
  command.option("B", flags->b, "The actual one, of the same kind").required();
  command
      .option("--diff", flags->diff, "Write a picture of the differences; for a sequence, of its worst frame")
      .type("OUT.png");
  command.option("--report", flags->report, "Write a page with both, a slider and a blink").type("OUT.html");
  add_format(command, flags->format);
  command.option("--rtol", flags->rtol, "For runs: tolerance relative to A's value [0]").range(0.0, 1e300);
  command.option("--atol", flags->atol, "For runs: absolute tolerance, in the quantity's unit [0]")
      .range(0.0, 1e300);
  command.flag("--interpolate", flags->interpolate, "For runs: straight lines between B's rows");
  command.footer(
      "Files with the same bytes are the same. Otherwise pixels are compared: how many differ, the largest "
      "difference of a channel, how many differ by more than an edge that moved by less than a pixel "
      "(solid), the box around them. If both files carry their origin, as all that obscura writes do, "
      "compare names the cause: other scene, other state (both are simulated again to find the step, body "
      "and quantity of the first difference), other look, other OpenGL, or pixels only.\n"
      "Folders are compared with those in them, by the names of their files; where no name is in both, in "
      "order. Movies that show the same frames at other times differ.\n"
      "Runs are tables as `obscura states` writes them, as CSV or JSON. A is the reference: its times and "
      "its bodies' positions must be in B, and each component of a quantity that B has; other quantities "
      "that B leaves out are told. Times within half a microsecond are equal; values need |b - a| <= atol "
      "+ rtol |a|, angles without whole turns; inf and nan are equal only to themselves.\n\n"
      "Exit codes: 0 the same, 1 they differ, 2 usage, 4 something cannot be read.\n\n"
      "Examples:\n"
      "  obscura compare old.png new.png --diff difference.png\n"
      "  obscura compare frames/ again/ --report report.html\n"
      "  obscura compare room.mp4 again.mp4 --format json\n"
      "  obscura compare reference.csv student.csv --atol 1e-3");
  command.run([flags] { return run(*flags); });
}

}  // namespace obscura::app
