#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "sim/model.h"

namespace obscura::scene {

/// The room of a scene: its walls, and the box that holds it where it is closed.
struct Room {
  struct Bounds {
    sim::Vec<2> low, high;
  };

  std::vector<sim::Wall<2>> walls;
  std::vector<std::string> names;  // "the floor", "room.walls[0]"; one a wall
  std::vector<Place> places;       // where each was written
  std::optional<Bounds> bounds;    // none: open
  std::optional<double> height;    // of `size`
};

/// Builds the walls: floor, left, right and ceiling of `size`, then those of `walls`.
Room room(const Node& top, Complaints& complaints);

/// How far a point lies beyond a wall, m; negative inside.
double beyond(const sim::Wall<2>& wall, const sim::Vec<2>& point);

}  // namespace obscura::scene
