#pragma once

#include <vector>

#include "sim/contact.h"
#include "sim/shape.h"
#include "sim/turning.h"

namespace obscura::sim {

// Every shape is a convex core of corners and faces, rounded by a radius: a point and a ball have one corner,
// a box and a polygon no radius. Where two shapes touch, a corner of one lies at a face of the other, or two
// corners lie at each other. What keeps them apart is a function of their poses,
//   g = n . (p - p_face) - r_a - r_b        corner at a face, n turning with the face's body
//   g = |p_a - p_b| - r_a - r_b             corner at a corner
// which holds through a step, while the features stay the same.

/// One such function, and what it was when it was found.
template <int D>
struct Gap {
  enum class Kind : std::uint8_t { corner_of_a, corner_of_b, corners };

  ContactKey key;
  Kind kind = Kind::corner_of_a;
  Vec<D> on_a = Vec<D>::Zero();  // a's corner or a point of its face, in a's frame
  Vec<D> on_b = Vec<D>::Zero();  // b's, in b's frame; of a wall, in the room
  Vec<D> normal =
      Vec<D>::Zero();  // of the face, outward, in the frame of its body (or the room); corners: unused
  double radius_a = 0, radius_b = 0;  // m
  double value = 0;                   // g, m
};

/// A gap at some instant.
template <int D>
struct Meeting {
  double value = 0;                 // g, m; negative: inside
  Vec<D> point = Vec<D>::Zero();    // world frame, midway between the two surfaces
  Vec<D> normal = Vec<D>::Unit(0);  // world frame, unit, from b to a
};

/// What a gap is where its bodies stand so; of a wall, b stands still at the origin. Its rate is the normal's
/// component of the velocity of a's material at `point` against b's, exactly: both turn about it, and a shift
/// along the normal changes nothing. Corners that coincide part along x.
template <int D>
Meeting<D> evaluate(const Gap<D>& gap, const Stance<D>& a, const Stance<D>& b) {
  const Vec<D> on_a = a.x + a.arm(gap.on_a), on_b = b.x + b.arm(gap.on_b), apart = on_a - on_b;
  Meeting<D> now;
  switch (gap.kind) {
    case Gap<D>::Kind::corner_of_a:
      now.normal = b.arm(gap.normal);
      now.value = now.normal.dot(apart) - gap.radius_a - gap.radius_b;
      now.point = on_a - now.normal * (gap.radius_a + now.value / 2);
      break;
    case Gap<D>::Kind::corner_of_b:
      now.normal = -a.arm(gap.normal);
      now.value = now.normal.dot(apart) - gap.radius_a - gap.radius_b;
      now.point = on_b + now.normal * (gap.radius_b + now.value / 2);
      break;
    case Gap<D>::Kind::corners: {
      const double length = apart.norm();
      if (length > 0) now.normal = apart / length;
      now.value = length - gap.radius_a - gap.radius_b;
      now.point = on_b + now.normal * (gap.radius_b + now.value / 2);
      break;
    }
  }
  return now;
}

/// The gaps below `margin` (m) between two shapes, nearest features only: two for faces that lie on each
/// other, one otherwise, none where they are farther apart; of compounds, those of all their parts. Appends
/// to `out`, with a and b for the key. A corner that lies deep inside is told by the face it is nearest to.
/// In the plane, the two are the corners that bound what the touching faces share, be they a's or b's; where
/// corners of both lie at one place (within 1e-6 of the face) a's is taken. Corner at corner only where no
/// face is nearer: where a ball takes part, or shapes are apart. Parallel faces in line with each other's
/// ends pass by, within 1e-6 of the face: a box slides over a row of boxes. Two points never touch. Depends
/// on nothing but the two poses; `feature` counts kind, parts, and the corner or face of each.
template <int D>
void gaps(int a, const Shape<D>& shape_a, const Stance<D>& at_a, int b, const Shape<D>& shape_b,
          const Stance<D>& at_b, double margin, std::vector<Gap<D>>& out);

/// The gaps below `margin` between a shape and a wall: of every corner.
template <int D>
void gaps(int a, const Shape<D>& shape, const Stance<D>& at, int wall, const Wall<D>& half_space,
          double margin, std::vector<Gap<D>>& out);

/// Distance (m) between two shapes; where they overlap minus the depth.
template <int D>
double separation(const Shape<D>& a, const Stance<D>& at_a, const Shape<D>& b, const Stance<D>& at_b);

}  // namespace obscura::sim
