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

/// The gaps below `margin` (m) between two shapes, nearest features only: two for faces that lie on each
/// other, one otherwise, none where they are farther apart; of compounds, those of all their parts. Appends
/// to `out`, with a and b for the key. A corner that lies deep inside is told by the face it is nearest to.
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
