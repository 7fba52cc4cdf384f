#pragma once

#include <string>
#include <vector>

#include "draw/picture/list.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// One line of a plot: its values, and where along the plot each is.
struct Series {
  std::string label;  // as mathematics, at the line's end
  std::vector<double> values;
  Color color{};
  std::vector<double> along{};  // empty: at the plot's times
  std::string note{};           // after its label
};

/// Values over time or another quantity, with axes, ticks at round numbers and each line's name at its end.
struct Plot {
  struct Dot {
    double along = 0, value = 0;
    std::string label;  // as mathematics
  };
  std::string unit;           // of the values
  std::vector<double> times;  // s, increasing
  std::vector<Series> lines;
  std::vector<double> marks;       // times that the panels show
  std::string name = "t / \"s\"";  // of what they are over, as mathematics
  bool log = false;                // both axes; of what is not positive nothing is drawn
  bool dotted = false;             // a dot at each value
  std::vector<Dot> dots;
};

/// The mapping from a plot's values to the page.
struct PlotArea {
  double point = 1;                                 // page units: of type, lines and ticks
  double left = 0, right = 0, top = 0, bottom = 0;  // page units: of what the axes span
  double first = 0, last = 1, low = 0, high = 1;    // s, or what it is over, and values there
  bool log = false;                                 // both axes
  std::vector<double> ticks;                        // of the values
  std::vector<double> names;                        // one a line: the height of its name's middle

  Point at(double along, double value) const;
  /// Whether it has a place there.
  bool has(double along, double value) const { return !log || (along > 0 && value > 0); }
};

/// Axes for all of a plot's values in a rectangle of the page. Requires two times and a line at least.
PlotArea plot_area(const Plot& plot, const Rect& rect, double point);

/// Axes, ticks, units and marks.
void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// The lines, as far as there are values.
void draw_lines(const Plot& plot, const PlotArea& area, List& list);
/// The dots with names.
void draw_dots(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// The names of the lines, beside their ends.
void draw_names(const Plot& plot, const PlotArea& area, List& list);

/// Puts a plot down in a rectangle of a sheet (kPoint units a point): all of the above.
void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list);

/// Round numbers in [low, high], about `count` of them.
std::vector<double> ticks(double low, double high, int count);

}  // namespace obscura::draw
