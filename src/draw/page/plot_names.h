#pragma once

#include "draw/page/plot.h"

namespace obscura::draw {

inline constexpr double kPlotType = 8.5;      // points: em of all words of a plot
inline constexpr double kNameMiddle = 0.24;   // of the em: from the baseline up to the middle of a name
inline constexpr double kTitleBaseline = 10;  // points: from the axis up to its title's baseline

inline constexpr double kLeaderRoom = 9;  // points: how much farther from its line a name with a leader is
inline constexpr double kOffLine = 0.75;  // of its height: a name farther off its line has a leader

/// Whether lines need names. One that is alone is named by its axis.
bool named(const Plot& plot);

/// Finds room for the names of lines in an area whose top and bottom are known: beside their ends, smaller
/// where there are many; where that would be too small, in rows of a key under and beside the title, which
/// ends at `title_right`, above the area, whose top goes down. `keyed`: in a key at any rate.
void fit_names(const Plot& plot, const Rect& rect, double title_right, PlotArea& area, bool keyed);

/// Puts the key down.
void draw_key(const Plot& plot, const PlotArea& area, const Palette& colours, List& list);

/// How wide the widest name is, as it stands beside its line; 0 in a key.
double widest_name(const Plot& plot, const PlotArea& area);

/// How wide that of one line is.
double width_of_name(const Plot& plot, std::size_t line, const PlotArea& area);

/// The line from the end of a line of a plot to its name, whose left end's middle is at `name`. `seen`: from
/// 0, not at all, to 1.
void lead_to_name(const Point& end, const Point& name, Color color, double unit, List& list, double seen = 1);

/// From where to where names beside their lines may reach.
std::pair<double, double> room_for_names(const PlotArea& area);

}  // namespace obscura::draw
