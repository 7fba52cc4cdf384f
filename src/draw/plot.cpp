// A plot. Only the two axes it needs, ticks at 1, 2 or 5 times a power of ten, and words at the ends of the
// lines instead of a key. Where ends lie close together their words are pushed apart.

#include "draw/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "draw/formula.h"
#include "draw/sheet.h"

namespace obscura::draw {
namespace {

constexpr double kType = 8.5, kTick = 2.5, kLine = 1.0, kAxis = 0.6;  // points
constexpr double kApart = 10;                                         // of words at the ends

std::string number(double x) { return fmt::format("{:g}", std::abs(x) < 1e-12 ? 0.0 : x); }

}  // namespace

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
  area.point = point;
  double low = 0, high = 0;
  for (const Series& each : plot.lines)
    for (const double value : each.values) low = std::min(low, value), high = std::max(high, value);
  if (!(high > low)) high = low + 1;

  // the values' axis ends at a tick
  std::vector<double>& marks = area.ticks = ticks(low, high, int(rect.height / (16 * point)));
  const double step = marks.size() > 1 ? marks[1] - marks[0] : 1;
  while (marks.back() < high - 1e-9 * step) marks.push_back(marks.back() + step);
  while (marks.front() > low + 1e-9 * step) marks.insert(marks.begin(), marks.front() - step);
  area.low = marks.front(), area.high = marks.back();
  area.first = plot.times.front(), area.last = plot.times.back();

  // room for the numbers at the left, the names at the right
  double numbers = 0, names = 0;
  for (const double mark : marks) numbers = std::max(numbers, formula(number(mark), kType * point, {}).width);
  for (const Series& each : plot.lines)
    names = std::max(names, formula(each.label, kType * point, each.color).width);
  area.left = rect.x + numbers + kTick * point + 3 * point;
  area.right = rect.x + rect.width - names - 5 * point;
  area.top = rect.y + 14 * point, area.bottom = rect.y + rect.height - 13 * point;

  // names from the lowest end up, each a line above the last
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  const auto end = [&](std::size_t i) { return area.at(area.last, plot.lines[i].values.back()).y(); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return end(a) > end(b); });
  area.names.resize(order.size());
  double above = area.bottom + kApart * point;
  for (const std::size_t i : order) above = area.names[i] = std::min(end(i), above - kApart * point);
  return area;
}

void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double type = kType * area.point, tick = kTick * area.point, axis = kAxis * area.point;
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
  for (const double mark : area.ticks) {
    const Point p = area.at(area.first, mark);
    line(p, p - Point(tick, 0), axis, colours.ink);
    write(number(mark), p + Point(-tick - 1.5 * area.point, 0.24 * type), 1, colours.ink);
  }
  if (area.low < 0) line(area.at(area.first, 0), area.at(area.last, 0), 0.3 * area.point, colours.hatch);
  for (const double mark : ticks(area.first, area.last, int((right - left) / (34 * area.point)))) {
    const Point p{area.at(mark, area.low).x(), bottom};
    line(p, p + Point(0, tick), axis, colours.ink);
    write(number(mark), p + Point(0, tick + 7.5 * area.point), 0.5, colours.ink);
  }
  write("t / \"s\"", {right + 4 * area.point, bottom + tick + 7.5 * area.point}, 0, colours.ink);
  if (!plot.unit.empty())
    write(plot.unit == "°" ? "\"deg\"" : "\"" + plot.unit + "\"", {left, area.top - 5 * area.point}, 0.5,
          colours.ink);
  for (const double mark : plot.marks)
    if (mark >= area.first && mark <= area.last)
      line(area.at(mark, area.low), area.at(mark, area.high), 0.3 * area.point, colours.hatch);
}

void draw_lines(const Plot& plot, const PlotArea& area, List& list) {
  for (const Series& each : plot.lines) {
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < plot.times.size() && i < each.values.size(); ++i)
      nodes.push_back({area.at(plot.times[i], each.values[i]), kLine * area.point, each.color});
    list.add(nodes, Cap::round);
  }
}

void draw_names(const Plot& plot, const PlotArea& area, List& list) {
  // the lowest first
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return area.names[a] > area.names[b]; });
  for (const std::size_t i : order) {
    const Formula name = formula(plot.lines[i].label, kType * area.point, plot.lines[i].color);
    add(name, {area.right + 4 * area.point, area.names[i] + 0.24 * kType * area.point}, list);
  }
}

void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list) {
  if (plot.times.size() < 2 || plot.lines.empty()) return;
  const PlotArea area = plot_area(plot, rect, kPoint);
  draw_axes(plot, area, colours, list);
  draw_lines(plot, area, list);
  draw_names(plot, area, list);
}

}  // namespace obscura::draw
