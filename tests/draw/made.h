#pragma once

#include <memory>
#include <string>
#include <vector>

#include "draw/compose/depict.h"

namespace obscura::draw {

/// A run made by hand: a cast, its looks and one instant of it.
struct Made {
  sim::SceneInfo cast;
  Look look;
  Camera camera;
  Extent extent;
  sim::Snapshot now;
  std::vector<std::shared_ptr<const sim::Track>> ways;

  Illustrator depictor(double aspect = 16.0 / 9) const { return {cast, look, camera, extent, aspect}; }
  Picture picture(double aspect = 16.0 / 9) const { return depictor(aspect).depict(now, ways); }

  void wall(const sim::Vec3& point, const sim::Vec3& normal) {
    cast.walls.push_back({point, normal.normalized()});
  }

  int body(sim::ShapeKind kind, const sim::Vec3& position, double size = 0) {
    sim::SceneInfo::Body who;
    who.name = "body " + std::to_string(cast.bodies.size());
    who.kind = kind;
    who.radius = kind == sim::ShapeKind::ball ? size : 0;
    if (kind == sim::ShapeKind::box) who.half = {size, size, 0}, who.turns = true;
    cast.bodies.push_back(who);
    sim::Snapshot::Body where;
    where.position = position;
    now.bodies.push_back(where);
    look.bodies.emplace_back();
    return int(cast.bodies.size()) - 1;
  }

  void spring(int a, int b, const sim::Vec3& from, const sim::Vec3& to, double rest) {
    cast.springs.push_back({a, b, rest, 1});
    now.springs.push_back({from, to});
  }
};

/// A room of walls around [0, width] x [0, height].
inline Made room(double width, double height) {
  Made made;
  made.cast.scale = height;
  made.wall({0, 0, 0}, {0, 1, 0});
  made.wall({0, 0, 0}, {1, 0, 0});
  made.wall({width, 0, 0}, {-1, 0, 0});
  made.wall({0, height, 0}, {0, -1, 0});
  made.extent = {{0, 0, 0}, {width, height, 0}};
  made.look.title = "The room";
  made.look.subtitle = "particles, springs, boxes and a scripted mouse";
  return made;
}

}  // namespace obscura::draw
