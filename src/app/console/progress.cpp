#include "app/console/progress.h"

#include <unistd.h>

#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/console/say.h"

namespace obscura::app {

namespace {

std::string clock(double seconds) {
  const long s = long(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
  return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

// a closed standard error does not stop the film
void put(const std::string& text, std::FILE* to = stderr) { std::fputs(text.c_str(), to); }

}  // namespace

Progress::Progress(ProgressKind kind, std::string what, std::int64_t frames, double frame_seconds,
                   std::string unit)
    : kind_(kind),
      what_(scene::one_line(what)),
      unit_(std::move(unit)),
      frames_(frames),
      frame_seconds_(frame_seconds),
      began_(std::chrono::steady_clock::now()),
      printed_(began_) {
  terminal_ = kind == ProgressKind::automatic && isatty(STDERR_FILENO) == 1;
  if (kind != ProgressKind::none) hushed_.emplace();
}

Progress::~Progress() { clear(); }

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
}

void Progress::at(std::int64_t done) {
  if (kind_ == ProgressKind::none) return doing("", double(done), double(frames_), unit_);
  const auto now = std::chrono::steady_clock::now();
  if (first_ < 0 && done > 0) first_ = done, first_at_ = now;
  const double since = std::chrono::duration<double>(now - printed_).count();
  const double due = terminal_ ? 0.1 : kind_ == ProgressKind::json ? 0.5 : 5;
  if (since < due) return;
  printed_ = now;
  print(done, false);
}

void Progress::print(std::int64_t done, bool last) {
  // the rate leaves out the start, where contexts and shaders are made
  const double now = seconds();
  double rate = now > 0 ? double(done) / now : 0;
  if (first_ > 0 && done > first_) {
    const double since = std::chrono::duration<double>(std::chrono::steady_clock::now() - first_at_).count();
    if (since > 0.5) rate = double(done - first_) / since;
  }
  const double left = rate > 0 ? double(frames_ - done) / rate : 0;
  if (kind_ == ProgressKind::json) {
    nlohmann::ordered_json line = {{"event", last ? "done" : "progress"}, {"output", what_}};
    if (unit_ == "frames")
      line.update({{"frame", done}, {"frames", frames_}, {"fps", rate}, {"speed", rate * frame_seconds_}});
    else
      line.update({{"done", done}, {unit_, frames_}, {"rate", rate}});
    line["elapsed"] = now;
    if (!last) line["left"] = left;
    put(line.dump() + "\n");
  } else if (done == 0) {
    if (terminal_) put(fmt::format("\r\033[K{}  starting", what_));
  } else {
    const std::string speed = unit_ == "frames"
                                  ? fmt::format("{:.0f} fps  {:.1f}x real time", rate, rate * frame_seconds_)
                                  : fmt::format("{:.3g} {}/s", rate, unit_);
    const std::string line = fmt::format("{}  {}/{} {}  {:.0f} %  {}  {} left", what_, done, frames_, unit_,
                                         100.0 * double(done) / double(frames_), speed, clock(left));
    put(fmt::format("{}{}{}", terminal_ ? "\r\033[K" : "", line, terminal_ ? "" : "\n"));
  }
  shown_ = terminal_;
  std::fflush(stderr);
}

void Progress::clear() {
  if (shown_) put("\r\033[K");
  shown_ = false;
}

void Progress::finish(std::int64_t done, const std::string& summary, bool to_stdout) {
  clear();
  if (kind_ == ProgressKind::none) return;
  if (kind_ == ProgressKind::json) {
    print(done, true);
  } else {
    say(to_stdout ? stdout : stderr, "{}\n", summary);
  }
}

}  // namespace obscura::app
