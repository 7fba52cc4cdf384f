#pragma once

#include <cstddef>
#include <vector>

namespace obscura::draw {

/// Where the names of lines stand beside their heads, of each line at each instant.
struct NamePlaces {
  std::vector<std::vector<double>> offsets;       // how far below its head its name is; above: negative
  std::vector<std::vector<std::size_t>> changes;  // the instants that it has another rank from
};

/// Names as near as they can be to the heads of their lines, off each other and between `low` and `high`, in
/// the order of the heads. `heads`: of each instant, of each line; `heights`: of the names. Two lines change
/// places where they have passed each other by a part of a name's height, unless they change back at once.
NamePlaces names_beside(const std::vector<std::vector<double>>& heads, const std::vector<double>& heights,
                        double low, double high);

}  // namespace obscura::draw
