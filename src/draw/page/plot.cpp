// A plot. Only the two axes it needs, ticks at 1, 2 or 5 times a power of ten, and words at the ends of the
// lines instead of a key where there is room for them. Words at ends that lie close together are pushed
// apart. Lines differ in their dashes and markers, so that they can be told apart in grey.

#include "draw/page/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "draw/page/line_style.h"
#include "draw/page/plot_names.h"
#include "draw/page/sheet.h"
#include "draw/picture/formula.h"
#include "draw/picture/formula_values.h"

namespace obscura::draw {
namespace {

constexpr double kTick = 2.5, kAxis = 0.6;  // points
constexpr double kDotRadius = 1.6;
constexpr double kAcross = 34, kNumbersApart = 4;  // points: from tick to tick, between numbers at least
constexpr double kHeadroom = 0.05;                 // of the range of the values: room above and below it
constexpr double kFromZero = 0.4;   // of the largest value: what changes by less is shown without zero
constexpr double kConstant = 1e-3;  // and what changes by less than this with it

constexpr double kLeastWidth = 0.4;  // of its rectangle's: that of an axis

constexpr double kTicksApart = 9;  // points: from a number of the values' axis to the next at least
constexpr double kTwoApart = 6.5;  // the same where there are two: their digits do not touch
constexpr int kMostSteps = 20;     // of an axis: that are looked at for two numbers
constexpr double kEachTick = 18;   // points: of the values' axis
constexpr double kAboveEnd = 3;    // points: how high above the axis the middle of a name at an end is
constexpr double kBesideEnd = 4;   // points: from an end to its name
constexpr double kLeft = 0.05;  // of the width: a line that ends so far from the right is named where it ends
constexpr int kMostDecades = 7;  // with a number each
constexpr double kToName = 5;    // points: from the last number below the axis to what it is over

std::string power(int exponent) {
  return exponent == 0 ? "1" : exponent == 1 ? "10" : fmt::format("10^{{{}}}", exponent);
}

/// The ticks of an axis.
struct Ticks {
  std::vector<double> marks;           // with a number
  std::vector<double> between;         // without
  std::vector<std::string> numbers{};  // as mathematics
};

/// At powers of ten; ticks at 2, ..., 9 in between where there are few, and of these the first and the last
/// with numbers where there would be less than two. `apart`: of numbers, of the axis's length.
Ticks decades(double low, double high, double apart) {
  Ticks all;
  const int first = int(std::floor(std::log10(low) + 1e-9)), last = int(std::ceil(std::log10(high) - 1e-9));
  const double decade = 1 / std::log10(high / low);
  int step = (last - first + kMostDecades - 1) / kMostDecades;
  while (step * decade < apart && step <= last - first) ++step;
  const bool plain = first >= -2 && last <= 4;
  const bool few = last - first <= 2 && decade * std::log10(2) >= apart;
  for (int e = first; e <= last; ++e) {
    for (int digit = 1; digit < 10; ++digit) {
      const double x = digit * std::pow(10, e);
      if (x < low * (1 - 1e-9) || x > high * (1 + 1e-9)) continue;
      const bool told = digit == 1 ? (e - first) % step == 0 : few && plain && (digit == 2 || digit == 5);
      if (told) {
        all.marks.push_back(x);
        all.numbers.push_back(plain ? as_number(x) : power(e));
      } else if (digit == 1 || step == 1) {
        all.between.push_back(x);
      }
    }
  }
  std::vector<double> round = all.marks;
  round.insert(round.end(), all.between.begin(), all.between.end());
  std::sort(round.begin(), round.end());
  if (all.marks.size() > 1 || round.size() < 2 || decade * std::log10(round.back() / round.front()) < apart)
    return all;
  all.marks = {round.front(), round.back()}, all.between = {round.begin() + 1, round.end() - 1};
  all.numbers = as_numbers(all.marks);
  return all;
}

Ticks numbered(std::vector<double> marks) {
  Ticks all{std::move(marks), {}};
  all.numbers = as_numbers(all.marks);
  return all;
}

double widest(const Ticks& ticks, double point) {
  double all = 0;
  for (const std::string& each : ticks.numbers)
    all = std::max(all, formula(each, kPlotType * point, {}).width);
  return all;
}

/// Two round numbers for an axis that has room for no more: zero and another, or two far from each other, of
/// the coarsest steps at which they find room; one where none do. `fit`: whether two numbers do.
std::vector<double> two_of(double low, double high,
                           const std::function<bool(const std::vector<double>&)>& fit) {
  const auto is_zero = [&](double x) { return std::abs(x) < 1e-9 * (high - low); };
  for (int steps = 1; steps <= kMostSteps; ++steps) {
    const std::vector<double> all = ticks(low, high, steps);
    if (all.size() < 2) continue;
    const double first = all.front(), last = all.back();
    const bool zero = std::any_of(all.begin(), all.end(), is_zero);
    const std::vector<double> from_zero = last >= -first ? std::vector{0.0, last} : std::vector{first, 0.0};
    if (zero && fit(from_zero)) return from_zero;
    if (fit({first, last})) return {first, last};
  }
  const bool zero = low <= 0 && high >= 0;
  return {zero ? 0.0 : ticks(low, high, 1).front()};
}

/// Those of an axis of this width, in page units: three at least where their numbers find room, and fewer
/// where they do not.
Ticks along_axis(double low, double high, double width, double point) {
  const auto fit = [&](const Ticks& all) {
    if (all.marks.size() < 2) return true;
    return (all.marks[1] - all.marks[0]) / (high - low) * width > widest(all, point) + kNumbersApart * point;
  };
  const int usual = std::max(2, int(width / (kAcross * point)));
  Ticks few = numbered(ticks(low, high, usual));
  for (int count = usual; few.marks.size() < 3 && count < usual + 6; ++count) {
    const Ticks more = numbered(ticks(low, high, count));
    if (more.marks.size() < 3) continue;
    if (fit(more)) return more;
    break;
  }
  for (int count = usual; count > 1 && !fit(few); --count) few = numbered(ticks(low, high, count - 1));
  if (few.marks.size() > 1 && fit(few)) return few;
  return numbered(two_of(low, high, [&](const std::vector<double>& both) { return fit(numbered(both)); }));
}

/// Those of the values from `low` to `high` on an axis of this height: so few that their numbers do not
/// touch.
std::vector<double> up_axis(double low, double high, int usual, double height, double point) {
  for (int count = usual; count > 0; --count) {
    std::vector<double> found = ticks(low, high, count);
    if (found.size() > 1 && (found[1] - found[0]) / (high - low) * height >= kTicksApart * point)
      return found;
  }
  return two_of(low, high, [&](const std::vector<double>& both) {
    return (both[1] - both[0]) / (high - low) * height >= kTwoApart * point;
  });
}

Ticks upward(const PlotArea& area) {
  return area.log ? decades(area.low, area.high, kTicksApart * area.point / (area.bottom - area.top))
                  : numbered(area.ticks);
}

Ticks across_axis(const PlotArea& area) {
  const double width = area.right - area.left;
  if (!area.log) return along_axis(area.first, area.last, width, area.point);
  const Ticks all = decades(area.first, area.last, 0);
  return decades(area.first, area.last, (widest(all, area.point) + kNumbersApart * area.point) / width);
}

/// How far the numbers below the axis reach to the right, or the axis does.
double reach_of(const PlotArea& area, const Ticks& ticks) {
  double reached = area.right;
  for (std::size_t i = 0; i < ticks.marks.size(); ++i)
    reached = std::max(reached, area.at(ticks.marks[i], area.low).x() +
                                    formula(ticks.numbers[i], kPlotType * area.point, {}).width / 2);
  return reached;
}

const std::vector<double>& along(const Plot& plot, const Series& line) {
  return line.along.empty() ? plot.times : line.along;
}

/// The least and the largest of what is to be seen.
struct Range {
  double low = 1e300, high = -1e300;
  void take(double x) { low = std::min(low, x), high = std::max(high, x); }
};

/// The end of a line: its point farthest to the right, of those within the range that is given.
Point end_of(const Plot& plot, const PlotArea& area, const Series& line) {
  const std::vector<double>& way = along(plot, line);
  Point end(area.left - 1, area.bottom);
  for (std::size_t i = 0; i < way.size() && i < line.values.size(); ++i) {
    if (!area.has(way[i], line.values[i]) || (plot.range && !area.spans(line.values[i]))) continue;
    if (const Point p = area.at(way[i], line.values[i]); p.x() >= end.x()) end = p;
  }
  return end;
}

/// Whether a line ends at the right side, where its name is.
bool comes_to_its_name(const PlotArea& area, const Point& end) {
  return end.x() >= area.right - kLeft * (area.right - area.left);
}

/// Whether it ends far from there, where its name would be looked for in vain.
bool leaves(const Plot& plot, const PlotArea& area, const Point& end) {
  return plot.range && !comes_to_its_name(area, end);
}

/// Whether names at the right would not be beside their lines, which go anywhere and end elsewhere.
bool stray(const Plot& plot, const PlotArea& area) {
  if (!named(plot) || plot.lines.size() < 2) return false;
  return std::any_of(plot.lines.begin(), plot.lines.end(), [&](const Series& line) {
    const Point end = end_of(plot, area, line);
    const bool cut_off = plot.range && end.y() < area.top + kNamesApart * area.point;
    return !line.along.empty() && !cut_off && !comes_to_its_name(area, end);
  });
}

/// Where names stand far off the ends of their lines they get leaders, and room for these.
void lead_names(const Plot& plot, PlotArea& area) {
  if (!named(plot) || !area.key.empty()) return;
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    const Point end = end_of(plot, area, plot.lines[i]);
    if (comes_to_its_name(area, end))
      area.led = area.led || std::abs(area.names[i] - end.y()) > kOffLine * area.heights[i];
  }
  if (area.led) area.right -= kLeaderRoom * area.point;
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

std::string over_unit(const std::string& name, const std::string& unit) {
  if (unit.empty()) return name;
  const auto upright = [](const std::string& words) { return "\"" + words + "\""; };
  if (unit == "°") return name + " / " + upright("deg");
  const auto slash = unit.find('/');
  if (slash == unit.npos) return name + " / " + upright(unit);
  std::string over = unit.substr(0, slash), under = unit.substr(slash + 1), power = "-1";
  for (const std::string_view square : {"²", "^2"})
    if (under.ends_with(square)) under.resize(under.size() - square.size()), power = "-2";
  if (over == "1") over.clear();
  return name + " / " + upright((over.empty() ? "" : over + " ") + under) + "^{" + power + "}";
}

void tell_apart(Plot& plot) {
  for (std::size_t i = 0; i < plot.lines.size(); ++i) plot.lines[i].style = int(i);
}

std::vector<std::size_t> painters_order(const Plot& plot) {
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return plot.lines[i].quiet; });
  return order;
}

void share_margins(std::span<PlotArea*> areas) {
  double left = -1e300, right = 1e300;
  for (const PlotArea* area : areas) left = std::max(left, area->left), right = std::min(right, area->right);
  for (PlotArea* area : areas) {
    for (Point& entry : area->key) entry.x() += std::min(left - area->left, area->key_room);
    area->left = left, area->right = right;
  }
}

bool are_wide(std::span<const PlotArea* const> areas, std::span<const Rect* const> rects) {
  for (std::size_t i = 0; i < areas.size(); ++i)
    if (areas[i]->right - areas[i]->left < kLeastWidth * rects[i]->width) return false;
  return true;
}

PlotArea plot_area(const Plot& plot, const Rect& rect, double point, bool keyed) {
  PlotArea area;
  area.point = point, area.log = plot.log;
  Range across, up;
  for (const Series& each : plot.lines) {
    const std::vector<double>& way = along(plot, each);
    for (std::size_t i = 0; i < way.size() && i < each.values.size(); ++i)
      if (area.has(way[i], each.values[i])) across.take(way[i]), up.take(each.values[i]);
  }
  if (across.high < across.low) across = {1, 1};
  if (up.high < up.low) up = {1, 1};
  area.first = across.low, area.last = across.high;
  if (!(area.last > area.first) && !plot.dotted) area.last = plot.log ? 10 * area.first : area.first + 1;
  if (!(area.last > area.first)) {
    // the one point is in the middle
    const double around = area.first == 0 ? 1 : 0.5 * std::abs(area.first), only = area.first;
    area.first = plot.log ? only / 3 : only - around, area.last = plot.log ? 3 * only : only + around;
  }

  if (plot.range && (!plot.log || plot.range->first > 0)) {
    area.low = plot.range->first, area.high = plot.range->second;
  } else if (plot.log) {
    // by whole decades
    const double first = std::floor(std::log10(up.low) + 1e-9),
                 last = std::max(first + 1, std::ceil(std::log10(up.high) - 1e-9));
    area.low = std::pow(10, first), area.high = std::pow(10, last);
  } else {
    if (std::max(std::abs(up.low), std::abs(up.high)) <= plot.negligible) up = {0, 0};
    const double most = std::max(std::abs(up.low), std::abs(up.high)), range = up.high - up.low;
    const bool constant = plot.placed ? range <= plot.negligible : range < kConstant * most;
    if (range > kFromZero * most || constant || !(most > 0)) up.take(0);
    // a line along zero is not on the axis
    if (!(up.high > up.low)) up = {-1, 1};
    // a little room around what is there; none below zero if nothing is
    const double room = kHeadroom * (up.high - up.low);
    area.low = up.low == 0 ? 0 : up.low - room, area.high = up.high == 0 ? 0 : up.high + room;
  }

  // exponents and fractions of the title stay below the upper edge
  const Formula title = formula(plot.title, kPlotType * point, {});
  area.top = rect.y + std::max(kPlotAbove * point, kTitleBaseline * point + title.ascent + 0.5 * point);
  area.bottom = rect.y + rect.height - kPlotBelow * point;
  area.title = area.top - kTitleBaseline * point;
  fit_names(plot, rect, rect.x + title.width, area, keyed);
  if (!area.log) {
    const int usual = std::max(
        2, int((rect.height - (area.top - area.title - kTitleBaseline * point)) / (kEachTick * point)));
    area.ticks = up_axis(area.low, area.high, usual, area.bottom - area.top, point);
  }

  // room for the numbers at the left, the names at the right
  const double numbers = widest(upward(area), point);
  double names = widest_name(plot, area) + 5 * point;
  // what it is over, right of the last number, which stands out by half of itself
  const double over = formula(plot.name, kPlotType * point, {}).width;
  names = std::max(names, over + 12 * point);
  area.left = rect.x + numbers + kTick * point + 3 * point;
  area.right = rect.x + rect.width - names;
  const double beyond = reach_of(area, across_axis(area)) + kToName * point + over - rect.x - rect.width;
  if (beyond > 0) area.right -= beyond;

  // the names at the right end; those of lines that leave the range stand where they do
  std::vector<double> ends;
  std::vector<std::size_t> there;
  area.names.assign(plot.lines.size(), area.top + kNamesApart / 2 * point);
  std::vector<double> heights;
  for (std::size_t i = 0; i < plot.lines.size(); ++i)
    if (const Point end = end_of(plot, area, plot.lines[i]); !leaves(plot, area, end))
      ends.push_back(end.y()), there.push_back(i), heights.push_back(area.heights[i]);
  const double half = kNamesApart / 2 * point;
  const std::vector<double> middles =
      spread(ends, heights, area.top - half, area.bottom - kAboveEnd * point + half, by_height(ends));
  for (std::size_t i = 0; i < there.size(); ++i) area.names[there[i]] = middles[i];
  return area;
}

void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double type = kPlotType * area.point, tick = kTick * area.point, axis = kAxis * area.point;
  const auto line = [&](const Point& a, const Point& b, double width, Color color) {
    list.add({{a, width, color}, {b, width, color}}, Cap::butt);
  };
  const auto write = [&](const std::string& text, const Point& p, double align, Color color) {
    const Formula f = formula(text, type, color);
    add(f, {p.x() - align * f.width, p.y()}, list,
        {align > 0.9   ? Align::right
         : align > 0.1 ? Align::center
                       : Align::left});
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
  const Ticks along = across_axis(area);
  for (std::size_t i = 0; i < along.marks.size(); ++i) {
    const Point p{area.at(along.marks[i], area.low).x(), bottom};
    line(p, p + Point(0, tick), axis, colours.ink);
    write(along.numbers[i], p + Point(0, tick + 7.5 * area.point), 0.5, colours.ink);
  }
  for (const double mark : along.between) {
    const Point p{area.at(mark, area.low).x(), bottom};
    line(p, p + Point(0, 0.6 * tick), 0.6 * axis, colours.ink);
  }
  write(plot.name, {reach_of(area, along) + kToName * area.point, bottom + tick + 7.5 * area.point}, 0,
        colours.ink);
  // from where the widest number begins
  write(plot.title, {left - tick - 1.5 * area.point - widest(up, area.point), area.title}, 0, colours.ink);
  draw_key(plot, area, colours, list);
  for (const double mark : plot.marks)
    if (mark >= area.first && mark <= area.last)
      line(area.at(mark, area.low), area.at(mark, area.high), 0.3 * area.point, colours.hatch);
}

void draw_lines(const Plot& plot, const PlotArea& area, List& list, std::optional<int> number) {
  // a line that leaves the range is cut off there
  const double half = kPlotLine * area.point;
  if (plot.range)
    list.clip({area.left - half, area.top - half, area.right - area.left + 2 * half + kDotRadius * area.point,
               area.bottom - area.top + 2 * half});
  for (const std::size_t which : painters_order(plot)) {
    const Series& each = plot.lines[which];
    const std::vector<double>& way = along(plot, each);
    // where it has no place there is a gap
    std::vector<std::vector<Node>> parts;
    bool goes_on = false;
    for (std::size_t i = 0; i < way.size() && i < each.values.size(); ++i) {
      const bool here = area.has(way[i], each.values[i]);
      if (here && !goes_on) parts.emplace_back();
      if (here)
        parts.back().push_back(
            {area.at(way[i], each.values[i]), kPlotLine * each.weight * area.point, each.color});
      goes_on = here;
    }
    if (parts.empty()) continue;
    if (number) list.of({Subject::What::chart, *number + int(which)});
    for (const std::vector<Node>& nodes : parts) {
      // over time no line comes back to where it was
      const bool orbit = !each.along.empty() && !plot.dotted && each.style > 0;
      const std::vector<std::vector<Node>> whole{nodes};
      for (const std::vector<Node>& piece : orbit ? once(nodes, area.point) : whole) {
        add_dashed(piece, each.style, area.point, list);
        if (!plot.dotted) add_markers_along(piece, each.style, area.point, list);
      }
      for (const Node& node : nodes)
        if (plot.dotted)
          add_marker(value_marker_of(each.style), node.at, kDotRadius * area.point, each.color, list);
    }
  }
  if (plot.range) list.unclip();
}

void draw_dots(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double unit = area.point;
  for (const Plot::Dot& dot : plot.dots) {
    const Point p = area.at(dot.along, dot.value);
    // a halo keeps it apart from lines; from an axis it would take a piece, and the tick
    const double halo = (kDotRadius + 0.6) * unit;
    list.halo(true);
    if (p.x() - area.left > halo && area.bottom - p.y() > halo)
      list.add(Disc{p, halo, 0, colours.ground, colours.ground});
    list.halo(false);
    list.add(Disc{p, kDotRadius * unit, 0, colours.ink, colours.ink});
    // at the right end above it, where the line's name is beside it
    const bool last = p.x() > area.right - 10 * unit;
    const Formula f = formula(dot.label, kPlotType * unit, colours.ink);
    add(f, p + (last ? Point(-f.width / 2, -5 * unit) : Point(3.5 * unit, -2.5 * unit)), list,
        {last ? Align::center : Align::left});
  }
}

void draw_names(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  // the lowest first
  std::vector<std::size_t> order(plot.lines.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return area.names[a] > area.names[b]; });
  for (const std::size_t i : order) {
    const Point end = end_of(plot, area, plot.lines[i]);
    const bool gone = leaves(plot, area, end);
    const double unit = area.point, off = (kBesideEnd + (area.led && !gone ? kLeaderRoom : 0)) * unit;
    const Point at((gone ? end.x() : area.right) + off, area.names[i]);
    if (area.led && comes_to_its_name(area, end))
      lead_to_name({area.right, end.y()}, at, plot.lines[i].color, unit, list);
    draw_name(plot, i, area, at, colours, list);
  }
}

void draw_plots(const std::vector<Plot>& plots, const Palette& colours, const std::vector<Rect>& rects,
                double type_scale, List& list) {
  std::vector<const Plot*> shown;
  std::vector<PlotArea> areas;
  std::vector<const Rect*> places;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (plots[i].lines.empty() || along(plots[i], plots[i].lines.front()).empty()) continue;
    shown.push_back(&plots[i]), places.push_back(&rects[i]);
  }
  for (double point = type_scale * kPoint; point > kLeastType * type_scale * kPoint; point *= kSmaller) {
    areas.clear();
    std::vector<PlotArea*> all;
    for (std::size_t i = 0; i < shown.size(); ++i) {
      areas.push_back(plot_area(*shown[i], *places[i], point));
      if (stray(*shown[i], areas.back())) areas.back() = plot_area(*shown[i], *places[i], point, true);
      lead_names(*shown[i], areas.back());
    }
    for (PlotArea& area : areas) all.push_back(&area);
    share_margins(all);
    if (are_wide(std::vector<const PlotArea*>(all.begin(), all.end()), places)) break;
  }
  for (std::size_t i = 0; i < shown.size(); ++i) {
    draw_axes(*shown[i], areas[i], colours, list);
    draw_lines(*shown[i], areas[i], list);
    draw_dots(*shown[i], areas[i], colours, list);
    draw_names(*shown[i], areas[i], colours, list);
  }
}

}  // namespace obscura::draw
