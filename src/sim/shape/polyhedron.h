#pragma once

#include <array>
#include <span>
#include <vector>

#include "sim/shape/shape.h"

namespace obscura::sim {

/// The convex core of a form of space, where it stands: corners, edges between
/// two of them, faces around loops of them, and the radius that rounds it. A point and a ball have one corner
/// and nothing else, a capsule one edge and no face. Places are in the axes of the room, about an origin near
/// by. Refers to the form, which must live longer; allocates only for hulls of more than kFewEdges edges.
class Polyhedron {
 public:
  static constexpr int kFewEdges = 48;

  /// From corner to corner; `left` and `right` of it, seen from outside, are faces. -1 of a capsule.
  struct Edge {
    int from, to, left, right;
  };

  /// Requires any form but a compound.
  Polyhedron(const Shape<3>& shape, const BodyMotion<3>& at, const Vec<3>& origin)
      : Polyhedron(sim::core(shape), at, origin) {}
  Polyhedron(const Core<3>& core, const BodyMotion<3>& at, const Vec<3>& origin);

  int corners() const { return corners_; }
  int edges() const { return edges_; }
  int faces() const { return faces_; }
  double radius() const { return radius_; }

  Vec<3> corner(int i) const {
    if (core_.box)
      return middle_ + (i & 1 ? 1 : -1) * arms_.col(0) + (i & 2 ? 1 : -1) * arms_.col(1) +
             (i & 4 ? 1 : -1) * arms_.col(2);
    if (!core_.corners.empty()) return x_ + turn_ * core_.corners[i];
    if (core_.capsule) return middle_ + (i ? 1 : -1) * arms_.col(1);
    return middle_;
  }
  Edge edge(int i) const;
  std::span<const int> loop(int face) const;  // corners, counter-clockwise seen from outside
  Vec<3> normal(int face) const;              // outward, unit
  Vec<3> along(int edge) const;               // from its first corner to its second, unit
  int edge_between(int corner, int other) const;

  /// The same in the frame of the body, whatever its pose, to the bit.
  Vec<3> own_corner(int i) const;
  Vec<3> own_normal(int face) const;
  Vec<3> own_along(int edge) const;
  Vec<3> own_place(const Vec<3>& place) const { return turn_.transpose() * (place - x_); }

  /// A sphere that holds the core without its radius, around `middle`.
  const Vec<3>& middle() const { return middle_; }
  double bounding_radius() const { return bounding_radius_; }

  /// Which corner lies farthest along d, the first of equals.
  int farthest(const Vec<3>& d) const;

  /// Which of the faces around a corner has its normal most along d, the first of equals. Requires faces.
  int facing(int corner, const Vec<3>& d) const;

  bool is_box() const { return core_.box != nullptr; }
  const Rotation<3>& axes() const { return axes_; }       // of a box, unit
  const Rotation<3>& arms() const { return arms_; }       // of a box: its axes times half its sides
  const Vec<3>& half() const { return core_.box->half; }  // of a box

 private:
  void find_edges();

  Core<3> core_;
  int corners_ = 1, edges_ = 0, faces_ = 0;
  double radius_ = 0, bounding_radius_ = 0;
  Vec<3> x_, middle_;
  Rotation<3> turn_;         // room from body
  Rotation<3> axes_, arms_;  // of a box or capsule
  std::array<Edge, kFewEdges> few_;
  std::vector<Edge> many_;
};

/// How far a core reaches along d from the centre of its body, without its radius, m.
double reach_along(const Core<3>& core, const Rotation<3>& room_from_body, const Vec<3>& d);

/// A face of one core, how far the corners of the other stay from it (m), and which is the nearest.
struct FaceAxis {
  double value = -1e300;
  int face = -1, corner = -1;
};

/// Separating axes of the faces of `of`: the face with the greatest separation from `other`, the first of
/// equals. Stops at the first beyond `enough`.
FaceAxis greatest_separation(const Polyhedron& of, const Polyhedron& other, double enough);

/// An edge of either, the unit normal of both from b to a, and how far a stays from b along it, m.
struct EdgeAxis {
  double value = -1e300;
  int of_a = -1, of_b = -1;
  Vec<3> normal = Vec<3>::Zero();
};

/// Separating axes of pairs of edges: the pair along whose common normal the separation is greatest. Edges
/// that are parallel within 1e-6 have no common normal.
EdgeAxis greatest_edge_separation(const Polyhedron& a, const Polyhedron& b, double enough);

/// The nearest points of two segments: their fractions along the segments, and their distance, m.
struct Nearest {
  double on_p = 0, on_q = 0, apart = 0;
};
Nearest nearest(const Vec<3>& p0, const Vec<3>& p1, const Vec<3>& q0, const Vec<3>& q1);

/// Whether a place lies over a face, up to `slack` (m) beyond its edges.
bool over(const Polyhedron& solid, int face, const Vec<3>& place, double slack);

/// Distance (m) between two cores without their radii; if they overlap, minus the depth.
double core_separation(const Polyhedron& a, const Polyhedron& b);

}  // namespace obscura::sim
