#pragma once

#include <cstddef>
#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// Where the names of lines stand that go anywhere in a plot, of each line at each instant.
struct NamesAround {
  std::vector<std::vector<Point>> offsets;        // from its head to the middle of its name's left end
  std::vector<std::vector<std::size_t>> changes;  // the instants that it stands at another side from
  bool clear = true;  // hardly ever on a line, a head or another name, and it seldom changes its side
};

/// Names beside the heads of their lines, on no line as far as it has come, no head and no other name, where
/// that can be. `heads`: of each instant, of each line; `sizes`: of names; they stay within `bounds`.
/// `gap`: from the middle of a head to its name; `unit`: a point, page units.
NamesAround names_around(const std::vector<std::vector<Point>>& heads, const std::vector<Point>& sizes,
                         const Rect& bounds, double gap, double unit);

}  // namespace obscura::draw
