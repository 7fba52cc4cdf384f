#include "app/run/outside.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/run/simulation.h"
#include "draw/compose/annotate.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

bool shows(const draw::Projection& page, const sim::Vec3& place) {
  if (!page.before(place)) return false;
  const draw::Rect& window = page.window();
  const draw::Point at = page.page(place);
  return at.x() >= window.x && at.x() <= window.x + window.width && at.y() >= window.y &&
         at.y() <= window.y + window.height;
}

// whether a place of the room is in a picture while it may be shown
bool is_shown(const draw::Site& at, const draw::Interval& shown, const draw::Illustrator& artist,
              std::span<const sim::Snapshot> moments) {
  bool asked = false;
  for (const sim::Snapshot& now : moments) {
    if (!shown.may_have(now.time)) continue;
    asked = true;
    for (int panel = 0; panel < artist.panels(); ++panel)
      if (shows(artist.projection(panel, now), at.local)) return true;
  }
  return !asked;
}

bool stands_still(const draw::Camera& camera) { return camera.follow.empty() && camera.keys.size() <= 1; }

}  // namespace

std::vector<std::string> never_shown(const scene::Scene& scene, const draw::Illustrator& artist,
                                     std::span<const sim::Snapshot> moments) {
  std::vector<std::string> all;
  const auto look = [&](const char* kind, const std::string& words, const draw::Site& at,
                        const draw::Interval& shown) {
    if (at.body < 0 && !is_shown(at, shown, artist, moments))
      all.push_back(fmt::format("the {}{} is never shown: its place is outside of the picture", kind,
                                words.empty() ? "" : " '" + words + "'"));
  };
  for (const draw::Marks::Point& each : scene.film.marks.points)
    look("point", each.label, each.at, each.shown);
  for (const draw::Marks::Label& each : scene.film.marks.labels)
    look("label", each.text, each.at, each.shown);
  return all;
}

std::vector<std::string> never_shown(const scene::Scene& scene) {
  const draw::Marks& marks = scene.film.marks;
  if (marks.points.empty() && marks.labels.empty()) return {};
  if (!std::all_of(scene.cameras.begin(), scene.cameras.end(), stands_still)) return {};
  const auto run = scene.shown_run();
  auto start = run->at({0, 1});
  const sim::Snapshot* now = std::get_if<sim::Snapshot>(&start);
  if (!now) return {};
  // whenever it is shown: what stands there is seen then as now
  sim::Snapshot at_once = *now;
  scene::Scene always = scene;
  for (auto& each : always.film.marks.points) each.shown = {};
  for (auto& each : always.film.marks.labels) each.shown = {};
  return never_shown(always, depictor(scene, {}), std::span(&at_once, 1));
}

}  // namespace obscura::app
