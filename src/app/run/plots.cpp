#include "app/run/plots.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>

#include <fmt/format.h>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/plot_points.h"
#include "app/run/simulation.h"
#include "app/run/variation.h"
#include "draw/page/measure.h"
#include "draw/plane/stage.h"
#include "scene/table.h"
#include "sim/step/run.h"

namespace obscura::app {

namespace {

constexpr std::int64_t kPoints = 480;  // of a line
constexpr std::int64_t kFewSteps = 4;  // fewer steps than points by so much: steps are shown

// the same scene with more set
scene::Scene with(const scene::Scene& scene, const std::vector<std::string>& more) {
  if (scene.file == "-") throw UsageError("a plot over a key reads its scene more than once: name a file");
  std::vector<std::string> sets = scene.sets;
  sets.insert(sets.end(), more.begin(), more.end());
  return scene::read(scene.file, sets);
}

// the values of what is plotted at the end of a run
std::vector<double> ends(const scene::Scene& scene, const draw::Figure::Plot& wanted) {
  const auto run = scene.shown_run();
  run->heed(interrupted);
  const sim::Snapshot now = moment(*run, wanted.to, scene);
  std::vector<double> found;
  for (const draw::Measured::Line& each : wanted.lines()) found.push_back(each.at(run->scene_info(), now));
  return found;
}

// the exponent p of y = c x^p that fits best; none of less than two places
std::optional<double> slope(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    const double a = std::log(x[i]), b = std::log(y[i]);
    n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  const double spread = n * sxx - sx * sx;
  if (n < 2 || !(spread > 0)) return std::nullopt;
  return (n * sxy - sx * sy) / spread;
}

// a point for each value of a key: the end of its run, or how far that is from another's
void plot_over(const scene::Scene& scene, const draw::Figure::Plot& wanted, draw::Plot& plot) {
  std::vector<double> truth(plot.lines.size(), 0);
  if (!wanted.reference.empty()) {
    std::vector<std::string> sets;
    std::string_view rest = wanted.reference;
    while (!rest.empty()) {
      const auto end = std::min(rest.find(';'), rest.size());
      std::string_view set = rest.substr(0, end);
      set.remove_prefix(std::min(set.find_first_not_of(' '), set.size()));
      sets.emplace_back(set);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    truth = ends(with(scene, sets), wanted);
  }
  const Variation over(wanted.over);
  for (const std::string& value : over.values) {
    const std::vector<double> found = ends(with(scene, {over.path + "=" + value}), wanted);
    for (std::size_t k = 0; k < plot.lines.size(); ++k) {
      plot.lines[k].along.push_back(over.number(value));
      plot.lines[k].values.push_back(wanted.reference.empty() ? found[k] : std::abs(found[k] - truth[k]));
    }
  }
  plot.name = draw::over_unit(over.symbol(), scene::unit_of(over.path));
  if (const auto measures = wanted.measures(); !wanted.reference.empty() && !measures.empty())
    plot.title = draw::over_unit(std::string("\"error of\" ") + measures[0]->label, measures[0]->unit);
  plot.dotted = true;
  if (!wanted.reference.empty()) plot.negligible = 0;
  if (!wanted.log) return;
  for (draw::Series& line : plot.lines) {
    const std::optional<double> exponent = slope(line.along, line.values);
    if (!exponent) continue;
    const bool falls = *exponent <= -0.005;  // as it is rounded
    line.note = fmt::format("\", slope {}{:.2f}\"", falls ? "\u2212" : "", std::abs(*exponent));
  }
}

// the instants of several panels, by their letters
void point_out(const std::vector<double>& marks, draw::Plot& plot) {
  for (std::size_t m = 0; m < marks.size() && marks.size() > 1; ++m) {
    const auto far = [&](double t) { return std::abs(t - marks[m]); };
    const auto at = std::size_t(std::min_element(plot.times.begin(), plot.times.end(),
                                                 [&](double a, double b) { return far(a) < far(b); }) -
                                plot.times.begin());
    for (const draw::Series& line : plot.lines)
      plot.dots.push_back(
          {line.along[at], line.values[at], fmt::format("\"({})\"", char('a' + int(m) % 26))});
  }
}

}  // namespace

std::vector<draw::Plot> plots(const scene::Scene& scene, const std::vector<double>& marks) {
  const draw::Palette colours = draw::palette(scene.look.theme);
  const draw::Illustrator artist = depictor(scene, {});
  const auto line_color = [&](int body) { return artist.line_color(body); };
  const auto called = [&](int body) { return artist.called(body); };
  const auto quiet = [&](int body) { return is_quiet(artist.look(), body); };
  std::vector<draw::Plot> all;
  for (const draw::Figure::Plot& wanted : scene.figure.plots) {
    draw::Plot plot = draw::empty_plot(wanted, colours, artist.scene_info(), line_color, called, quiet);
    plot.log = wanted.log;
    if (!wanted.over.empty()) {
      plot_over(scene, wanted, plot);
      all.push_back(std::move(plot));
      continue;
    }

    const std::vector<draw::Measured::Line> lines = wanted.lines();
    const draw::Plot empty = plot;
    // the values at some instants, the last at the end; whether anything touched then
    const auto draw_at = [&](std::int64_t many, const std::function<sim::Rational(std::int64_t)>& instant) {
      const auto run = scene.shown_run();
      run->heed(interrupted);
      bool touched = false;
      plot = empty;
      draw::Plot looks = empty;
      const std::int64_t steps = sim::floor((wanted.to - wanted.from) * run->rate()),
                         stride = steps / kLooks + 1;
      std::int64_t look = sim::ceil(wanted.from * run->rate()) + 1;
      for (std::int64_t i = 0; i <= many; ++i) {
        const sim::Rational t = i < many ? instant(i) : wanted.to;
        // ends of steps on the way; another program's run has its rows alone
        for (; i > 0 && !scene.trajectory && sim::rational(look) / run->rate() < t; look += stride)
          add_values(run->scene_info(), moment(*run, sim::rational(look) / run->rate(), scene), wanted, lines,
                     looks);
        const sim::Snapshot now = moment(*run, t, scene);
        touched = touched || !now.contacts.empty();
        add_values(run->scene_info(), now, wanted, lines, plot);
      }
      refine(looks, plot);
      return touched;
    };
    // few steps that nothing interrupts go from step to step: parts of steps, which a scheme of low order
    // takes otherwise, would be kinks between them
    const sim::Rational rate = scene.shown_run()->rate();
    const std::int64_t before = sim::floor(wanted.from * rate), last = sim::ceil(wanted.to * rate);
    // those of the handout's collisions are taken as they are: parts of them bounce otherwise
    const bool handout = std::visit(
        [](const auto& world) { return world.model.collision == sim::Collision::handout; }, scene.world);
    const bool few = last - before <= kPoints / kFewSteps;
    const std::int64_t apart = handout ? (last - before) / kPoints + 1 : 1;
    const auto steps = [&] {
      return draw_at((last - before + apart - 1) / apart, [&](std::int64_t i) {
        return i == 0 ? wanted.from : sim::rational(before + i * apart) / rate;
      });
    };
    if (handout) {
      steps();
    } else if (!few || steps()) {
      const sim::Rational stride = (wanted.to - wanted.from) / sim::rational(kPoints);
      draw_at(kPoints, [&](std::int64_t i) { return wanted.from + sim::rational(i) * stride; });
    }
    // variants of a scene are put into one plot, each with the instants of its own run
    for (draw::Series& line : plot.lines)
      if (line.along.empty()) line.along = plot.times;
    if (wanted.against.empty())
      plot.marks = marks;
    else
      point_out(marks, plot);
    all.push_back(std::move(plot));
  }
  return all;
}

}  // namespace obscura::app
