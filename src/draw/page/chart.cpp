// Charts below the picture lie above each other, the last at the bottom, and reach across the page; those at
// its right are a column, as wide as its widest.

#include "draw/page/chart.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "draw/page/line_style.h"
#include "draw/page/plot_names.h"

namespace obscura::draw {
namespace {

constexpr int kMostLines = 1000;    // of a chart, as subjects are counted
constexpr double kAboveAxis = 4.5;  // points: how high above the axis the middle of a name is at least

constexpr double kMargin = 36;  // page units at the weight 1, as of the caption
// page units a point of a plot for print: digits 24 high, to be read from the back row
constexpr double kType = 33 / 8.5;
constexpr double kHead = 2.7;  // points
// of its width: how tall a plot against a quantity is at most at the right, where it would be a strip; of
// what its axis spans: how far it goes on beyond, so that a line does not run along the other axis
constexpr double kTallest = 1.1, kBeyondEnds = 0.05;
constexpr double kAround = 0.8;  // around a head, points
constexpr double kMarkerAround =
    1.3;                         // the same of a marker with corners, whose edges are nearer to its middle
constexpr double kFade = 0.008;  // of the run: how long before and after a name changes places it is faint

// where a line is now: a dot, or the marker along it
void draw_head(const Series& line, const Point& at, double unit, Color ground, List& list) {
  const int marker = marker_of(line.style);
  if (marker == 0) {
    list.add(Disc{at, (kHead + kAround) * unit, kAround * unit, line.color, ground});
    return;
  }
  add_marker(marker, at, (kHead + kMarkerAround) * unit, ground, list);
  add_marker(marker, at, kHead * unit, line.color, list);
}

}  // namespace

Charts::Charts(const std::vector<Chart>& charts, const std::vector<Plot>& plots, const Palette& colours,
               double aspect, double seconds, const std::vector<sim::SceneInfo>& casts, double foot,
               double type_scale)
    : colours_(colours), casts_(casts), foot_(foot) {
  const double width = 1080 * aspect, weight = std::min(1.0, std::sqrt(width / 1440));
  const double margin = kMargin * weight, inset = std::max(margin, 0.045 * width);
  double column = 0;
  for (const Chart& chart : charts) column += chart.place == Chart::Place::right;
  std::tie(right_, below_) = room(charts, aspect);
  const double gap = margin / 2;
  double low = 1080 - below(), beside = inset;
  const double each = column > 0 ? (1080 - below() - inset - margin) / column : 0;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    Rect rect;
    if (charts[i].place == Chart::Place::below) {
      rect = {inset, low, width - 2 * inset, charts[i].share * 1080 - gap};
      low += charts[i].share * 1080;
    } else {
      rect = {width - right_ + gap, beside, right_ - gap - inset, each - gap};
      beside += each;
      if (const double most = kTallest * rect.width; !charts[i].against.empty() && rect.height > most)
        rect.y += (rect.height - most) / 2, rect.height = most;
    }
    panels_.push_back({charts[i], plots[i], plot_area(plots[i], rect, kType * weight * type_scale), {}});
    PlotArea& area = panels_.back().area;
    if (charts[i].against.empty()) {
      area.last = seconds;
    } else if (!area.log) {
      const double more = kBeyondEnds * (area.last - area.first);
      if (area.first != 0) area.first -= more;
      if (area.last != 0) area.last += more;
    }
  }
  // those above each other show one time at one place
  for (const Chart::Place place : {Chart::Place::below, Chart::Place::right}) {
    std::vector<PlotArea*> areas;
    for (Panel& panel : panels_)
      if (panel.chart.place == place && panel.chart.against.empty()) areas.push_back(&panel.area);
    share_margins(areas);
  }
  for (Panel& panel : panels_) place_names(panel);
}

std::pair<double, double> Charts::room(const std::vector<Chart>& charts, double aspect) {
  double right = 0, below = 0;
  for (const Chart& chart : charts) {
    if (chart.place == Chart::Place::below) below += chart.share * 1080;
    if (chart.place == Chart::Place::right) right = std::max(right, chart.share * 1080 * aspect);
  }
  return {right, below};
}

void Charts::place_names(Panel& panel) const {
  const PlotArea& area = panel.area;
  std::vector<std::vector<double>> heads(panel.plot.times.size());
  for (std::size_t k = 0; k < heads.size(); ++k) {
    for (const Series& line : panel.plot.lines) {
      // a run that diverges ends before the others
      const std::vector<double>& all = line.values;
      const double value = all.empty() ? area.low : all[std::min(k, all.size() - 1)];
      heads[k].push_back(area.at(area.first, std::clamp(value, area.low, area.high)).y());
    }
  }
  const auto [low, high] = room_for_names(area);
  panel.names = names_beside(heads, area.heights, low, high);
}

double Charts::Panel::change(std::size_t line, std::size_t number) const {
  const std::size_t k = names.changes[line][number];
  return 0.5 * (plot.times[k - 1] + plot.times[k]);
}

double Charts::Panel::seen(std::size_t line, double time) const {
  const double fade = kFade * (area.last - area.first);
  double most = 1;
  for (std::size_t i = 0; i < names.changes[line].size(); ++i)
    most = std::min(most, std::abs(time - change(line, i)) / fade);
  return most;
}

double Charts::Panel::offset(std::size_t line, double time) const {
  const std::vector<double>& times = plot.times;
  const std::vector<double>& all = names.offsets[line];
  const auto next = std::size_t(std::lower_bound(times.begin(), times.end(), time) - times.begin());
  if (all.empty()) return 0;
  if (next == 0 || next >= all.size()) return next == 0 ? all.front() : all.back();
  const double u = (time - times[next - 1]) / (times[next] - times[next - 1]);
  // not across a change of places
  for (std::size_t i = 0; i < names.changes[line].size(); ++i) {
    if (names.changes[line][i] == next) return time < change(line, i) ? all[next - 1] : all[next];
  }
  return all[next - 1] + u * (all[next] - all[next - 1]);
}

std::vector<Charts::Shown> Charts::shown() const {
  std::vector<Shown> all;
  for (const Panel& panel : panels_) all.push_back({panel.chart, panel.plot, panel.area});
  return all;
}

void Charts::draw_still(List& list) const {
  for (const Panel& panel : panels_) draw_axes(panel.plot, panel.area, colours_, list);
}

void Charts::draw_lines(const std::vector<RunInstant>& nows, List& list) const {
  for (const Panel& panel : panels_) {
    const auto& times = panel.plot.times;
    const bool over_time = panel.chart.against.empty();
    const std::vector<Measured::Line> lines = panel.chart.lines();
    Plot past;
    past.range = panel.plot.range;
    past.lines.reserve(panel.plot.lines.size());
    std::vector<char> within;
    for (std::size_t i = 0; i < panel.plot.lines.size(); ++i) {
      const sim::Snapshot& now = *nows[i / lines.size()].now;
      const sim::SceneInfo& cast = casts_[i / lines.size()];
      const Series& all = panel.plot.lines[i];
      const auto gone = std::size_t(std::lower_bound(times.begin(), times.end(), now.time) - times.begin());
      const auto n = std::ptrdiff_t(std::min(gone, all.values.size()));
      Series line{all.label,  {all.values.begin(), all.values.begin() + n},
                  all.color,  {},
                  all.note,   all.style,
                  all.weight, all.quiet};
      const std::vector<double>& way = all.along.empty() ? times : all.along;
      line.along.assign(way.begin(), way.begin() + n);
      within.push_back((!over_time || now.time <= panel.area.last) &&
                       nows[i / lines.size()].fate == Fate::well);
      if (within.back()) {
        const Measured::Line& its = lines[i % lines.size()];
        line.values.push_back(its.at(cast, now));
        const auto along = panel.chart.along(its);
        line.along.push_back(along ? along->at(cast, now) : now.time);
      }
      past.lines.push_back(std::move(line));
    }
    const int number = kMostLines * int(&panel - panels_.data());
    obscura::draw::draw_lines(past, panel.area, list, number);
    for (const std::size_t i : painters_order(past)) {
      const Series& line = past.lines[i];
      if (line.values.empty()) continue;
      // the name of a line that has left the range stays where it left
      std::size_t last = line.values.size() - 1;
      if (panel.plot.range)
        while (last > 0 && !panel.area.spans(line.values[last])) --last;
      const bool inside = last + 1 == line.values.size();
      const Point at = panel.area.at(line.along[last], line.values[last]);
      const double unit = panel.area.point;
      // a subject of its own: the markers along the line become more
      list.of({Subject::What::chart, number + kMostLines / 2 + int(i)});
      if (within[i] && inside) draw_head(line, at, unit, colours_.ground, list);
      const bool placed = over_time && inside;
      const double high = at.y() + (placed ? panel.offset(i, line.along.back()) : 0);
      draw_name(panel.plot, i, panel.area,
                {at.x() + (kHead + 2.2) * unit, std::min(high, panel.area.bottom - kAboveAxis * unit)},
                colours_, list, placed ? panel.seen(i, line.along.back()) : 1);
    }
  }
  list.of({});
}

}  // namespace obscura::draw
