#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/model/model.h"

namespace obscura::scene {

/// The room of a scene: its walls, and the box that holds it where it is closed or has a size.
template <int D>
struct Room {
  struct Bounds {
    sim::Vec<D> low, high;
  };

  std::vector<sim::Wall<D>> walls;
  std::vector<std::string> names;  // "the floor", "room.walls[0]"; one a wall
  std::vector<Place> places;       // where each was written
  std::optional<Bounds> bounds;    // none: open
  std::optional<double> height;    // of `size`
};

/// Builds the walls: floor, left, right and ceiling of `size`, in space also back and front, then those of
/// `walls`.
template <int D>
Room<D> room(const Node& top, Diagnostics& complaints);

/// The region that walls leave free: empty if they leave none, else the box around it; the box has no
/// vertices in directions in which it is unbounded.
template <int D>
struct Left {
  int walls =
      0;  // how many of them leave some room: all, or as many as come before the first that leaves none
  std::optional<typename Room<D>::Bounds> bounds;
};
template <int D>
Left<D> left(const std::vector<sim::Wall<D>>& walls);

/// How far a point lies beyond a wall, m; negative inside.
template <int D>
double beyond(const sim::Wall<D>& wall, const sim::Vec<D>& point) {
  return -(point - wall.point).dot(wall.normal);
}

}  // namespace obscura::scene
