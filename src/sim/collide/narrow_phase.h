#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "sim/model/body_motion.h"
#include "sim/model/contact.h"
#include "sim/shape/curve.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

// Every shape is a convex core of vertices, faces and (in space) edges, rounded by a radius: a point and a
// ball have one vertex, a capsule one edge, a box, a polygon and a hull no radius. Two shapes touch at two
// features: a vertex of one at a face of the other, or two vertices; in space also two edges that cross, or a
// vertex at an edge. The gap between the features is a function of the poses,
//   g = n . (p - p_face) - r_a - r_b        corner at a face, n turning with the face's body
//   g = |p_a - p_b| - r_a - r_b             corner at a corner
//   g = n . (p_a - p_b) - r_a - r_b         edges that cross, n = e_a x e_b / |e_a x e_b|, turning with both
//   g = |d - e e . d| - r_a - r_b           corner at an edge along e, d from a place on it to the corner
// which stays valid through a step, while the features stay the same.

/// One such function, and what it was when it was found.
template <int D>
struct ContactCandidate {
  enum class Kind : std::uint8_t {
    corner_of_a,       // at a face of b
    corner_of_b,       // at a face of a
    corners,           // at each other
    edges,             // crossing
    corner_at_edge_b,  // a's
    corner_at_edge_a,  // b's
    corner_at_rail_b,  // a's, see sim/collide/rails.h
    corner_at_rail_a,  // b's
    face_at_rail_b,    // a's
    face_at_rail_a     // b's
  };

  ContactKey key;
  Kind kind = Kind::corner_of_a;
  Vec<D> on_a = Vec<D>::Zero();  // a's corner or a point of its face or edge, in a's frame
  Vec<D> on_b = Vec<D>::Zero();  // b's, in b's frame; of a wall, in the room
  Vec<D> normal =
      Vec<D>::Zero();  // of the face, outward, in the frame of its body (or the room); else unused
  Vec<D> edge_a = Vec<D>::Zero();     // along a's edge, unit, in a's frame; of two edges, so that their cross
  Vec<D> edge_b = Vec<D>::Zero();     // product leads from b to a. Else unused
  double radius_a = 0, radius_b = 0;  // m
  double value = 0;                   // g, m
  bool of_poses = false;              // its features are not of its key alone
  const Curve<D>* curve = nullptr;    // of a rail, in its body's frame
  int piece = 0;                      // of the curve
  double side = 0;                    // in the plane: 1 to the left of the rail, -1 to the right
};

/// How far along their edges, from on_a and on_b, two edges come nearest to each other: where pa + s ea and
/// pb + t eb have nothing between them along either, d = pa - pb. Edges that are parallel have no such place.
struct Crossing {
  double s = 0, t = 0;  // m
};
inline Crossing crossing(const Vec<3>& d, const Vec<3>& edge_a, const Vec<3>& edge_b) {
  const double c = edge_a.dot(edge_b), da = d.dot(edge_a), db = d.dot(edge_b);
  const double s = (c * db - da) / edge_a.cross(edge_b).squaredNorm();
  return {s, db + s * c};
}

/// A unit vector perpendicular to another; a function of that alone.
template <int D>
Vec<D> perpendicular(const Vec<D>& n) {
  if constexpr (D == 2) {
    return {-n[1], n[0]};
  } else {
    // the axis after the one that n follows most: it stays the same about every axis
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    return Vec<D>::Unit((axis + 1) % D).cross(n).normalized();
  }
}

/// A gap at some instant.
template <int D>
struct EvaluatedContact {
  double value = 0;                 // g, m; negative: inside
  Vec<D> point = Vec<D>::Zero();    // world frame, midway between the two surfaces
  Vec<D> normal = Vec<D>::Unit(0);  // world frame, unit, from b to a
};

/// The same of a contact with a rail, see sim/collide/rails.h.
template <int D>
EvaluatedContact<D> evaluate_at_rail(const ContactCandidate<D>& gap, const BodyMotion<D>& a,
                                     const BodyMotion<D>& b);

/// The gap of a contact at given poses; for a wall, b stands at the origin. Its rate is the normal component
/// of the velocity of a's material at `point` relative to b's, exactly: the normal turns with both bodies,
/// and a shift of the point along the normal changes nothing. For coincident vertices the normal is x.
template <int D>
EvaluatedContact<D> evaluate(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  const Vec<D> on_a = a.x + a.arm(gap.on_a), on_b = b.x + b.arm(gap.on_b), apart = on_a - on_b;
  EvaluatedContact<D> now;
  switch (gap.kind) {
    case ContactCandidate<D>::Kind::corner_of_a:
      now.normal = b.arm(gap.normal);
      now.value = now.normal.dot(apart) - gap.radius_a - gap.radius_b;
      now.point = on_a - now.normal * (gap.radius_a + now.value / 2);
      break;
    case ContactCandidate<D>::Kind::corner_of_b:
      now.normal = -a.arm(gap.normal);
      now.value = now.normal.dot(apart) - gap.radius_a - gap.radius_b;
      now.point = on_b + now.normal * (gap.radius_b + now.value / 2);
      break;
    case ContactCandidate<D>::Kind::corners: {
      const double length = apart.norm();
      if (length > 0) now.normal = apart / length;
      now.value = length - gap.radius_a - gap.radius_b;
      now.point = on_b + now.normal * (gap.radius_b + now.value / 2);
      break;
    }
    case ContactCandidate<D>::Kind::corner_at_edge_b:
    case ContactCandidate<D>::Kind::corner_at_edge_a: {
      const bool mine = gap.kind == ContactCandidate<D>::Kind::corner_at_edge_b;
      const Vec<D> edge = mine ? b.arm(gap.edge_b) : a.arm(gap.edge_a);
      const Vec<D> across = apart - edge * edge.dot(apart);
      const double length = across.norm();
      now.normal = length > 0 ? Vec<D>(across / length) : perpendicular<D>(edge);
      now.value = length - gap.radius_a - gap.radius_b;
      if (mine) {
        now.point = on_a - now.normal * (gap.radius_a + now.value / 2);
      } else {
        now.point = on_b + now.normal * (gap.radius_b + now.value / 2);
      }
      break;
    }
    case ContactCandidate<D>::Kind::corner_at_rail_b:
    case ContactCandidate<D>::Kind::corner_at_rail_a:
    case ContactCandidate<D>::Kind::face_at_rail_b:
    case ContactCandidate<D>::Kind::face_at_rail_a:
      return evaluate_at_rail(gap, a, b);
    case ContactCandidate<D>::Kind::edges:
      if constexpr (D == 3) {
        const Vec<D> edge_a = a.arm(gap.edge_a), edge_b = b.arm(gap.edge_b);
        now.normal = edge_a.cross(edge_b).normalized();
        now.value = now.normal.dot(apart) - gap.radius_a - gap.radius_b;
        now.point =
            on_a + crossing(apart, edge_a, edge_b).s * edge_a - now.normal * (gap.radius_a + now.value / 2);
      }
      break;
  }
  return now;
}

/// Appends to `out` the contact candidates between the nearest features of two shapes with gaps below
/// `margin` (m), with a and b for the key: two for faces that lie on each other, else one, none if the shapes
/// are farther apart; for compounds those of all their parts. A vertex deep inside is paired with the face
/// that is nearest to it. Depends on the two poses alone; `feature` counts kind, parts, and the vertex or
/// face of each. Two points never touch.
///
/// In the plane, the two for faces are the vertices that bound their overlap, be they a's or b's; if vertices
/// of both are at one place (within 1e-6 of the face), a's is taken. Vertex at vertex only if no face is
/// nearer: for balls, and for shapes apart. Parallel faces that meet only end to end (within 1e-6 of the
/// face) do not touch, so a box slides over a row of boxes without catching at the seams.
///
/// In space, faces that lie on each other give all the vertices of their overlap: a's, b's, and the crossings
/// of their edges, which are gaps between edges; at crossings under 3 degrees the place on the one edge is
/// taken as a vertex. Parallel edges that are nearest give the ends of their overlap, as vertices at edges.
template <int D>
void collide(int a, const Shape<D>& shape_a, const BodyMotion<D>& at_a, int b, const Shape<D>& shape_b,
             const BodyMotion<D>& at_b, double margin, std::vector<ContactCandidate<D>>& out);

/// The sine of the angle between two faces above which they are askew. Of an overlap whose faces are askew
/// the corner that touches is a contact, and the face's end is none: it touches only when the bodies have
/// turned. As a contact it would strike a corner that slides past it, for it lies, by the depth of the
/// overlap, at the other side of that corner.
inline constexpr double kAskew = 0.03;
/// Faces whose sine is less are parallel: they can trade their corners.
inline constexpr double kParallel = 1e-3;
/// Of the shorter of two parallel faces, in space of a core: corners of both that lie so close lie at one
/// place, and what is no wider is not shared. Then the faces pass by: a box about to slide from one plank
/// onto the next, bricks across a joint's crossing.
inline constexpr double kAligned = 1e-6;
/// Which gaps are sought: all, or of those that are askew none but the least. Of the latter, features are to
/// be sought again before bodies have turned by half of kAskew.
enum class Gaps { all, touching };

/// How far two shapes of space stay apart along an axis that turns with them: why collide() found nothing. It
/// finds nothing while `apart` less what they have moved since is at least its margin: by |d - d0|, d from
/// centre to centre, and by `per_turn` (|d| + r_a + r_b) for each radian that either has turned, r their
/// bounding radii.
struct Clearance {
  double apart = 1e300;  // m; -1e300: nothing is said
  double per_turn = 1;

  /// Of parts the least.
  void add(double value, double loss) { apart = std::min(apart, value), per_turn = std::max(per_turn, loss); }
};
/// As collide() above, of these gaps, and says why it has found nothing.
void collide(int a, const Shape<3>& shape_a, const BodyMotion<3>& at_a, int b, const Shape<3>& shape_b,
             const BodyMotion<3>& at_b, double margin, Gaps sought, std::vector<ContactCandidate<3>>& out,
             Clearance& clearance);

/// The gaps below `margin` between a shape and a wall, one for each vertex.
template <int D>
void collide(int a, const Shape<D>& shape, const BodyMotion<D>& at, int wall, const Wall<D>& half_space,
             double margin, std::vector<ContactCandidate<D>>& out);

/// The candidate of two shapes of space that a key from collide() names, to the bit, but for `value`. None
/// where the key does not say all: edges that are nearly parallel touch at a place that depends on the poses.
std::optional<ContactCandidate<3>> named_candidate(const ContactKey& key, const Shape<3>& shape_a,
                                                   const Shape<3>& shape_b);

/// Distance (m) between two shapes; if they overlap, minus the depth.
template <int D>
double separation(const Shape<D>& a, const BodyMotion<D>& at_a, const Shape<D>& b, const BodyMotion<D>& at_b);

/// How far a stays from b along n, unit, from b to a, m: of two that overlap never more than separation().
double separation_along(const Vec<3>& n, const Shape<3>& a, const BodyMotion<3>& at_a, const Shape<3>& b,
                        const BodyMotion<3>& at_b);

// for space in narrow_phase_space.cpp
template <>
void collide(int a, const Shape<3>& shape_a, const BodyMotion<3>& at_a, int b, const Shape<3>& shape_b,
             const BodyMotion<3>& at_b, double margin, std::vector<ContactCandidate<3>>& out);
template <>
void collide(int a, const Shape<3>& shape, const BodyMotion<3>& at, int wall, const Wall<3>& half_space,
             double margin, std::vector<ContactCandidate<3>>& out);
template <>
double separation(const Shape<3>& a, const BodyMotion<3>& at_a, const Shape<3>& b, const BodyMotion<3>& at_b);

}  // namespace obscura::sim
