#pragma once

#include <string>
#include <vector>

#include "draw/list.h"
#include "draw/theme.h"

namespace obscura::draw {

/// One line of a plot: its values at the plot's times.
struct Series {
  std::string label;  // as mathematics, at the line's end
  std::vector<double> values;
  Color color{};
};

/// Values over time, with axes, ticks at round numbers and each line's name at its end.
struct Plot {
  std::string unit;           // of the values
  std::vector<double> times;  // s, increasing
  std::vector<Series> lines;
  std::vector<double> marks;  // times that the panels show
};

/// Where a plot's values lie on the page.
struct PlotArea {
  double point = 1;                                 // page units: of type, lines and ticks
  double left = 0, right = 0, top = 0, bottom = 0;  // page units: of what the axes span
  double first = 0, last = 1, low = 0, high = 1;    // s and values there
  std::vector<double> ticks;                        // of the values
  std::vector<double> names;                        // one a line: the height of its name's middle

  Point at(double time, double value) const {
    return {left + (right - left) * (time - first) / (last - first),
            bottom - (bottom - top) * (value - low) / (high - low)};
  }
};

/// Axes for all of a plot's values in a rectangle of the page. Requires two times and a line at least.
PlotArea plot_area(const Plot& plot, const Rect& rect, double point);

/// Axes, ticks, units and marks.
void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// The lines, as far as there are values.
void draw_lines(const Plot& plot, const PlotArea& area, List& list);
/// What the lines are called, beside their ends.
void draw_names(const Plot& plot, const PlotArea& area, List& list);

/// Puts a plot down in a rectangle of a sheet (kPoint units a point): all of the above.
void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list);

/// Round numbers in [low, high], about `count` of them.
std::vector<double> ticks(double low, double high, int count);

}  // namespace obscura::draw
