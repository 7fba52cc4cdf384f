#include "app/run/run_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/say.h"
#include "scene/complaints.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

bool may_stop(const scene::Scene& scene) {
  return std::visit(
      [](const auto& world) {
        for (const auto& when : world.model.whens)
          for (const auto& action : when.actions)
            if (action.what == std::decay_t<decltype(action)>::Do::stop) return true;
        return false;
      },
      scene.world);
}

// the first microsecond that is not before it
sim::Rational microsecond(sim::Rational t) {
  const sim::Rational all = sim::rational(1'000'000);
  return sim::rational(sim::ceil(t * all), 1'000'000);
}

bool names_mark(const std::string& word) {
  return !word.empty() && (std::isalpha(static_cast<unsigned char>(word[0])) != 0 || word[0] == '_');
}

// what a run of the scene marks until its duration; one that cannot go on has marked what it came to
scene::RunMarks marks_of_run(const scene::Scene& scene) {
  const auto run = scene.shown_run();
  run->heed(interrupted);
  if (std::holds_alternative<sim::Stopped>(run->at(scene.duration))) throw Interrupted();
  scene::RunMarks found;
  for (const sim::RunEvent& event : sim::events_until(*run, scene.duration)) {
    for (const std::string& mark : event.marks) found.instants[mark].push_back(microsecond(event.time));
    if (event.stop && !found.stop) found.stop = microsecond(event.time);
  }
  return found;
}

std::vector<std::pair<std::string, sim::Rational>> in_order(const scene::RunMarks& marks) {
  std::vector<std::pair<std::string, sim::Rational>> all;
  for (const auto& [name, instants] : marks.instants)
    for (const sim::Rational& instant : instants) all.emplace_back(name, instant);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return all;
}

}  // namespace

bool waits_for_run(const scene::Scene& scene) {
  return !scene.marked && !scene.trajectory && (!scene.marks.empty() || may_stop(scene));
}

scene::Scene with_run_marks(scene::Scene scene) {
  if (!waits_for_run(scene)) return scene;
  const scene::RunMarks found = marks_of_run(scene);
  for (const std::string& mark : scene.marks)
    if (!found.at(mark))
      say(stderr, "{}: its run does not come to the mark '{}'; what waits for it is not shown\n", scene.file,
          mark);
  scene::Scene put = scene.again(scene.sets, &found);
  put.marks = scene.marks;
  put.passed = in_order(found);
  return put;
}

std::vector<std::pair<std::string, sim::Rational>> passed_marks(const scene::Scene& scene) {
  if (scene.trajectory) return {};
  if (scene.marked || made_marks(scene).empty()) return scene.passed;
  return in_order(marks_of_run(scene));
}

std::vector<std::string> made_marks(const scene::Scene& scene) {
  std::vector<std::string> made;
  std::visit(
      [&](const auto& world) {
        for (const auto& when : world.model.whens)
          for (const auto& action : when.actions)
            if (!action.mark.empty()) made.push_back(action.mark);
      },
      scene.world);
  return made;
}

std::string with_instants(const scene::Scene& scene, std::string_view flag, const std::string& list) {
  std::optional<scene::RunMarks> marks;
  std::string put;
  for (std::size_t from = 0; from <= list.size();) {
    const std::size_t to = std::min(list.find_first_of(",:", from), list.size());
    const std::string item = list.substr(from, to - from);
    const auto mark = scene::parse_mark(item);
    if (mark && names_mark(mark->first)) {
      const std::vector<std::string> made = made_marks(scene);
      if (std::find(made.begin(), made.end(), mark->first) == made.end())
        throw UsageError(fmt::format("{} {}: no [[when]] of the scene makes a mark '{}'{}", flag, list,
                                     mark->first,
                                     scene::did_you_mean(mark->first, {made.begin(), made.end()})));
      if (!marks) marks = marks_of_run(scene);
      const auto time = marks->at(item);
      if (!time)
        throw UsageError(fmt::format("{} {}: the run does not come to '{}' within its {} s", flag, list, item,
                                     sim::value(scene.duration)));
      put += sim::text(*time);
    } else {
      put += item;
    }
    if (to < list.size()) put += list[to];
    from = to + 1;
  }
  return put;
}

}  // namespace obscura::app
