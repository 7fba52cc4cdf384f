// The convex region of the plane or of space that walls leave, and the box around it.
//   plane: a large square, cut by one wall after the other
//   space: the points where three walls meet and that no other leaves outside; |x| = kFar count as walls

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "scene/room.h"

namespace obscura::scene {

namespace {

constexpr double kFar = 1e7;            // m: a side of a room that goes on to here is open
constexpr std::size_t kMostWalls = 40;  // in space; with more the check is skipped: too many points

// a corner of what the walls leave, and the wall along the side from it to the next
struct Corner {
  sim::Vec<2> at;
  sim::Wall<2> side;
};

// the point where the side from a vertex meets a wall; the vertex itself if the two are one line but for
// rounding
sim::Vec<2> meeting(const Corner& corner, const sim::Wall<2>& b) {
  const sim::Wall<2>& a = corner.side;
  const double ca = a.normal.dot(a.point), cb = b.normal.dot(b.point);
  const double det = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
  if (std::abs(det) < 1e-12) return corner.at;
  const sim::Vec<2> at{(ca * b.normal.y() - cb * a.normal.y()) / det,
                       (cb * a.normal.x() - ca * b.normal.x()) / det};
  return at + sim::Vec<2>::Zero();  // -0 is 0
}

// the part of a convex polygon inside a wall
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

// the corners of what walls leave of space
std::vector<sim::Vec<3>> corners(const std::vector<sim::Wall<3>>& walls) {
  std::vector<sim::Vec<3>> all;
  const std::size_t n = walls.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      for (std::size_t k = j + 1; k < n; ++k) {
        Eigen::Matrix3d normals;
        normals << walls[i].normal.transpose(), walls[j].normal.transpose(), walls[k].normal.transpose();
        if (std::abs(normals.determinant()) < 1e-12) continue;
        const sim::Vec<3> offsets(walls[i].normal.dot(walls[i].point), walls[j].normal.dot(walls[j].point),
                                  walls[k].normal.dot(walls[k].point));
        const sim::Vec<3> at = normals.inverse() * offsets + sim::Vec<3>::Zero();
        const double rounding = 1e-9 * (1 + at.cwiseAbs().maxCoeff());
        if (std::all_of(walls.begin(), walls.end(),
                        [&](const sim::Wall<3>& wall) { return beyond(wall, at) <= rounding; }))
          all.push_back(at);
      }
    }
  }
  return all;
}

template <int D>
std::optional<typename Room<D>::Bounds> around(const std::vector<sim::Vec<D>>& points) {
  typename Room<D>::Bounds bounds{points.front(), points.front()};
  for (const sim::Vec<D>& at : points) bounds = {bounds.low.cwiseMin(at), bounds.high.cwiseMax(at)};
  if (bounds.low.minCoeff() > -kFar && bounds.high.maxCoeff() < kFar) return bounds;
  return {};
}

}  // namespace

template <>
Left<2> left(const std::vector<sim::Wall<2>>& walls) {
  std::vector<Corner> inside = {{{-kFar, -kFar}, {{0, -kFar}, {0, 1}, {}, {}}},
                                {{kFar, -kFar}, {{kFar, 0}, {-1, 0}, {}, {}}},
                                {{kFar, kFar}, {{0, kFar}, {0, -1}, {}, {}}},
                                {{-kFar, kFar}, {{-kFar, 0}, {1, 0}, {}, {}}}};
  for (std::size_t i = 0; i < walls.size(); ++i) {
    inside = clipped(inside, walls[i]);
    if (inside.size() < 3) return {int(i), {}};
  }
  std::vector<sim::Vec<2>> points;
  for (const Corner& corner : inside) points.push_back(corner.at);
  return {int(walls.size()), around<2>(points)};
}

template <>
Left<3> left(const std::vector<sim::Wall<3>>& walls) {
  if (walls.size() > kMostWalls) return {int(walls.size()), {}};
  std::vector<sim::Wall<3>> all;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0})
      all.push_back({side * kFar * sim::Vec<3>::Unit(axis), -side * sim::Vec<3>::Unit(axis), {}, {}});
  }
  std::vector<sim::Vec<3>> inside = corners(all);
  for (std::size_t i = 0; i < walls.size(); ++i) {
    all.push_back(walls[i]);
    inside = corners(all);
    if (inside.size() < 4) return {int(i), {}};
  }
  return {int(walls.size()), around<3>(inside)};
}

}  // namespace obscura::scene
