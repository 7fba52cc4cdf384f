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

constexpr double kType = 8.5 * kPoint, kTick = 2.5 * kPoint, kLine = 1.0 * kPoint, kAxis = 0.6 * kPoint;
constexpr double kApart = 10 * kPoint;  // of words at the ends

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

void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list) {
  if (plot.times.size() < 2 || plot.lines.empty()) return;
  double low = 0, high = 0;
  for (const Series& each : plot.lines)
    for (const double value : each.values) low = std::min(low, value), high = std::max(high, value);
  if (!(high > low)) high = low + 1;

  // the values' axis ends at a tick
  std::vector<double> marks = ticks(low, high, int(rect.height / (16 * kPoint)));
  const double step = marks.size() > 1 ? marks[1] - marks[0] : 1;
  while (marks.back() < high - 1e-9 * step) marks.push_back(marks.back() + step);
  while (marks.front() > low + 1e-9 * step) marks.insert(marks.begin(), marks.front() - step);
  low = marks.front(), high = marks.back();

  // room for the numbers at the left, the names at the right
  double numbers = 0, names = 0;
  std::vector<Formula> labels;
  for (const double mark : marks)
    numbers = std::max(numbers, formula(number(mark), kType, colours.ink).width);
  for (const Series& each : plot.lines) {
    labels.push_back(formula(each.label, kType, each.color));
    names = std::max(names, labels.back().width);
  }
  const double left = rect.x + numbers + kTick + 3 * kPoint, right = rect.x + rect.width - names - 5 * kPoint;
  const double top = rect.y + 14 * kPoint, bottom = rect.y + rect.height - 13 * kPoint;
  const double first = plot.times.front(), last = plot.times.back();
  const auto at = [&](double time, double value) {
    return Point(left + (right - left) * (time - first) / (last - first),
                 bottom - (bottom - top) * (value - low) / (high - low));
  };
  const auto line = [&](const Point& a, const Point& b, double width, Color color) {
    list.add({{a, width, color}, {b, width, color}}, Cap::butt);
  };
  const auto write = [&](const std::string& text, const Point& p, double align, Color color) {
    const Formula f = formula(text, kType, color);
    add(f, {p.x() - align * f.width, p.y()}, list);
  };

  // axes: values up, time along zero's line or the bottom
  line({left, top}, {left, bottom + kAxis / 2}, kAxis, colours.ink);
  line({left, bottom}, {right, bottom}, kAxis, colours.ink);
  for (const double mark : marks) {
    const Point p = at(first, mark);
    line(p, p - Point(kTick, 0), kAxis, colours.ink);
    write(number(mark), p + Point(-kTick - 1.5 * kPoint, 0.24 * kType), 1, colours.ink);
  }
  if (low < 0) line(at(first, 0), at(last, 0), 0.3 * kPoint, colours.hatch);
  for (const double mark : ticks(first, last, int((right - left) / (34 * kPoint)))) {
    const Point p{at(mark, low).x(), bottom};
    line(p, p + Point(0, kTick), kAxis, colours.ink);
    write(number(mark), p + Point(0, kTick + 7.5 * kPoint), 0.5, colours.ink);
  }
  write("t / \"s\"", {right + 4 * kPoint, bottom + kTick + 7.5 * kPoint}, 0, colours.ink);
  if (!plot.unit.empty())
    write(plot.unit == "°" ? "\"deg\"" : "\"" + plot.unit + "\"", {left, top - 5 * kPoint}, 0.5, colours.ink);
  for (const double mark : plot.marks)
    if (mark >= first && mark <= last) line(at(mark, low), at(mark, high), 0.3 * kPoint, colours.hatch);

  for (const Series& each : plot.lines) {
    std::vector<Node> nodes;
    for (std::size_t i = 0; i < plot.times.size() && i < each.values.size(); ++i)
      nodes.push_back({at(plot.times[i], each.values[i]), kLine, each.color});
    list.add(nodes, Cap::round);
  }

  // names from the lowest end up, each a line above the last
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  const auto end = [&](std::size_t i) { return at(last, plot.lines[i].values.back()).y(); };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return end(a) > end(b); });
  double above = bottom + kApart;
  for (const std::size_t i : order) {
    const double y = std::min(end(i), above - kApart);
    add(labels[i], {right + 4 * kPoint, y + 0.24 * kType}, list);
    above = y;
  }
}

}  // namespace obscura::draw
