#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
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
  int style = 0;                // which dashes, and which marker: lines are told apart without their colours
  double weight = 1;            // of the line
  bool quiet = false;           // others are to be looked at: it lies under them
};

/// Values over time or another quantity, with axes, ticks at round numbers and each line's name at its end,
/// or in a key.
struct Plot {
  struct Dot {
    double along = 0, value = 0;
    std::string label;  // as mathematics
  };
  std::string title;          // of the values' axis, as mathematics: a quantity over its unit
  std::vector<double> times;  // s, increasing
  std::vector<Series> lines;
  std::vector<double> marks;       // times that the panels show
  std::string name = "t / \"s\"";  // of what they are over, as mathematics
  bool log = false;                // both axes; of what is not positive nothing is drawn
  bool dotted = false;             // a dot at each value
  std::vector<Dot> dots;
  std::optional<std::pair<double, double>> range{};  // of the values' axis; none: all there are
  double negligible = 0;                             // smaller values are zero
  bool placed = false;  // its values are places, of which zero is one like others
};

/// The mapping from a plot's values to the page.
struct PlotArea {
  double point = 1;                                 // page units: of type, lines and ticks
  double left = 0, right = 0, top = 0, bottom = 0;  // page units: of what the axes span
  double first = 0, last = 1, low = 0, high = 1;    // s, or what it is over, and values there
  bool log = false;                                 // both axes
  std::vector<double> ticks;                        // of the values
  std::vector<double> names;                        // one a line: the height of its name's middle
  double title = 0;                                 // page units: its baseline
  double names_type = 1;                            // of the type's size: that of names
  bool led = false;                                 // whether leaders go from lines' ends to their names
  std::vector<double> heights;                      // page units: of names, one a line
  std::vector<Point> key;  // where each line's entry in a key begins; none: names are beside their lines
  double key_room = 0;     // page units: from the key to the right edge

  Point at(double along, double value) const;
  /// Whether it has a place there.
  bool has(double along, double value) const { return !log || (along > 0 && value > 0); }
  /// Whether a value lies between the ends of its axis.
  bool spans(double value) const { return value >= low && value <= high; }
};

/// Axes for all of a plot's values in a rectangle of the page. Requires a line with a value at least. They
/// begin at zero, unless what is plotted is far from it next to how much it changes. `keyed`: the names are
/// in a key, however few they are.
PlotArea plot_area(const Plot& plot, const Rect& rect, double point, bool keyed = false);

/// Gives plots under each other the same left and right ends.
void share_margins(std::span<PlotArea*> areas);

/// Whether the axes of plots are so wide next to their rectangles that what they show can be seen. Where they
/// are not their type is made smaller.
bool are_wide(std::span<const PlotArea* const> areas, std::span<const Rect* const> rects);
inline constexpr double kSmaller = 0.92, kLeastType = 0.1;  // by how much at once, and to which part at least

/// A name over its unit, as mathematics: "v / m s^{-1}".
std::string over_unit(const std::string& name, const std::string& unit);

/// Gives lines styles by their order in the plot.
void tell_apart(Plot& plot);

/// The order of heights from the least on, equal ones in the order of their numbers.
std::vector<int> by_height(const std::vector<double>& wanted);

/// As near as they can be to where they are wanted, in this order and off each other: the middles of names of
/// these heights, which reach from `low` to `high` at most.
std::vector<double> spread(const std::vector<double>& wanted, const std::vector<double>& heights, double low,
                           double high, const std::vector<int>& order);

/// The numbers of the lines, those first that lie under the others.
std::vector<std::size_t> painters_order(const Plot& plot);

/// Axes, ticks, units and marks, and the key where there is one.
void draw_axes(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// The lines, as far as there are values.
void draw_lines(const Plot& plot, const PlotArea& area, List& list, std::optional<int> number = {});
/// The dots with names.
void draw_dots(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// The names of the lines, beside their ends. A line that is alone is named by its axis; names in a key are
/// not here.
void draw_names(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);
/// One of them, with its left end's middle at `at`. `seen`: from 0, not at all, to 1.
void draw_name(const Plot& plot, std::size_t line, const PlotArea& area, const Point& at,
               const Palette& colours, List& list, double seen = 1);
inline constexpr double kNamesApart = 10;  // points
inline constexpr double kPlotLine = 1;     // points: how wide a line is
inline constexpr double kPlotBelow = 13;   // points: room for the numbers below it
inline constexpr double kPlotAbove = 17;   // points: room for the title above the axis

/// Puts plots down in rectangles of a sheet under each other (kPoint units a point), with type so much
/// larger: all of the above.
void draw_plots(const std::vector<Plot>& plots, const Palette& colours, const std::vector<Rect>& rects,
                double type_scale, List& list);

/// Round numbers in [low, high], about `count` of them.
std::vector<double> ticks(double low, double high, int count);

}  // namespace obscura::draw
