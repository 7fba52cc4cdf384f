#include "app/run/run_marks.h"

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/console/say.h"
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

}  // namespace

scene::Scene with_run_marks(scene::Scene scene) {
  if (scene.marked || scene.trajectory || (scene.marks.empty() && !may_stop(scene))) return scene;
  const auto run = scene.shown_run();
  run->heed(interrupted);
  // a run that cannot go on has marked what it came to
  if (std::holds_alternative<sim::Stopped>(run->at(scene.duration))) throw Interrupted();
  scene::RunMarks found;
  for (const sim::RunEvent& event : run->events()) {
    for (const std::string& mark : event.marks) found.instants[mark].push_back(microsecond(event.time));
    if (event.stop && !found.stop) found.stop = microsecond(event.time);
  }
  for (const std::string& mark : scene.marks)
    if (!found.at(mark))
      say(stderr, "{}: its run does not come to the mark '{}'; what waits for it is not shown\n", scene.file,
          mark);
  scene::Scene put = scene.again(scene.sets, &found);
  put.marks = scene.marks;
  return put;
}

}  // namespace obscura::app
