#include "scene/room.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "scene/fields.h"
#include "scene/friction.h"

namespace obscura::scene {

namespace {

// the walls that a size gives, in their order: all of them, or as many as are wanted
template <int D>
struct WallSide {
  const char* name;
  int axis;
  bool high;
};

constexpr WallSide<2> kPlane[] = {{"the floor", 1, false},
                                  {"the left wall", 0, false},
                                  {"the right wall", 0, true},
                                  {"the ceiling", 1, true}};
constexpr WallSide<3> kSpace[] = {{"the floor", 1, false},     {"the left wall", 0, false},
                                  {"the right wall", 0, true}, {"the ceiling", 1, true},
                                  {"the back wall", 2, false}, {"the front wall", 2, true}};

template <int D>
std::vector<WallSide<D>> sides(const Node* walls);

template <>
std::vector<WallSide<2>> sides(const Node* walls) {
  const std::size_t n = !walls || !walls->is_text() ? 4 : walls->text() == "ground" ? 1 : 0;
  return {kPlane, kPlane + n};
}

template <>
std::vector<WallSide<3>> sides(const Node* walls) {
  const std::size_t n = !walls || !walls->is_text() ? 6 : walls->text() == "ground" ? 1 : 0;
  return {kSpace, kSpace + n};
}

// more walls, or more of them in one plane, take contacts and pictures longer than anybody waits
constexpr std::size_t kMostListedWalls = 1000;
constexpr int kMostAlike = 8;

// the first wall that lies in one plane with as many others before it; -1: none does
template <int D>
int crowded(const std::vector<sim::Wall<D>>& walls) {
  constexpr double kAlike = 1e-9;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    int alike = 0;
    for (std::size_t k = 0; k < i; ++k) {
      const sim::Vec<D> aside = walls[i].normal - walls[k].normal;
      if (aside.squaredNorm() > kAlike * kAlike) continue;
      const double apart = std::abs((walls[i].point - walls[k].point).dot(walls[i].normal));
      if (apart <= kAlike * (1 + walls[i].point.cwiseAbs().maxCoeff())) ++alike;
    }
    if (alike >= kMostAlike) return int(i);
  }
  return -1;
}

// the origin is the left end of the floor in the plane, its middle in space
sim::Vec<2> corner(const sim::Vec<2>&) { return {0, 0}; }
sim::Vec<3> corner(const sim::Vec<3>& size) { return {-size.x() / 2, 0, -size.z() / 2}; }

}  // namespace

template <int D>
Room<D> room(const Node& top, Diagnostics& complaints) {
  using Vec = sim::Vec<D>;
  const Fields fields = Fields::of(top, "room");
  Room<D> room;
  std::optional<double> elasticity, friction;
  if (const Node* e = fields.given("elasticity")) elasticity = e->number();
  if (const Node* mu = fields.given("friction")) friction = mu->number();
  const std::optional<double> at_rest = static_friction(fields, friction, complaints);

  // walls about the size
  const Node* walls = fields.given("walls");
  const bool word = walls && walls->is_text(), listed = walls && walls->is_list() && !walls->list().empty();
  if (fields.given("size") || !listed) {
    const Vec size = fields.vector<D>("size");
    const Node* at = fields.given("corner");
    const Vec low = at ? vector<D>(*at) : corner(size), high = low + size;
    room.height = size.y();
    room.bounds = {low, high};
    for (const WallSide<D>& side : sides<D>(walls)) {
      const Vec normal = (side.high ? -1.0 : 1.0) * Vec::Unit(side.axis) + Vec::Zero();
      room.walls.push_back({side.high ? high : low, normal, elasticity, friction, at_rest});
      room.names.push_back(side.name);
      room.places.push_back(fields.given("size") ? fields.place("size") : Place{});
    }
  } else if (const Node* at = fields.given("corner")) {
    complaints.add(at->place, "'corner' is that of 'size', and there is none");
  }

  // walls at any angle
  if (listed && walls->list().size() > kMostListedWalls) {
    complaints.add(walls->place, fmt::format("'walls': {} walls are more than {}, the most a room may have",
                                             walls->list().size(), kMostListedWalls));
    return room;
  }
  for (std::size_t i = 0; listed && i < walls->list().size(); ++i) {
    const Fields its(walls->list()[i], "room.walls");
    if (!its.given("point") || !its.given("normal")) continue;
    sim::Wall<D> wall{its.vector<D>("point"), its.vector<D>("normal").stableNormalized(), elasticity,
                      friction, at_rest};
    if (const Node* e = its.given("elasticity")) wall.elasticity = e->number();
    if (const Node* mu = its.given("friction")) wall.friction = mu->number(), wall.static_friction.reset();
    if (its.given("static_friction")) wall.static_friction = static_friction(its, wall.friction, complaints);
    room.walls.push_back(wall);
    room.names.push_back(fmt::format("room.walls[{}]", i));
    room.places.push_back(its.place());
  }

  if (const int one_too_many = crowded(room.walls); one_too_many >= 0) {
    complaints.add(room.places[std::size_t(one_too_many)],
                   fmt::format("{} lies in one plane with {} others: expected fewer; leave it out",
                               room.names[std::size_t(one_too_many)], kMostAlike));
    return room;
  }

  const Left<D> inside = left(room.walls);
  if (inside.walls < int(room.walls.size())) {
    const std::size_t first = std::size_t(inside.walls);
    complaints.add(
        room.places[first],
        fmt::format("{} leaves no room: it lies on the outside of the walls before it", room.names[first]));
    return room;
  }
  if (!word) room.bounds = inside.bounds;
  return room;
}

template Room<2> room<2>(const Node&, Diagnostics&);
template Room<3> room<3>(const Node&, Diagnostics&);

}  // namespace obscura::scene
