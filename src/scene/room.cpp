#include "scene/room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/fields.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;

constexpr double kFar = 1e7;  // m: a side of a room that goes on to here is open

// what is left of a convex polygon on the right side of a wall
std::vector<Vec> clipped(const std::vector<Vec>& polygon, const sim::Wall<2>& wall) {
  std::vector<Vec> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec& a = polygon[i];
    const Vec& b = polygon[(i + 1) % polygon.size()];
    const double da = -beyond(wall, a), db = -beyond(wall, b);
    if (da >= 0) left.push_back(a);
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) left.push_back(a + (b - a) * (da / (da - db)));
  }
  return left;
}

}  // namespace

double beyond(const sim::Wall<2>& wall, const Vec& point) { return -(point - wall.point).dot(wall.normal); }

Room room(const Node& top, Complaints& complaints) {
  const Fields fields = Fields::of(top, "room");
  Room room;
  std::optional<double> elasticity;
  if (const Node* e = fields.given("elasticity")) elasticity = e->number();

  // four walls about the size
  const Node* slanted = fields.given("walls");
  if (fields.given("size") || !slanted || slanted->list().empty()) {
    const Vec low = fields.vector("corner"), size = fields.vector("size"), high = low + size;
    room.height = size.y();
    const auto wall = [&](const char* name, const Vec& point, const Vec& normal) {
      room.walls.push_back({point, normal, elasticity});
      room.names.push_back(name);
      room.places.push_back(fields.place("size"));
    };
    wall("the floor", low, {0, 1});
    wall("the left wall", low, {1, 0});
    wall("the right wall", high, {-1, 0});
    wall("the ceiling", high, {0, -1});
  } else if (const Node* corner = fields.given("corner")) {
    complaints.add(corner->place, "'corner' is that of 'size', and there is none");
  }

  // walls at any angle
  for (std::size_t i = 0; slanted && i < slanted->list().size(); ++i) {
    const Fields its(slanted->list()[i], "room.walls");
    if (!its.given("point") || !its.given("normal")) continue;
    sim::Wall<2> wall{its.vector("point"), its.vector("normal").stableNormalized(), elasticity};
    if (const Node* e = its.given("elasticity")) wall.elasticity = e->number();
    room.walls.push_back(wall);
    room.names.push_back(fmt::format("room.walls[{}]", i));
    room.places.push_back(its.place());
  }

  // what the walls leave
  std::vector<Vec> inside = {{-kFar, -kFar}, {kFar, -kFar}, {kFar, kFar}, {-kFar, kFar}};
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    inside = clipped(inside, room.walls[i]);
    if (inside.size() < 3) {
      complaints.add(
          room.places[i],
          fmt::format("{} leaves no room: it lies on the outside of the walls before it", room.names[i]));
      return room;
    }
  }
  Room::Bounds bounds{inside.front(), inside.front()};
  for (const Vec& corner : inside) bounds = {bounds.low.cwiseMin(corner), bounds.high.cwiseMax(corner)};
  if (bounds.low.minCoeff() > -kFar && bounds.high.maxCoeff() < kFar) room.bounds = bounds;
  return room;
}

}  // namespace obscura::scene
