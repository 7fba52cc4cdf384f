#include "app/run/measures.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/columns.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/trouble.h"
#include "draw/page/measure.h"
#include "draw/page/readings.h"
#include "scene/complaints.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

using Over = Question::Over;

constexpr std::array<std::pair<std::string_view, Over>, 6> kOver{{{"end", Over::end},
                                                                  {"max", Over::max},
                                                                  {"min", Over::min},
                                                                  {"mean", Over::mean},
                                                                  {"argmax", Over::argmax},
                                                                  {"argmin", Over::argmin}}};
constexpr std::string_view kHashName = "hash";
constexpr std::size_t kFew = 200;      // bodies whose quantities are all offered where a name is not known
constexpr std::size_t kMostNames = 8;  // that are listed where no name is near
std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool over_run(Over over) { return over != Over::at && over != Over::end && over != Over::mark; }

Question question(std::string_view text) {
  Question asked;
  asked.text = text;
  const auto sign = text.rfind('@');
  if (sign == text.npos || sign == 0 || sign + 1 == text.size())
    throw UsageError(
        fmt::format("--measure {}: expected NAME@WHEN, as in energy.total@5 or crate.position.y@max", text));
  asked.path = trimmed(text.substr(0, sign));
  const std::string_view when = trimmed(text.substr(sign + 1));
  if (const auto time = sim::parse_rational(when); time && !(*time < sim::Rational{0, 1})) {
    asked.over = Over::at, asked.at = *time;
    return asked;
  }
  std::vector<std::string_view> names;
  for (const auto& [name, over] : kOver) {
    names.push_back(name);
    if (name == when) asked.over = over;
  }
  if (std::find(names.begin(), names.end(), when) == names.end()) {
    // whether the scene makes it is seen when that is known
    const auto mark = scene::parse_mark(std::string(when));
    if (!mark || std::isalpha(static_cast<unsigned char>(mark->first.empty() ? '0' : mark->first[0])) == 0)
      throw UsageError(
          fmt::format("--measure {}: @{} is no instant (s), no mark such as hit[2], and none of {}", text,
                      when, fmt::join(names, ", ")));
    asked.over = Over::mark, asked.mark = mark->first, asked.time = mark->second;
  }
  if (asked.path == kHashName && over_run(asked.over))
    throw UsageError(fmt::format("--measure {}: a hash is of an instant, as in hash@end", text));
  return asked;
}

// how a number is read from an instant; nothing of a hash
std::function<double(const sim::Snapshot&)> reader(const Question& asked, const sim::SceneInfo& cast,
                                                   const std::vector<Column>& all) {
  if (asked.path == kHashName) return {};
  for (const Column& column : all)
    if (column.name == asked.path) return column.read;

  // a quantity that plots show: of a body, or of all the room
  std::vector<std::string> more{std::string(kHashName)};
  for (const std::string& name : draw::plotted()) {
    const draw::Measure* measure = draw::measure(name);
    if (measure->of == draw::Measure::Of::body) continue;
    more.push_back(name);
    if (name == asked.path)
      return [measure, cast](const sim::Snapshot& now) { return measure->at(cast, now, -1); };
  }
  for (std::size_t i = 0; i < cast.bodies.size(); ++i) {
    const int body = int(i);
    const bool sprung = std::any_of(cast.springs.begin(), cast.springs.end(),
                                    [&](const auto& spring) { return spring.a == body || spring.b == body; });
    const std::string& whose = cast.bodies[i].name;
    if (!asked.path.starts_with(whose + ".") && cast.bodies.size() > kFew) continue;
    for (const std::string& name : draw::plotted()) {
      const draw::Measure* measure = draw::measure(name);
      if (measure->of == draw::Measure::Of::room || (!sprung && (name == "length" || name == "push")))
        continue;
      more.push_back(whose + "." + name);
      if (more.back() == asked.path)
        return [measure, cast, body](const sim::Snapshot& now) { return measure->at(cast, now, body); };
      // the components of what arrows show
      if (!measure->arrow) continue;
      for (int k = 0; k < cast.dimension; ++k)
        if (fmt::format("{}.{}.{}", whose, name, "xyz"[k]) == asked.path)
          return [quantity = *measure->arrow, cast, body, k](const sim::Snapshot& now) {
            return draw::sum(quantity, body, cast, now)[k];
          };
    }
  }
  // the parts of the potential energy
  more.push_back("energy.gravity"), more.push_back("energy.springs");
  if (asked.path == "energy.gravity") return [](const sim::Snapshot& now) { return now.energies.gravity; };
  // of a room whose books have none it is zero
  if (asked.path == "energy.work") return [](const sim::Snapshot& now) { return now.energies.work; };
  if (asked.path == "energy.springs") return [](const sim::Snapshot& now) { return now.energies.springs; };
  // how much a joint bears
  for (std::size_t i = 0; i < cast.joints.size(); ++i) {
    const std::string& whose = cast.joints[i].name;
    if (!asked.path.starts_with(whose + ".")) continue;
    more.push_back(whose + ".force"), more.push_back(whose + ".torque");
    if (asked.path == whose + ".force")
      return [i](const sim::Snapshot& now) { return now.joints[i].force.norm(); };
    if (asked.path == whose + ".torque")
      return [i](const sim::Snapshot& now) { return now.joints[i].torque.norm(); };
  }
  std::vector<std::string_view> names(more.begin(), more.end());
  for (const Column& column : all) names.push_back(column.name);
  std::string meant = scene::did_you_mean(asked.path, names);
  if (meant.empty()) {
    // what else there is of the same thing
    const std::string whose = asked.path.substr(0, asked.path.rfind('.') + 1);
    std::vector<std::string_view> its;
    for (const std::string_view name : names)
      if (!whose.empty() && name.starts_with(whose) && its.size() < kMostNames &&
          std::find(its.begin(), its.end(), name) == its.end())
        its.push_back(name);
    if (!its.empty()) meant = fmt::format("; there are {}", fmt::join(its, ", "));
  }
  if (meant.empty()) meant = "; `obscura states --format csv` heads its columns with the names";
  throw UsageError(fmt::format("--measure {}: states have no '{}'{}", asked.text, asked.path, meant));
}

// the value over the instants so far
struct Tally {
  bool any = false;
  double extreme = 0, when = 0;       // the extreme, and when first
  double area = 0, last = 0, at = 0;  // of the mean: the area so far, the last value, its time

  void add(Over over, double value, double t) {
    const bool least = over == Over::min || over == Over::argmin;
    if (!any || (least ? value < extreme : value > extreme)) extreme = value, when = t;
    if (any) area += (t - at) * (last + value) / 2;
    any = true, last = value, at = t;
  }
  double result(Over over) const {
    if (over == Over::mean) return at > 0 ? area / at : last;
    return over == Over::argmax || over == Over::argmin ? when : extreme;
  }
};

// refuses a mark that no event of the scene makes
void check_mark(const Question& asked, const scene::Scene& scene) {
  const std::vector<std::string> made = made_marks(scene);
  if (std::find(made.begin(), made.end(), asked.mark) != made.end()) return;
  std::vector<std::string_view> names(made.begin(), made.end());
  for (const auto& [name, over] : kOver) names.push_back(name);
  throw UsageError(fmt::format("--measure {}: no [[when]] of the scene makes a mark '{}'{}", asked.text,
                               asked.mark, scene::did_you_mean(asked.mark, names)));
}

// when a run comes to a mark, if it does
std::optional<sim::Rational> instant_of(const Question& asked, const std::vector<sim::RunEvent>& events) {
  int times = 0;
  for (const sim::RunEvent& event : events)
    for (const std::string& mark : event.marks)
      if (mark == asked.mark && ++times == asked.time) return event.time;
  return {};
}

std::string text(double x) { return fmt::format("{}", x == 0 ? 0.0 : x); }

}  // namespace

std::vector<Question> questions(const std::string& list) {
  std::vector<Question> all;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t comma = std::min(list.find(',', from), list.size());
    all.push_back(question(trimmed(std::string_view(list).substr(from, comma - from))));
    from = comma + 1;
  }
  return all;
}

void check(const std::vector<Question>& asked, const scene::Scene& scene) {
  const auto run = scene.run();
  const std::vector<Column> all = columns(run->scene_info(), scene.axes);
  for (const Question& each : asked) {
    (void)reader(each, run->scene_info(), all);
    if (each.over == Over::mark) check_mark(each, scene);
  }
}

Answers answers(const scene::Scene& scene, const std::vector<Question>& asked) {
  const auto run = scene.run();
  run->heed(interrupted);
  const std::vector<Column> all = columns(run->scene_info(), scene.axes);
  std::vector<std::function<double(const sim::Snapshot&)>> readers;
  for (const Question& each : asked) readers.push_back(reader(each, run->scene_info(), all));

  Answers found;
  found.values.resize(asked.size());
  // when events mark an instant: by a run to the end, before this one
  std::vector<sim::RunEvent> events;
  if (std::any_of(asked.begin(), asked.end(), [](const Question& each) { return each.over == Over::mark; })) {
    const auto before = scene.run();
    before->heed(interrupted);
    if (std::holds_alternative<sim::Stopped>(before->at(scene.duration))) throw Interrupted();
    events = sim::events_until(*before, scene.duration);
  }

  // the instants asked for, in the order of time
  std::vector<std::pair<sim::Rational, std::size_t>> instants;
  bool steps = false;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    if (asked[k].over == Over::mark) {
      check_mark(asked[k], scene);
      if (const auto t = instant_of(asked[k], events)) instants.emplace_back(*t, k);
    } else if (over_run(asked[k].over))
      steps = true;
    else
      instants.emplace_back(asked[k].over == Over::end ? scene.duration : asked[k].at, k);
  }
  std::stable_sort(instants.begin(), instants.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });

  std::vector<Tally> tallies(asked.size());
  const auto at = [&](sim::Rational t) -> std::optional<sim::Snapshot> {
    auto outcome = run->at(t);
    if (std::holds_alternative<sim::Stopped>(outcome)) throw Interrupted();
    if (const auto* bad = std::get_if<sim::Trouble>(&outcome)) {
      found.trouble = *bad;
      return {};
    }
    return std::get<sim::Snapshot>(std::move(outcome));
  };

  // both at once: ends of steps up to the duration, and the instants
  std::int64_t step = 0;
  std::size_t next = 0;
  while (steps || next < instants.size()) {
    const sim::Rational beat = std::min(sim::rational(step) / run->rate(), scene.duration,
                                        [](sim::Rational a, sim::Rational b) { return a < b; });
    const bool is_beat = steps && (next == instants.size() || beat <= instants[next].first);
    const sim::Rational t = is_beat ? beat : instants[next].first;
    const auto now = at(t);
    if (!now) return found;
    if (is_beat) {
      for (std::size_t k = 0; k < asked.size(); ++k)
        if (over_run(asked[k].over)) tallies[k].add(asked[k].over, readers[k](*now), now->time);
      ++step;
      steps = beat < scene.duration;
    }
    for (; next < instants.size() && instants[next].first == t; ++next) {
      const std::size_t k = instants[next].second;
      found.values[k] = readers[k] ? text(readers[k](*now)) : state_hash(run->words());
    }
  }
  found.limit_notes = limit_notes(*run);
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (over_run(asked[k].over)) found.values[k] = text(tallies[k].result(asked[k].over));
  return found;
}

}  // namespace obscura::app
