// A plot. Only the two axes it needs, ticks at 1, 2 or 5 times a power of ten, and words at the ends of the
// lines instead of a key. Words at ends that lie close together are pushed apart.

#include "draw/page/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "draw/page/sheet.h"
#include "draw/picture/formula.h"

namespace obscura::draw {
namespace {

constexpr double kTypeSize = 8.5, kTick = 2.5, kLine = 1.0, kAxis = 0.6;  // points
constexpr double kApart = 10;                                             // of words at the ends
constexpr double kDotRadius = 1.6;
constexpr int kMostDecades = 7;  // with a number each

std::string number(double x) { return fmt::format("{:g}", std::abs(x) < 1e-12 ? 0.0 : x); }

std::string power(int exponent) {
  return exponent == 0 ? "1" : exponent == 1 ? "10" : fmt::format("10^{{{}}}", exponent);
}

/// The ticks of an axis.
struct Ticks {
  std::vector<double> marks;           // with a number
  std::vector<double> between;         // without
  std::vector<std::string> numbers{};  // as mathematics
};

/// At powers of ten; ticks at 2, ..., 9 in between where there are few.
Ticks decades(double low, double high) {
  Ticks all;
  const int first = int(std::floor(std::log10(low) + 1e-9)), last = int(std::ceil(std::log10(high) - 1e-9));
  const int step = (last - first + kMostDecades - 1) / kMostDecades;
  const bool few = last - first <= 2, plain = first >= -2 && last <= 4;
  for (int e = first; e <= last; ++e) {
    for (int digit = 1; digit < 10; ++digit) {
      const double x = digit * std::pow(10, e);
      if (x < low * (1 - 1e-9) || x > high * (1 + 1e-9)) continue;
      const bool told = digit == 1 ? (e - first) % step == 0 : few && plain && (digit == 2 || digit == 5);
      if (told) {
        all.marks.push_back(x);
        all.numbers.push_back(plain ? number(x) : power(e));
      } else if (digit == 1 || step == 1) {
        all.between.push_back(x);
      }
    }
  }
  return all;
}

Ticks numbered(std::vector<double> marks) {
  Ticks all{std::move(marks), {}};
  for (const double mark : all.marks) all.numbers.push_back(number(mark));
  return all;
}

Ticks upward(const PlotArea& area) { return area.log ? decades(area.low, area.high) : numbered(area.ticks); }

const std::vector<double>& along(const Plot& plot, const Series& line) {
  return line.along.empty() ? plot.times : line.along;
}

/// The least and the largest of what is to be seen.
struct Range {
  double low = 1e300, high = -1e300;
  void take(double x) { low = std::min(low, x), high = std::max(high, x); }
};

/// The end of a line: its point farthest to the right.
Point end_of(const Plot& plot, const PlotArea& area, const Series& line) {
  const std::vector<double>& way = along(plot, line);
  Point end(area.left - 1, area.bottom);
  for (std::size_t i = 0; i < way.size() && i < line.values.size(); ++i)
    if (const Point p = area.has(way[i], line.values[i]) ? area.at(way[i], line.values[i]) : end;
        p.x() >= end.x())
      end = p;
  return end;
}

}  // namespace

Point PlotArea::at(double along, double value) const {
  if (log)
    return {left + (right - left) * std::log(along / first) / std::log(last / first),
            bottom - (bottom - top) * std::log(value / low) / std::log(high / low)};
  return {left + (right - left) * (along - first) / (last - first),
          bottom - (bottom - top) * (value - low) / (high - low)};
}

std::vector<double> ticks(double low, double high, int count) {
  std::vector<double> found;
  if (!(high > low)) return {low};
  const double rough = (high - low) / std::max(count, 1), power = std::pow(10, std::floor(std::log10(rough)));
  const double digit = rough / power;
  const double step = power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k)
    found.push_back(k * step);
  return found;
}

PlotArea plot_area(const Plot& plot, const Rect& rect, double point) {
  PlotArea area;
  area.point = point, area.log = plot.log;
  Range across, up;
  if (!plot.log) up.take(0);
  for (const Series& each : plot.lines) {
    const std::vector<double>& way = along(plot, each);
    for (std::size_t i = 0; i < way.size() && i < each.values.size(); ++i)
      if (area.has(way[i], each.values[i])) across.take(way[i]), up.take(each.values[i]);
  }
  if (across.high < across.low) across = {1, 1};
  if (up.high < up.low) up = {1, 1};
  area.first = across.low, area.last = across.high;
  if (!(area.last > area.first)) area.last = plot.log ? 10 * area.first : area.first + 1;

  if (plot.log) {
    // by whole decades
    const double first = std::floor(std::log10(up.low) + 1e-9),
                 last = std::max(first + 1, std::ceil(std::log10(up.high) - 1e-9));
    area.low = std::pow(10, first), area.high = std::pow(10, last);
  } else {
    // the values' axis ends at a tick
    const double low = up.low, high = up.high > up.low ? up.high : up.low + 1;
    std::vector<double>& marks = area.ticks = ticks(low, high, int(rect.height / (16 * point)));
    const double step = marks.size() > 1 ? marks[1] - marks[0] : 1;
    while (marks.back() < high - 1e-9 * step) marks.push_back(marks.back() + step);
    while (marks.front() > low + 1e-9 * step) marks.insert(marks.begin(), marks.front() - step);
    area.low = marks.front(), area.high = marks.back();
  }

  // room for the numbers at the left, the names at the right
  double numbers = 0, names = plot.name == Plot{}.name ? 0 : formula(plot.name, kTypeSize * point, {}).width;
  for (const std::string& each : upward(area).numbers)
    numbers = std::max(numbers, formula(each, kTypeSize * point, {}).width);
  for (const Series& each : plot.lines)
    names = std::max(names, formula(each.label + each.note, kTypeSize * point, each.color).width);
  area.left = rect.x + numbers + kTick * point + 3 * point;
  area.right = rect.x + rect.width - names - 5 * point;
  area.top = rect.y + 14 * point, area.bottom = rect.y + rect.height - 13 * point;

  // names from the lowest end up, each a line above the last
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  const auto end = [&](std::size_t i) { return end_of(plot, area, plot.lines[i]).y(); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return end(a) > end(b); });
  area.names.resize(order.size());
  double above = area.bottom + kApart * point;
  for (const std::size_t i : order) above = area.names[i] = std::min(end(i), above - kApart * point);
  return area;
}

void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double type = kTypeSize * area.point, tick = kTick * area.point, axis = kAxis * area.point;
  const auto line = [&](const Point& a, const Point& b, double width, Color color) {
    list.add({{a, width, color}, {b, width, color}}, Cap::butt);
  };
  const auto write = [&](const std::string& text, const Point& p, double align, Color color) {
    const Formula f = formula(text, type, color);
    add(f, {p.x() - align * f.width, p.y()}, list);
  };

  // values up, time along zero's line or the bottom
  const double left = area.left, right = area.right, bottom = area.bottom;
  line({left, area.top}, {left, bottom + axis / 2}, axis, colours.ink);
  line({left, bottom}, {right, bottom}, axis, colours.ink);
  const Ticks up = upward(area);
  for (std::size_t i = 0; i < up.marks.size(); ++i) {
    const Point p = area.at(area.first, up.marks[i]);
    line(p, p - Point(tick, 0), axis, colours.ink);
    write(up.numbers[i], p + Point(-tick - 1.5 * area.point, 0.24 * type), 1, colours.ink);
  }
  for (const double mark : up.between) {
    const Point p = area.at(area.first, mark);
    line(p, p - Point(0.6 * tick, 0), 0.6 * axis, colours.ink);
  }
  if (area.low < 0) line(area.at(area.first, 0), area.at(area.last, 0), 0.3 * area.point, colours.hatch);
  const Ticks across = area.log
                           ? decades(area.first, area.last)
                           : numbered(ticks(area.first, area.last, int((right - left) / (34 * area.point))));
  for (std::size_t i = 0; i < across.marks.size(); ++i) {
    const Point p{area.at(across.marks[i], area.low).x(), bottom};
    line(p, p + Point(0, tick), axis, colours.ink);
    write(across.numbers[i], p + Point(0, tick + 7.5 * area.point), 0.5, colours.ink);
  }
  for (const double mark : across.between) {
    const Point p{area.at(mark, area.low).x(), bottom};
    line(p, p + Point(0, 0.6 * tick), 0.6 * axis, colours.ink);
  }
  write(plot.name, {right + 4 * area.point, bottom + tick + 7.5 * area.point}, 0, colours.ink);
  if (!plot.unit.empty())
    write(plot.unit == "°" ? "\"deg\"" : "\"" + plot.unit + "\"",
          {left, area.top - (plot.log || !plot.dots.empty() ? 8 : 5) * area.point}, 0.5, colours.ink);
  for (const double mark : plot.marks)
    if (mark >= area.first && mark <= area.last)
      line(area.at(mark, area.low), area.at(mark, area.high), 0.3 * area.point, colours.hatch);
}

void draw_lines(const Plot& plot, const PlotArea& area, List& list) {
  for (const Series& each : plot.lines) {
    const std::vector<double>& way = along(plot, each);
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < way.size() && i < each.values.size(); ++i)
      if (area.has(way[i], each.values[i]))
        nodes.push_back({area.at(way[i], each.values[i]), kLine * area.point, each.color});
    if (!nodes.empty()) list.add(nodes, Cap::round);
    for (const Node& node : nodes)
      if (plot.dotted) list.add(Disc{node.at, kDotRadius * area.point, 0, each.color, each.color});
  }
}

void draw_dots(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double unit = area.point;
  for (const Plot::Dot& dot : plot.dots) {
    const Point p = area.at(dot.along, dot.value);
    list.add(Disc{p, (kDotRadius + 0.6) * unit, 0, colours.ground, colours.ground});
    list.add(Disc{p, kDotRadius * unit, 0, colours.ink, colours.ink});
    // at the right end above it, where the line's name is beside it
    const bool last = p.x() > area.right - 10 * unit;
    const Formula f = formula(dot.label, kTypeSize * unit, colours.ink);
    add(f, p + (last ? Point(-f.width / 2, -5 * unit) : Point(3.5 * unit, -2.5 * unit)), list);
  }
}

void draw_names(const Plot& plot, const PlotArea& area, List& list) {
  // the lowest first
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return area.names[a] > area.names[b]; });
  for (const std::size_t i : order) {
    const Formula name =
        formula(plot.lines[i].label + plot.lines[i].note, kTypeSize * area.point, plot.lines[i].color);
    add(name, {area.right + 4 * area.point, area.names[i] + 0.24 * kTypeSize * area.point}, list);
  }
}

void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list) {
  if (plot.lines.empty() || along(plot, plot.lines.front()).size() < 2) return;
  const PlotArea area = plot_area(plot, rect, kPoint);
  draw_axes(plot, area, colours, list);
  draw_lines(plot, area, list);
  draw_dots(plot, area, colours, list);
  draw_names(plot, area, list);
}

}  // namespace obscura::draw
