#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "draw/space/light.h"
#include "draw/space/polyhedron.h"

namespace obscura::draw {

/// How much of the sky's light bodies and the ground keep from each other where they are near.
class Occlusion {
 public:
  /// A convex body: of flat faces, or a ball, or what a ball covers on the way from `a` to `b`.
  struct Body {
    const Polyhedron* flat = nullptr;
    sim::Vec3 a = sim::Vec3::Zero(), b = a;
    double radius = 0;
    double reach = 0;  // m: how far from it others are darker
    sim::Vec3 center = sim::Vec3::Zero();
    double around = 0;  // of a ball around it, m
  };

  /// `ground`: none: it keeps no light from anything.
  Occlusion(std::vector<Body> bodies, const std::optional<Ground>& ground);

  /// Which bodies, the ground as -1 among them, are near a body.
  std::span<const int> near(int body) const { return near_[std::size_t(body)]; }
  /// Those of them that may darken a face of it with these corners and this normal (unit).
  void near(int body, std::span<const sim::Vec3> corners, const sim::Vec3& normal,
            std::vector<int>& found) const;

  /// How dark (0 to 1) a place on a body is by those `others`, its surface's normal unit.
  double at(int body, std::span<const int> others, const sim::Vec3& place, const sim::Vec3& normal) const;

  double reach(int body) const { return bodies_[std::size_t(body)].reach; }

 private:
  double distance(int body, const sim::Vec3& place) const;

  /// A box: its axes as rows, and half its sides.
  struct Block {
    Eigen::Matrix3d axes;
    sim::Vec3 half;
  };
  static std::optional<Block> block(const Body& body);

  std::vector<Body> bodies_;
  std::vector<std::optional<Block>> blocks_;  // one a body: the same by a shorter way
  std::optional<Ground> ground_;
  std::vector<std::vector<int>> near_;
};

/// How far from a convex body of flat faces a place is, m; within it negative. Where three faces meet it is a
/// little more.
double distance(const Polyhedron& body, const sim::Vec3& place);

}  // namespace obscura::draw
