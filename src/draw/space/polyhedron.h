#pragma once

#include <span>
#include <vector>

#include "sim/math/vec.h"

namespace obscura::draw {

/// A convex body of flat faces.
struct Polyhedron {
  struct Face {
    std::vector<int> loop;  // vertices, counter-clockwise seen from outside
    sim::Vec3 normal;       // unit, outwards
    int side = -1;          // of a room cut from space: the wall it is of
  };
  struct Edge {
    int a = 0, b = 0;          // vertices
    int left = 0, right = -1;  // faces; along the left one's loop it runs from a to b
  };
  std::vector<sim::Vec3> vertices;
  std::vector<Face> faces;
  std::vector<Edge> edges;

  bool empty() const { return faces.empty(); }
  /// The same, turned and then moved.
  Polyhedron placed(const Eigen::Matrix3d& turn, const sim::Vec3& at) const;
};

/// An edge whose faces turn by less than this cosine says shows; other faces are pieces of one round surface.
inline constexpr double kCrease = 0.92;

/// For each face, at each vertex of its loop, the unit normal of the round surface that the faces stand for:
/// the mean of those faces there that turn from it by no more than an edge that does not show. Empty where
/// all are flat.
std::vector<std::vector<sim::Vec3>> round_normals(const Polyhedron& body);

/// The same without the tips of its cones: at a tip a round surface has no normal, and each of its faces would
/// have a tone of its own there. A five-hundredth of the edges at a tip is cut off,
/// and faces end there in several pieces.
Polyhedron blunted(const Polyhedron& body);

/// For each face, at each side of its loop, whether a face of `other` lies in its plane and continues it
/// there.
std::vector<std::vector<char>> continued(const Polyhedron& body, const Polyhedron& other);

/// A box about the origin.
Polyhedron box(const sim::Vec3& half);

/// By its faces, see sim::SceneInfo::Body.
Polyhedron polyhedron(std::span<const sim::Vec3> vertices, std::span<const std::vector<int>> faces);

/// The part of `body` with (p - point) . normal >= 0; the new face is of `side`.
Polyhedron cut(const Polyhedron& body, const sim::Vec3& point, const sim::Vec3& normal, int side);

}  // namespace obscura::draw
