#include "app/run/compared.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/run/origin.h"
#include "app/run/run_marks.h"
#include "app/run/variation.h"
#include "draw/compose/annotate.h"
#include "draw/compose/comparison.h"
#include "draw/page/layout.h"
#include "draw/picture/type.h"
#include "draw/plane/stage.h"

namespace obscura::app {

namespace {

constexpr double kHeaviest = 2;         // of lines in small panels
constexpr double kLeastType = 21;       // page units: em of their words
constexpr double kAcrossInSpace = 1.5;  // a panel's width over its height

// where its `vary` is
[[noreturn]] void refuse(const scene::Scene& scene, std::string message) {
  scene::Complaint it = scene.film.vary_at;
  it.message = std::move(message);
  throw scene::Error({std::move(it)});
}

Variations variations_of(const scene::Scene& scene) {
  try {
    return Variations(scene.film.vary);
  } catch (const UsageError& error) {
    std::string words = error.what();
    if (words.starts_with("--vary ")) words.replace(0, 7, "'vary': ");
    refuse(scene, words);
  }
}

// The scene of a run. What is wrong with a value that varies is told where the scene has it.
scene::Scene varied(const scene::Scene& scene, const Variations& all, std::int64_t i) {
  try {
    return scene.again(all.sets(i, scene.sets));
  } catch (const scene::Error& error) {
    std::vector<scene::Complaint> complaints = error.complaints;
    for (const std::string& set : all.sets(i, {}))
      for (scene::Complaint& each : complaints) {
        if (!is_of(each, set)) continue;
        const std::string message = fmt::format("'vary': {}: {}{}", set, each.message, of_range(set));
        each = scene.film.vary_at, each.message = message;
      }
    throw scene::Error(std::move(complaints));
  }
}

// bodies that a comparison is about take the colour of their run
void colour(const sim::SceneInfo& cast, bool over, draw::Color color, draw::Look& look) {
  look.bodies.resize(cast.bodies.size());
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < cast.bodies.size(); ++i)
    if (!cast.bodies[i].fixed) moving.push_back(i);
  if (!over && moving.size() != 1) return;
  for (const std::size_t i : moving) look.bodies[i].color = color;
}

}  // namespace

void suit_panel(double aspect, double height, scene::Scene& one) {
  // a panel's lines are as heavy as the page's
  const double own = draw::page_weight(double(one.film.width) / one.film.height);
  const double small = height / 1080 * own / draw::page_weight(aspect);
  one.look.weight = std::clamp(1 / small, 1.0, kHeaviest);
  // words in a small panel are still read from the back row
  const double point = draw::film_lettering(one.look.weight * own, one.look.type_scale).point;
  one.look.type_scale *= std::max(1.0, kLeastType / (draw::kAnnotationType * point * height / 1080));
}

std::int64_t runs_of(const scene::Scene& scene) {
  return scene.film.vary.empty() ? 1 : variations_of(scene).size;
}

std::vector<Ahead::Run> compared(const scene::Scene& scene) {
  if (scene.film.vary.empty()) return {};
  if (scene.trajectory)
    throw UsageError(fmt::format("{} is one run, and film.vary films several: --set 'film.vary=\"\"'",
                                 scene.trajectory_file));
  const Variations all = variations_of(scene);
  if (all.size > kMostCompared)
    refuse(scene, fmt::format("'vary': {} runs are more than {}, the most that a film shows; obscura "
                              "sweep takes more",
                              all.size, kMostCompared));
  const std::vector<std::string>& names = scene.film.vary_names;
  if (!names.empty() && std::int64_t(names.size()) != all.size)
    refuse(scene, fmt::format("'vary_names' has {} names for {} runs", names.size(), all.size));

  const bool over = scene.film.over;
  std::vector<Ahead::Run> runs;
  draw::Extent extent = scene.extent;
  double newton = 0;
  for (std::int64_t i = 0; i < all.size; ++i) {
    Ahead::Run run{with_run_marks(varied(scene, all, i)), {}, {}, {}};
    scene::Scene& one = run.scene;
    if (one.dimension() != scene.dimension())
      refuse(scene, "'vary': some of its runs are in the plane, others in space");
    // clock and camera are the film's
    one.duration = scene.duration;
    one.film.speed = scene.film.speed, one.film.fps = scene.film.fps, one.film.shutter = scene.film.shutter;
    one.film.width = scene.film.width, one.film.height = scene.film.height;
    one.film.vary.clear();
    one.look.theme = scene.look.theme;
    if (scene.cameras.size() == 1 && one.cameras.size() > 1) choose_camera(scene.cameras[0].name, one);
    for (int d = 0; d < 3; ++d) {
      extent.low[d] = std::min({extent.low[d], extent.high[d], one.extent.low[d], one.extent.high[d]});
      extent.high[d] = std::max({extent.low[d], extent.high[d], one.extent.low[d], one.extent.high[d]});
    }
    run.look.name =
        names.empty() ? draw::with_decimal_mark(all.words(i), scene.look.decimal) : names[std::size_t(i)];
    run.look.color = draw::compared_paint(int(i), scene.look.theme).outline;
    const sim::SceneInfo cast = one.run()->scene_info();
    colour(cast, over, draw::compared_color(int(i)), one.look);
    const double own = draw::newton(cast);
    if (own > 0 && (newton == 0 || own < newton)) newton = own;
    runs.push_back(std::move(run));
  }

  const double aspect = double(scene.film.width) / scene.film.height;
  const draw::Titles titles = draw::laid_out(scene.film.titles, aspect, scene.look.type_scale);
  double across = kAcrossInSpace;
  if (scene.dimension() == 2) {
    const draw::Fitted world = draw::fitted_world(runs.front().scene.run()->scene_info(), extent);
    const sim::Vec3 size = world.high - world.low;
    across = size.x() / std::max(size.y(), 1e-9);
  }
  const std::vector<draw::Rect> panels = draw::compared_panels(
      int(runs.size()), across, scene.look, scene.film.charts, titles, aspect, scene.film.height);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    scene::Scene& one = runs[i].scene;
    one.extent = extent;
    if (one.look.force_scale == 0) one.look.force_scale = newton;
    if (over) {
      if (i > 0) one.film.marks = {};
      continue;
    }
    runs[i].panel = panels[i];
    const double pixel = 1080.0 / scene.film.height;
    one.film.width = std::max(1, int(std::lround(panels[i].width / pixel)));
    one.film.height = std::max(1, int(std::lround(panels[i].height / pixel)));
    one.look.caption = false;
    suit_panel(aspect, panels[i].height, one);
    one.film.charts.clear(), one.film.titles = {};
  }
  return runs;
}

std::vector<scene::Scene> filmed(const scene::Scene& scene) {
  std::vector<scene::Scene> all;
  for (Ahead::Run& run : compared(scene)) all.push_back(std::move(run.scene));
  if (all.empty()) all.push_back(scene);
  return all;
}

}  // namespace obscura::app
