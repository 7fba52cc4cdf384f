// Charts below the picture lie above each other, the last at the bottom, and reach across the page; those at
// its right are a column, as wide as its widest.

#include "draw/page/chart.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "draw/page/layout.h"
#include "draw/page/line_style.h"
#include "draw/page/names_around.h"
#include "draw/page/plot_names.h"

namespace obscura::draw {
namespace {

constexpr int kMostLines = 1000;    // of a chart, as subjects are counted
constexpr double kAboveAxis = 4.5;  // points: how high above the axis the middle of a name is at least

constexpr double kMargin = 36;  // page units at the weight 1, as of the caption
// page units a point of a plot for print: digits 24 high, to be read from the back row
constexpr double kType = 33 / 8.5;
constexpr double kHead = 2.7, kBeside = 2.2;   // points: its radius; from there to its name
constexpr double kOffAxis = 2, kOverArea = 4;  // points: how far names keep off axes, and reach above them
// of its width: how tall a plot against a quantity is at most at the right, where it would be a strip; of
// what its axis spans: how far it goes on beyond, so that a line does not run along the other axis
constexpr double kTallest = 1.1, kBeyondEnds = 0.05;
constexpr double kAround = 0.8;         // around a head, points
constexpr double kLettersReach = 0.35;  // of a name's height: as far its letters reach from its middle
constexpr double kOffZero = 1;          // points: where the line at zero ends under it
constexpr double kLedWithin = 0.5;      // of a name's height: farther off its head its leader is whole
constexpr double kMarkerAround =
    1.3;                         // the same of a marker with corners, whose edges are nearer to its middle
constexpr double kFade = 0.008;  // of the run: how long before and after a name changes places it is faint
constexpr double kMostUnseen = 0.03;  // of the run: names that are unseen for longer are a key

// The rectangles of charts on a page.
std::vector<Rect> places_of(const std::vector<Chart>& charts, double aspect, double foot) {
  const double width = 1080 * aspect, weight = page_weight(aspect);
  const double margin = kMargin * weight, inset = std::max(margin, 0.045 * width), gap = margin / 2;
  const auto [right, below] = Charts::room(charts, aspect);
  double column = 0;
  for (const Chart& chart : charts) column += chart.place == Chart::Place::right;
  double low = 1080 - below - foot, beside = inset;
  const double each = column > 0 ? (low - inset - margin) / column : 0;
  std::vector<Rect> all;
  for (const Chart& chart : charts) {
    Rect rect;
    if (chart.place == Chart::Place::below) {
      rect = {inset, low, width - 2 * inset, chart.share * 1080 - gap};
      low += chart.share * 1080;
    } else {
      rect = {width - right + gap, beside, right - gap - inset, each - gap};
      beside += each;
      if (const double most = kTallest * rect.width; !chart.against.empty() && rect.height > most)
        rect.y += (rect.height - most) / 2, rect.height = most;
    }
    all.push_back(rect);
  }
  return all;
}

// Lines against a quantity do not run along the other axis.
void widen(PlotArea& area) {
  if (area.log) return;
  const double more = kBeyondEnds * (area.last - area.first);
  if (area.first != 0) area.first -= more;
  if (area.last != 0) area.last += more;
}

// what keeps a head off lines
void draw_halo(const Series& line, const Point& at, double unit, Color ground, List& list) {
  const int marker = marker_of(line.style);
  list.halo(true);
  add_marker(marker, at, (kHead + (marker == 0 ? kAround : kMarkerAround)) * unit, ground, list);
  list.halo(false);
}

// where a line is now: a dot, or the marker along it
void draw_head(const Series& line, const Point& at, double unit, List& list) {
  add_marker(marker_of(line.style), at, kHead * unit, line.color, list);
}

}  // namespace

Charts::Charts(const std::vector<Chart>& charts, const std::vector<Plot>& plots, const Palette& colours,
               double aspect, double seconds, const std::vector<sim::SceneInfo>& casts, double foot,
               double type_scale)
    : colours_(colours), casts_(casts), foot_(foot) {
  std::tie(right_, below_) = room(charts, aspect);
  const std::vector<Rect> rects = places_of(charts, aspect, foot);
  const double usual = kType * page_weight(aspect) * type_scale;
  for (double point = usual; point > kLeastType * usual; point *= kSmaller) {
    lay_out_panels(charts, plots, rects, point, seconds);
    std::vector<const PlotArea*> areas;
    std::vector<const Rect*> places;
    for (std::size_t i = 0; i < panels_.size(); ++i)
      areas.push_back(&panels_[i].area), places.push_back(&rects[i]);
    if (are_wide(areas, places)) break;
  }
}

void Charts::lay_out_panels(const std::vector<Chart>& charts, const std::vector<Plot>& plots,
                            const std::vector<Rect>& rects, double point, double seconds) {
  panels_.clear();
  for (std::size_t i = 0; i < charts.size(); ++i) {
    panels_.push_back({charts[i], plots[i], plot_area(plots[i], rects[i], point), {}, {}, false});
    PlotArea& area = panels_.back().area;
    if (charts[i].against.empty())
      area.last = seconds;
    else
      widen(area);
  }
  for (std::size_t i = 0; i < panels_.size(); ++i) place_names(panels_[i], rects[i], seconds);
  // those above each other show one time at one place
  for (const Chart::Place place : {Chart::Place::below, Chart::Place::right}) {
    std::vector<PlotArea*> areas;
    for (Panel& panel : panels_)
      if (panel.chart.place == place && panel.chart.against.empty()) areas.push_back(&panel.area);
    share_margins(areas);
  }
}

std::pair<double, double> Charts::room(const std::vector<Chart>& charts, double aspect) {
  double right = 0, below = 0;
  for (const Chart& chart : charts) {
    if (chart.place == Chart::Place::below) below += chart.share * 1080;
    if (chart.place == Chart::Place::right) right = std::max(right, chart.share * 1080 * aspect);
  }
  return {right, below};
}

std::vector<double> Charts::axis_heights(const std::vector<Chart>& charts, double aspect, double foot,
                                         double type_scale) {
  const double around = (kPlotAbove + kPlotBelow) * kType * page_weight(aspect) * type_scale;
  std::vector<double> all;
  for (const Rect& rect : places_of(charts, aspect, foot)) all.push_back(rect.height - around);
  return all;
}

std::vector<double> Charts::widths(const std::vector<Chart>& charts, double aspect, double foot) {
  std::vector<double> all;
  for (const Rect& rect : places_of(charts, aspect, foot)) all.push_back(rect.width);
  return all;
}

std::vector<std::vector<Point>> Charts::heads(const Panel& panel) {
  const PlotArea& area = panel.area;
  std::vector<std::vector<Point>> all(panel.plot.times.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (const Series& line : panel.plot.lines) {
      // a run that diverges ends before the others
      const auto value_of = [&](const std::vector<double>& values, double none) {
        return values.empty() ? none : values[std::min(k, values.size() - 1)];
      };
      const double along = panel.chart.against.empty() ? area.first : value_of(line.along, area.first);
      all[k].push_back(area.at(along, std::clamp(value_of(line.values, area.low), area.low, area.high)));
    }
  }
  return all;
}

void Charts::place_names(Panel& panel, const Rect& rect, double seconds) const {
  PlotArea& area = panel.area;
  if (!named(panel.plot) || !area.key.empty()) return;
  const std::vector<std::vector<Point>> ends = heads(panel);
  const double unit = area.point;
  if (panel.chart.against.empty()) {
    std::vector<std::vector<double>> heights(ends.size());
    for (std::size_t k = 0; k < ends.size(); ++k)
      for (const Point& end : ends[k]) heights[k].push_back(end.y());
    const auto [low, high] = room_for_names(area);
    panel.names = names_beside(heights, area.heights, low, high);
    if (panel.unseen() <= kMostUnseen) {
      for (std::size_t i = 0; i < area.heights.size(); ++i)
        for (const double off : panel.names.offsets[i])
          panel.leads = panel.leads || std::abs(off) > kOffLine * area.heights[i];
      if (panel.leads) area.right -= kLeaderRoom * unit;
      return;
    }
    // their places say nothing of whose they are
    area = plot_area(panel.plot, rect, unit, true);
    area.last = seconds;
    panel.names = {};
    return;
  }
  std::vector<Point> sizes;
  for (std::size_t i = 0; i < panel.plot.lines.size(); ++i)
    sizes.emplace_back(width_of_name(panel.plot, i, area), area.heights[i]);
  const double left = area.left + kOffAxis * unit, top = area.top - kOverArea * unit;
  const NamesAround found =
      names_around(ends, sizes, {left, top, rect.x + rect.width - left, area.bottom - kOffAxis * unit - top},
                   (kHead + kBeside) * unit, unit);
  if (!found.clear && panel.plot.lines.size() > 1) {
    // they are in the way wherever they stand
    area = plot_area(panel.plot, rect, unit, true);
    widen(area);
    return;
  }
  panel.around = found.offsets;
  panel.names.changes = found.changes;
}

double Charts::Panel::change(std::size_t line, std::size_t number) const {
  const std::size_t k = names.changes[line][number];
  return 0.5 * (plot.times[k - 1] + plot.times[k]);
}

double Charts::Panel::seen(std::size_t line, double time) const {
  const double fade = kFade * (plot.times.back() - plot.times.front());
  double most = 1;
  if (names.changes.empty()) return most;
  for (std::size_t i = 0; i < names.changes[line].size(); ++i)
    most = std::min(most, std::abs(time - change(line, i)) / fade);
  return most;
}

double Charts::Panel::unseen() const {
  double sum = 0;
  for (std::size_t i = 0; i < names.changes.size(); ++i)
    for (const double time : plot.times) sum += 1 - std::min(1.0, seen(i, time));
  return sum / double(std::max<std::size_t>(1, names.changes.size() * plot.times.size()));
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

double Charts::Panel::led(std::size_t line, double time) const {
  if (!leads) return 0;
  const double u = (std::abs(offset(line, time)) / area.heights[line] - kOffLine) / kLedWithin;
  return std::clamp(u, 0.0, 1.0);
}

Point Charts::Panel::beside(std::size_t line, double time) const {
  const Point right((kHead + kBeside + (leads ? kLeaderRoom : 0)) * area.point, 0);
  if (around.empty()) return right + Point(0, names.offsets.empty() ? 0 : offset(line, time));
  // a side holds from half-way between two of the plot's times, where its name is unseen
  const std::vector<double>& times = plot.times;
  std::size_t k = std::size_t(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  k = std::min(k, times.size() - 1);
  if (k > 0 && time < 0.5 * (times[k - 1] + times[k])) --k;
  return around[line][k];
}

std::vector<Charts::Shown> Charts::shown() const {
  std::vector<Shown> all;
  for (const Panel& panel : panels_) all.push_back({panel.chart, panel.plot, panel.area});
  return all;
}

// the line at zero goes on to the right: under letters it is not drawn
void Charts::end_zero_line(const Panel& panel, std::size_t line, const Point& name, double seen,
                           List& list) const {
  const PlotArea& area = panel.area;
  const double reach = kLettersReach * area.heights[line];
  if (!named(panel.plot) || !(area.low < 0) || std::abs(name.y() - area.at(area.first, 0).y()) >= reach)
    return;
  const double width = width_of_name(panel.plot, line, area), off = kOffZero * area.point;
  Box plate;
  plate.center = name + Point(width / 2, 0), plate.x_axis = {1, 0}, plate.half = {width / 2 + off, reach};
  plate.fill = colours_.ground;
  plate.fill.a = std::uint8_t(std::lround(plate.fill.a * std::clamp(seen, 0.0, 1.0)));
  list.halo(true);
  list.add(plate);
  list.halo(false);
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
    std::vector<double> past_times;  // up to which each line has come
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
      past_times.push_back(n > 0 ? times[std::size_t(n) - 1] : now.time);
      within.push_back((!over_time || now.time <= panel.area.last) &&
                       nows[i / lines.size()].fate == Fate::well);
      if (within.back()) {
        past_times.back() = now.time;
        const Measured::Line& its = lines[i % lines.size()];
        line.values.push_back(its.at(cast, now));
        const auto along = panel.chart.along(its);
        line.along.push_back(along ? along->at(cast, now) : now.time);
      }
      past.lines.push_back(std::move(line));
    }
    const int number = kMostLines * int(&panel - panels_.data());
    obscura::draw::draw_lines(past, panel.area, list, number);
    // of many lines the halos are below all heads, or they would cover what is close
    const bool keyed = !panel.area.key.empty();
    for (std::size_t i = 0; keyed && i < past.lines.size(); ++i) {
      const Series& line = past.lines[i];
      if (line.values.empty() || !within[i] || (panel.plot.range && !panel.area.spans(line.values.back())))
        continue;
      list.of({Subject::What::chart, number + 3 * kMostLines / 4 + int(i)});
      draw_halo(line, panel.area.at(line.along.back(), line.values.back()), panel.area.point, colours_.ground,
                list);
    }
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
      if (within[i] && inside && !keyed && marker_of(line.style) == 0) {
        list.halo(true);
        list.add(Disc{at, (kHead + kAround) * unit, kAround * unit, line.color, colours_.ground});
        list.halo(false);
      } else if (within[i] && inside) {
        if (!keyed) draw_halo(line, at, unit, colours_.ground, list);
        draw_head(line, at, unit, list);
      }
      const double time = past_times[i];
      const Point beside = inside ? panel.beside(i, time) : Point((kHead + kBeside) * unit, 0);
      const double lowest = panel.area.bottom - kAboveAxis * unit;
      const Point name(at.x() + beside.x(), std::min(at.y() + beside.y(), lowest));
      const double seen = inside ? panel.seen(i, time) : 1;
      if (const double led = inside && within[i] ? panel.led(i, time) : 0; led > 0)
        lead_to_name(at + Point(kHead * unit, 0), name, line.color, unit, list, led * seen);
      if (over_time && !keyed) end_zero_line(panel, i, name, seen, list);
      draw_name(panel.plot, i, panel.area, name, colours_, list, seen);
    }
  }
  list.of({});
}

}  // namespace obscura::draw
