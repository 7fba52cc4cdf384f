#include "app/plots.h"

#include <algorithm>

#include "app/interrupt.h"
#include "app/trouble.h"
#include "sim/run.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kPoints = 480;   // of a line
constexpr std::int64_t kPixels = 1920;  // of a line in a film

// what a run gives at one more instant
void add(const sim::Snapshot& now, const draw::Measured& measured, draw::Plot& plot) {
  plot.times.push_back(now.time);
  const std::vector<const draw::Measure*> measures = measured.measures();
  for (std::size_t k = 0; k < measures.size(); ++k)
    plot.lines[k].values.push_back(measures[k]->at(now, measured.body));
}

// the instants of a run that a chart is made of: ends of steps, which cost nothing beside the run; of another
// program's run its rows
std::vector<sim::Rational> beats(const scene::Scene& scene, sim::Rational rate) {
  std::vector<sim::Rational> times;
  if (scene.trajectory) {
    const std::vector<double>& rows = scene.trajectory->times;
    const std::size_t stride = rows.size() / std::size_t(kPixels) + 1;
    for (std::size_t i = 0; i < rows.size(); i += stride)
      if (const auto exact = sim::from_double(rows[i]); exact && *exact <= scene.duration)
        times.push_back(*exact);
    return times;
  }
  const std::int64_t steps = sim::floor(scene.duration * rate), stride = steps / kPixels + 1;
  for (std::int64_t k = 0; k <= steps; k += stride) times.push_back(sim::rational(k) / rate);
  if (times.back() < scene.duration) times.push_back(scene.duration);
  return times;
}

}  // namespace

std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks) {
  const draw::Palette colours = draw::palette(scene.look.theme);
  std::vector<draw::Plot> all;
  for (const draw::Figure::Plot& wanted : scene.figure.plots) {
    draw::Plot plot = draw::empty_plot(wanted, colours);
    plot.marks = marks;

    const auto run = scene.run();
    run->heed(interrupted);
    const sim::Rational stride = (wanted.to - wanted.from) / sim::rational(kPoints);
    for (std::int64_t i = 0; i <= kPoints; ++i) {
      const sim::Rational t = i < kPoints ? wanted.from + sim::rational(i) * stride : wanted.to;
      auto found = run->at(t);
      if (const auto* trouble = std::get_if<sim::Trouble>(&found))
        throw TroubleError(scene.file, *trouble, "");
      if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
      add(std::get<sim::Snapshot>(found), wanted, plot);
    }
    all.push_back(std::move(plot));
  }
  return all;
}

draw::Charts charts(const scene::Scene& scene) {
  const std::vector<draw::Chart>& wanted = scene.film.charts;
  if (wanted.empty()) return {};
  draw::Palette colours = draw::palette(scene.look.theme);
  if (scene.dimension() == 3) colours.ground = colours.room;  // as the page in space
  std::vector<draw::Plot> plots;
  for (const draw::Chart& each : wanted) plots.push_back(draw::empty_plot(each, colours));

  const auto run = scene.run();
  run->heed(interrupted);
  for (const sim::Rational t : beats(scene, run->rate())) {
    const auto found = run->at(t);
    if (std::holds_alternative<sim::Stopped>(found)) throw Interrupted();
    if (std::holds_alternative<sim::Trouble>(found)) break;
    for (std::size_t i = 0; i < wanted.size(); ++i) add(std::get<sim::Snapshot>(found), wanted[i], plots[i]);
  }
  if (plots[0].times.empty()) return {};
  const double aspect = double(scene.film.width) / scene.film.height;
  return {wanted, plots, colours, aspect, sim::value(scene.duration)};
}

}  // namespace obscura::app
