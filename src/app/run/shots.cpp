#include "app/run/shots.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "app/console/exit.h"

namespace obscura::app {

namespace {

std::vector<std::string_view> split(std::string_view list, char at) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t comma = list.find(at);
    parts.push_back(list.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    list.remove_prefix(comma + 1);
  }
}

std::int64_t frame_number(std::string_view text, const std::string& list, const char* asked) {
  std::int64_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size() || n < 0) {
    throw UsageError(fmt::format("{} {}: expected frame numbers from 0, as in 1,3,5..9", asked, list));
  }
  return n;
}

sim::Rational instant(std::string_view text, const std::string& list) {
  const auto time = sim::parse_rational(text);
  if (!time) throw UsageError(fmt::format("\"{}\": expected seconds, as in 0,0.5,2 or 0:10:0.5", list));
  if (*time < sim::Rational{0, 1}) throw UsageError(fmt::format("\"{}\": a run starts at 0 s", list));
  if (kLongest < *time) throw UsageError(fmt::format("\"{}\": a run ends before 1e6 s", list));
  return *time;
}

}  // namespace

double film_time(const Shot& shot, sim::Rational fps, const draw::Pace& speed) {
  const sim::Rational film = sim::rational(shot.frame) / fps;
  return sim::value(speed.world(film) == shot.time ? film : speed.film(shot.time));
}

Shots Shots::film(sim::Rational duration, sim::Rational fps, const draw::Pace& speed) {
  Shots shots;
  shots.fps_ = fps, shots.speed_ = speed;
  shots.size_ = shots.first_at(duration);
  // what stands still at the end belongs to the film
  if (const sim::Rational last = speed.frozen_at(duration); last.num > 0)
    shots.size_ = sim::ceil((speed.film(duration) + last) * fps);
  if (shots.size_ > 0) shots.ranges_ = {{0, shots.size_ - 1}};
  return shots;
}

Shots Shots::still(sim::Rational time, sim::Rational fps, const draw::Pace& speed) {
  return stills({time}, fps, speed);
}

Shots Shots::stills(std::vector<sim::Rational> times, sim::Rational fps, const draw::Pace& speed) {
  Shots shots;
  shots.fps_ = fps, shots.speed_ = speed;
  shots.size_ = std::int64_t(times.size());
  shots.instants_ = std::move(times);
  return shots;
}

Shots Shots::again(const Shot& shot, sim::Rational fps, const draw::Pace& speed) {
  Shots shots = still(shot.time, fps, speed);
  // where a film stands still, several frames are of one instant
  if (shots.instant(shot.frame) == shot.time)
    shots.instants_.clear(), shots.ranges_ = {{shot.frame, shot.frame}};
  return shots;
}

// the first frame that shows an instant not before `time`
std::int64_t Shots::first_at(sim::Rational time) const {
  if (speed_.plain()) return sim::ceil(time * fps_);
  // near it by the film's time, which is rounded; then as the frames themselves say
  auto n = std::int64_t(sim::value(speed_.film(time)) * sim::value(fps_));
  while (n > 0 && !(instant(n - 1) < time)) --n;
  while (instant(n) < time) ++n;
  return n;
}

// the last frame that shows an instant not after `time`
std::int64_t Shots::frame_of(sim::Rational time) const {
  if (speed_.plain()) return sim::floor(time * fps_);
  const std::int64_t n = first_at(time);
  return time < instant(n) ? n - 1 : n;
}

void Shots::between(sim::Rational from, sim::Rational to) {
  if (!instants_.empty()) return;
  const std::int64_t first = first_at(from), last = first_at(to) - 1;
  std::vector<std::pair<std::int64_t, std::int64_t>> kept;
  size_ = 0;
  for (auto [a, b] : ranges_) {
    a = std::max(a, first), b = std::min(b, last);
    if (a <= b) kept.emplace_back(a, b), size_ += b - a + 1;
  }
  ranges_ = kept;
  if (size_ == 0) {
    throw UsageError(
        fmt::format("no frame lies between {:g} s and {:g} s", sim::value(from), sim::value(to)));
  }
}

void Shots::only(const std::string& list, const char* asked) {
  const std::int64_t first = ranges_.front().first, last = ranges_.back().second;
  std::vector<std::pair<std::int64_t, std::int64_t>> wanted;
  size_ = 0;
  for (const std::string_view part : split(list, ',')) {
    const std::size_t dots = part.find("..");
    const std::int64_t a = frame_number(part.substr(0, dots), list, asked);
    const std::int64_t b =
        dots == std::string_view::npos ? a : frame_number(part.substr(dots + 2), list, asked);
    if (b < a) throw UsageError(fmt::format("{} {}: {}..{} runs backwards", asked, list, a, b));
    if (a < first || b > last) {
      throw UsageError(fmt::format("{} {}: the film has frames {} to {}", asked, list, first, last));
    }
    wanted.emplace_back(a, b);
    size_ += b - a + 1;
  }
  // frames are made in the order of time, each once
  std::sort(wanted.begin(), wanted.end());
  for (std::size_t i = 1; i < wanted.size(); ++i) {
    if (wanted[i].first <= wanted[i - 1].second) {
      throw UsageError(fmt::format("{} {}: frame {} is named twice", asked, list, wanted[i].first));
    }
  }
  ranges_ = wanted;
}

Shot Shots::operator[](std::int64_t i) const {
  if (!instants_.empty()) {
    const sim::Rational time = instants_[std::size_t(i)];
    return {frame_of(time), time};
  }
  for (const auto& [a, b] : ranges_) {
    const std::int64_t n = b - a + 1;
    if (i < n) return {a + i, instant(a + i)};
    i -= n;
  }
  return {};
}

std::int64_t Shots::last_frame() const {
  return instants_.empty() ? ranges_.back().second : frame_of(instants_.back());
}

std::string Shots::text() const {
  std::string text;
  for (const auto& [a, b] : ranges_) {
    text += (text.empty() ? "" : ",") + (a == b ? fmt::format("{}", a) : fmt::format("{}..{}", a, b));
  }
  return text;
}

std::vector<sim::Rational> instants(const std::string& list) {
  std::vector<sim::Rational> times;
  for (const std::string_view part : split(list, ',')) {
    const auto ends = split(part, ':');
    if (ends.size() == 1) {
      times.push_back(instant(part, list));
    } else if (ends.size() == 3) {
      const sim::Rational from = instant(ends[0], list), to = instant(ends[1], list),
                          by = instant(ends[2], list);
      if (by.num == 0)
        throw UsageError(fmt::format("\"{}\": the last number of a range is its stride, above 0", list));
      if (to < from)
        throw UsageError(fmt::format("\"{}\": the range {}:{}:{} runs backwards: expected from:to:stride",
                                     list, ends[0], ends[1], ends[2]));
      const std::int64_t n = sim::floor((to - from) / by);
      if (n > 10'000'000) throw UsageError(fmt::format("\"{}\": {} instants are too many", list, n));
      for (std::int64_t i = 0; i <= n; ++i) times.push_back(from + by * sim::rational(i));
    } else {
      throw UsageError(fmt::format("\"{}\": a range is from:to:stride", list));
    }
  }
  if (!std::is_sorted(times.begin(), times.end(), [](auto a, auto b) { return a < b; })) {
    throw UsageError(fmt::format("\"{}\": instants must not go back in time", list));
  }
  return times;
}

}  // namespace obscura::app
