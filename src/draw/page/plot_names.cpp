// The names of a plot's lines. They stand beside the ends of their lines, as far from each other as they are
// high. Of many the type is smaller, down to a least; of more the names are a key: a piece of each line and
// its name, in rows beside the title of the axis and under it.

#include "draw/page/plot_names.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "draw/page/line_style.h"
#include "draw/picture/formula.h"

namespace obscura::draw {
namespace {

constexpr double kSmallestName = 0.78;  // of the type's size: beside lines
constexpr double kWidestName = 0.4;     // of the plot's width: beside lines
constexpr double kKeyTypes[] = {1, 0.9, 0.8, 0.7, 0.62};
constexpr double kLeastAxis = 18;  // points: a key leaves it that much
constexpr double kMostKey = 0.34;  // of the axis: what a key takes of it before its type gets smaller
constexpr double kSample = 19, kAfterSample = 4, kKeyGap = 13, kAfterTitle = 16;  // points
constexpr double kAroundName = 0.12;                                              // of the em
constexpr double kNameAboveAxis = 4.5;             // points: the middle of a name is so high at least
constexpr double kSampleMarker = 2.1;              // points
constexpr double kNameLeader = 0.4, kOffEnds = 2;  // points: how wide a leader is, how far off what it joins

Formula name_of(const Series& line, double type, Color color) {
  return formula(line.label + line.note, type, color);
}

double height_of(const Series& line, double type) {
  const Formula name = name_of(line, type, {});
  const double middle = kNameMiddle * type;
  return std::max(kNamesApart / kPlotType * type,
                  2 * std::max(name.ascent - middle, name.descent + middle) + kAroundName * type);
}

double widest(const Plot& plot, double type) {
  double all = 0;
  for (const Series& line : plot.lines) all = std::max(all, name_of(line, type, {}).width);
  return all;
}

// The names in rows of a key, whose type is as large as leaves the axis enough.
void lay_key(const Plot& plot, const Rect& rect, double title_right, PlotArea& area) {
  const double unit = area.point, count = double(plot.lines.size()), tall = area.bottom - area.top;
  // no name is wider than a row
  const double narrow = (rect.width - (kSample + kAfterSample) * unit) / widest(plot, kPlotType * unit);
  for (const double each : kKeyTypes) {
    const double smaller = std::min(each, narrow), type = smaller * kPlotType * unit;
    double row = 0;
    for (const Series& line : plot.lines) row = std::max(row, height_of(line, type));
    const double sample = (kSample + kAfterSample) * unit, width = sample + widest(plot, type),
                 column = width + kKeyGap * smaller * unit;
    // rows that begin on the title's line, or under it
    const auto columns = [&](double left) {
      return std::floor((rect.x + rect.width - left + kKeyGap * smaller * unit) / column);
    };
    const double beside = title_right + kAfterTitle * unit;
    const double under_rows = std::ceil(count / std::max(1.0, columns(rect.x)));
    const double beside_rows = columns(beside) < 1 ? 1e9 : std::ceil(count / columns(beside));
    const bool on_line = beside_rows - 1 <= under_rows;
    const double rows = on_line ? beside_rows : under_rows, lower = on_line ? rows - 1 : rows;
    const double middle = area.title - kNameMiddle * kPlotType * unit;
    // tall names begin below the upper edge
    const double first = on_line ? std::max(middle, rect.y + row / 2) : middle + row;
    const double down = std::max(0.0, lower * row + (on_line ? first - middle : 0));
    if (down > kMostKey * tall && each > std::end(kKeyTypes)[-1]) continue;
    area.names_type = smaller;
    area.key.clear();
    const auto across = std::size_t(std::ceil(count / rows));
    for (std::size_t i = 0; i < plot.lines.size(); ++i)
      area.key.emplace_back((on_line ? beside : rect.x) + double(i % across) * column,
                            first + double(i / across) * row);
    const double last = (on_line ? beside : rect.x) + double(across - 1) * column + width;
    area.key_room = std::max(0.0, rect.x + rect.width - last);
    area.top = std::max(area.top, std::min(area.top + down, area.bottom - kLeastAxis * unit));
    return;
  }
}

}  // namespace

bool named(const Plot& plot) {
  return plot.lines.size() > 1 || plot.title.empty() || !plot.lines.front().note.empty();
}

std::pair<double, double> room_for_names(const PlotArea& area) {
  const double half = kNamesApart / 2;
  return {area.top - half * area.point, area.bottom + (half - kNameAboveAxis) * area.point};
}

void fit_names(const Plot& plot, const Rect& rect, double title_right, PlotArea& area, bool keyed) {
  const double type = kPlotType * area.point;
  area.names_type = 1;
  area.heights.clear();
  for (const Series& line : plot.lines) area.heights.push_back(height_of(line, type));
  if (!named(plot)) return;
  const auto [low, high] = room_for_names(area);
  const double all = std::accumulate(area.heights.begin(), area.heights.end(), 0.0);
  const double smaller = std::min(1.0, (high - low) / all);
  const bool fits =
      !keyed && smaller >= kSmallestName && smaller * widest(plot, type) <= kWidestName * rect.width;
  if (!fits && plot.lines.size() > 1) {
    lay_key(plot, rect, title_right, area);
    return;
  }
  area.names_type = std::max(smaller, kSmallestName);
  for (double& height : area.heights) height *= area.names_type;
}

void draw_key(const Plot& plot, const PlotArea& area, const Palette& colours, List& list) {
  const double unit = area.point;
  for (std::size_t i = 0; i < area.key.size(); ++i) {
    const Series& line = plot.lines[i];
    const Point from = area.key[i], to = from + Point(kSample * unit, 0);
    const double width = line.weight * kPlotLine * unit;
    add_dashed({{from, width, line.color}, {to, width, line.color}}, line.style, unit, list);
    const int marker = plot.dotted ? value_marker_of(line.style) : marker_of(line.style);
    if (plot.dotted || marker > 0)
      add_marker(marker, (from + to) / 2, kSampleMarker * unit, line.color, list);
    const double type = area.names_type * kPlotType * unit;
    add(name_of(line, type, legible(line.color, colours)),
        to + Point(kAfterSample * unit, kNameMiddle * type), list);
  }
}

double width_of_name(const Plot& plot, std::size_t line, const PlotArea& area) {
  return name_of(plot.lines[line], area.names_type * kPlotType * area.point, {}).width;
}

double widest_name(const Plot& plot, const PlotArea& area) {
  return named(plot) && area.key.empty() ? widest(plot, area.names_type * kPlotType * area.point) : 0;
}

void draw_name(const Plot& plot, std::size_t line, const PlotArea& area, const Point& at,
               const Palette& colours, List& list, double seen) {
  if (!named(plot) || !area.key.empty() || !(seen > 0)) return;
  const Series& its = plot.lines[line];
  Color color = legible(its.color, colours);
  color.a = std::uint8_t(std::lround(color.a * std::min(seen, 1.0)));
  const double type = area.names_type * kPlotType * area.point;
  add(name_of(its, type, color), at + Point(0, kNameMiddle * type), list);
}

void lead_to_name(const Point& end, const Point& name, Color color, double unit, List& list, double seen) {
  color.a = std::uint8_t(std::lround(color.a * std::clamp(seen, 0.0, 1.0)));
  const Point from = end + Point(kOffEnds * unit, 0), to = name - Point(kOffEnds * unit, 0);
  list.add({{from, kNameLeader * unit, color}, {to, kNameLeader * unit, color}}, Cap::butt);
}

std::vector<int> by_height(const std::vector<double>& wanted) {
  std::vector<int> order(wanted.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return wanted[std::size_t(a)] < wanted[std::size_t(b)]; });
  return order;
}

std::vector<double> spread(const std::vector<double>& wanted, const std::vector<double>& heights, double low,
                           double high, const std::vector<int>& order) {
  const std::size_t n = wanted.size();
  const auto number = [&](std::size_t i) { return std::size_t(order[i]); };
  // how far below the middle of the first each middle is where they touch
  std::vector<double> below(n, 0);
  for (std::size_t i = 1; i < n; ++i)
    below[i] = below[i - 1] + (heights[number(i - 1)] + heights[number(i)]) / 2;
  // wanted less that must not decrease: averages of those that would (pool adjacent violators)
  struct Pool {
    double sum = 0;
    std::size_t count = 0;
    double mean() const { return sum / double(count); }
  };
  std::vector<Pool> pools;
  for (std::size_t i = 0; i < n; ++i) {
    pools.push_back({wanted[number(i)] - below[i], 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      const Pool last = pools.back();
      pools.pop_back();
      pools.back().sum += last.sum, pools.back().count += last.count;
    }
  }
  std::vector<double> found(n);
  std::size_t i = 0;
  for (const Pool& pool : pools)
    for (std::size_t k = 0; k < pool.count; ++k, ++i) found[number(i)] = pool.mean() + below[i];
  // within the ends
  for (std::size_t k = n; k-- > 0;)
    found[number(k)] =
        std::min(found[number(k)], high - heights[number(n - 1)] / 2 - (below[n - 1] - below[k]));
  for (std::size_t k = 0; k < n; ++k)
    found[number(k)] = std::max(found[number(k)], low + heights[number(0)] / 2 + below[k]);
  return found;
}

}  // namespace obscura::draw
