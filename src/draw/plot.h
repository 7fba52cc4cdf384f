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

/// Puts a plot down in a rectangle of a sheet (kPoint units a point).
void draw_plot(const Plot& plot, const Palette& colours, const Rect& rect, List& list);

/// Round numbers in [low, high], about `count` of them.
std::vector<double> ticks(double low, double high, int count);

}  // namespace obscura::draw
