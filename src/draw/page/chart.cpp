// Charts below the picture lie above each other, the last at the bottom, and reach across the page; those at
// its right are a column, as wide as its widest.

#include "draw/page/chart.h"

#include <algorithm>
#include <cmath>

namespace obscura::draw {
namespace {

constexpr double kMargin = 36;  // page units at the weight 1, as of the caption
constexpr double kType =
    24 / 8.5;  // page units a point of a plot for print: type as large as a caption's smallest
constexpr double kHead = 2.7;    // points
constexpr double kAround = 0.8;  // around a dot, points

}  // namespace

Charts::Charts(const std::vector<Chart>& charts, const std::vector<Plot>& plots, const Palette& colours,
               double aspect, double seconds, const sim::SceneInfo& cast, double foot)
    : colours_(colours), cast_(cast), foot_(foot) {
  const double width = 1080 * aspect, weight = std::min(1.0, std::sqrt(width / 1440));
  const double margin = kMargin * weight, inset = std::max(margin, 0.045 * width);
  double column = 0;
  for (const Chart& chart : charts) {
    if (chart.place == Chart::Place::below) below_ += chart.share * 1080;
    if (chart.place == Chart::Place::right) right_ = std::max(right_, chart.share * width), ++column;
  }
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
    }
    panels_.push_back({charts[i], plots[i], plot_area(plots[i], rect, kType * weight)});
    panels_.back().area.last = seconds;
  }
  // those above each other show one time at one place
  for (Panel& a : panels_) {
    for (const Panel& b : panels_) {
      if (a.chart.place != b.chart.place) continue;
      a.area.left = std::max(a.area.left, b.area.left);
      a.area.right = std::min(a.area.right, b.area.right);
    }
  }
}

void Charts::draw_still(List& list) const {
  for (const Panel& panel : panels_) {
    draw_axes(panel.plot, panel.area, colours_, list);
    draw_names(panel.plot, panel.area, list);
  }
}

void Charts::draw_lines(const sim::Snapshot& now, List& list) const {
  for (const Panel& panel : panels_) {
    Plot past;
    past.lines = panel.plot.lines;
    const auto& times = panel.plot.times;
    const auto end = std::lower_bound(times.begin(), times.end(), now.time);
    past.times.assign(times.begin(), end);
    for (Series& line : past.lines) line.values.resize(past.times.size());
    const bool within = now.time <= panel.area.last;
    const std::vector<const Measure*> measures = panel.chart.measures();
    if (within) {
      past.times.push_back(now.time);
      for (std::size_t i = 0; i < measures.size(); ++i)
        past.lines[i].values.push_back(measures[i]->at(cast_, now, panel.chart.body));
    }
    obscura::draw::draw_lines(past, panel.area, list);
    if (!within) continue;
    for (const Series& line : past.lines) {
      const Point at = panel.area.at(now.time, line.values.back());
      const double unit = panel.area.point;
      list.add(Disc{at, (kHead + kAround) * unit, kAround * unit, line.color, colours_.ground});
    }
  }
}

}  // namespace obscura::draw
