#pragma once

#include <string>

#include "scene/document.h"

namespace obscura::scene {

/// How many numbers the places of a scene have: two in the plane, three in space.
struct Dimension {
  int n = 2;
  std::string key;  // the key that decided it, "room.size"; empty: none did, and it is the plane
  Place place;      // where that is
};

/// Told by the length of `room.size`, or else of the first vector of the document, be it checked or not.
Dimension dimension(const Node& top);

}  // namespace obscura::scene
