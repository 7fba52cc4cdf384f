#pragma once

#include <span>
#include <vector>

namespace obscura::gl {

/// An edge of a polygon from p to q, px.
struct Edge {
  float px, py, qx, qy;
};

/// Rows [y0, y1) of a polygon, and which edges cross them: [first, first + count) of a list.
struct Band {
  float y0 = 0, y1 = 0;
  int first = 0, count = 0;
};

/// Appends to `list` the edges of a polygon whose rows are [y0, y1), and returns its bands. Each pixel adds
/// up all edges of its band, so a polygon of many edges has many bands, whole rows each; those with few edges
/// have one. An edge outside of a row adds nothing there, so the bands do not show.
std::vector<Band> banded(std::span<const Edge> edges, float y0, float y1, std::vector<Edge>& list);

/// Of the pixels of rows [y0, y1) those in columns [full0, full1) lie wholly in a polygon, and those that
/// meet it at all in [part0, part1).
struct Columns {
  int part0 = 0, part1 = 0, full0 = 0, full1 = 0;
};

/// Whether a closed outline of up to four edges turns one way only.
bool convex(std::span<const Edge> edges);

/// Of a convex polygon, edges in px; where it does not meet these rows all are 0.
Columns columns(std::span<const Edge> edges, int y0, int y1);

}  // namespace obscura::gl
