#include "scene/room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/fields.h"

namespace obscura::scene {

namespace {

using Vec = sim::Vec<2>;

constexpr double kFar = 1e7;  // m: a side of a room that goes on to here is open

// a corner of what the walls leave, and the wall along the side from it to the next
struct Corner {
  Vec at;
  sim::Wall<2> side;
};

// where the side from a corner meets a wall; the corner itself where they are one line but for rounding
Vec meeting(const Corner& corner, const sim::Wall<2>& b) {
  const sim::Wall<2>& a = corner.side;
  const double ca = a.normal.dot(a.point), cb = b.normal.dot(b.point);
  const double det = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  if (std::abs(det) < 1e-12) return corner.at;
  const Vec at{(ca * b.normal.y() - cb * a.normal.y()) / det, (cb * a.normal.x() - ca * b.normal.x()) / det};
  return at + Vec::Zero();  // -0 is 0
}

// what a wall leaves of a convex polygon
std::vector<Corner> clipped(const std::vector<Corner>& polygon, const sim::Wall<2>& wall) {
  std::vector<Corner> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner& a = polygon[i];
    const Corner& b = polygon[(i + 1) % polygon.size()];
    const double da = beyond(wall, a.at), db = beyond(wall, b.at);
    if (da <= 0) left.push_back(a);
    // the wall takes over where the polygon leaves the room, and hands back where it comes in again
    if (da <= 0 && db > 0) {
      if (da < 0)
        left.push_back({meeting(a, wall), wall});
      else
        left.back().side = wall;
    }
    if (da > 0 && db < 0) left.push_back({meeting(a, wall), a.side});
  }
  return left;
}

}  // namespace

double beyond(const sim::Wall<2>& wall, const Vec& point) { return -(point - wall.point).dot(wall.normal); }

Room room(const Node& top, Complaints& complaints) {
  const Fields fields = Fields::of(top, "room");
  Room room;
  std::optional<double> elasticity, friction;
  if (const Node* e = fields.given("elasticity")) elasticity = e->number();
  if (const Node* mu = fields.given("friction")) friction = mu->number();

  // four walls about the size
  const Node* slanted = fields.given("walls");
  if (fields.given("size") || !slanted || slanted->list().empty()) {
    const Vec low = fields.vector("corner"), size = fields.vector("size"), high = low + size;
    room.height = size.y();
    const auto wall = [&](const char* name, const Vec& point, const Vec& normal) {
      room.walls.push_back({point, normal, elasticity, friction});
      room.names.push_back(name);
      room.places.push_back(fields.given("size") ? fields.place("size") : Place{});
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
    sim::Wall<2> wall{its.vector("point"), its.vector("normal").stableNormalized(), elasticity, friction};
    if (const Node* e = its.given("elasticity")) wall.elasticity = e->number();
    if (const Node* mu = its.given("friction")) wall.friction = mu->number();
    room.walls.push_back(wall);
    room.names.push_back(fmt::format("room.walls[{}]", i));
    room.places.push_back(its.place());
  }

  // what the walls leave
  std::vector<Corner> inside = {{{-kFar, -kFar}, {{0, -kFar}, {0, 1}, {}, {}}},
                                {{kFar, -kFar}, {{kFar, 0}, {-1, 0}, {}, {}}},
                                {{kFar, kFar}, {{0, kFar}, {0, -1}, {}, {}}},
                                {{-kFar, kFar}, {{-kFar, 0}, {1, 0}, {}, {}}}};
  for (std::size_t i = 0; i < room.walls.size(); ++i) {
    inside = clipped(inside, room.walls[i]);
    if (inside.size() < 3) {
      complaints.add(
          room.places[i],
          fmt::format("{} leaves no room: it lies on the outside of the walls before it", room.names[i]));
      return room;
    }
  }
  Room::Bounds bounds{inside.front().at, inside.front().at};
  for (const Corner& corner : inside)
    bounds = {bounds.low.cwiseMin(corner.at), bounds.high.cwiseMax(corner.at)};
  if (bounds.low.minCoeff() > -kFar && bounds.high.maxCoeff() < kFar) room.bounds = bounds;
  return room;
}

}  // namespace obscura::scene
