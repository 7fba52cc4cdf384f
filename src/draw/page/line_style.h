#pragma once

#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// Lines of a plot are told apart without their colours: by six kinds of dashes, and from the seventh line on
/// by markers along them, too.
inline constexpr int kStyles = 24;

/// The marker along a line of a style and at its head: 0 a disc, which is at the head alone, then a square, a
/// triangle, a diamond.
int marker_of(int style);

/// That of a line with a marker at each value: other ones for lines beside each other.
int value_marker_of(int style);

/// A marker of about this radius.
void add_marker(int marker, const Point& at, double radius, Color color, List& list);

/// A line in the dashes of its style, which begin at its first node. `point`: page units.
void add_dashed(const std::vector<Node>& nodes, int style, double point, List& list);

/// Requires a node. The pieces of a line that do not lie on what comes before them in it, whatever follows:
/// of an orbit its first round. Dashes of a second one would fill the gaps of the first.
std::vector<std::vector<Node>> once(const std::vector<Node>& nodes, double point);

/// The markers of its style along a line: at the same places however long it has grown.
void add_markers_along(const std::vector<Node>& nodes, int style, double point, List& list);

}  // namespace obscura::draw
