#pragma once

// Contacts with rails: curves that are part of a body. A vertex p, rounded by r, touches the place c of the
// curve that is nearest to it, T . (p - c) = 0,
//   g = n . (p - c) - r                n  in the plane the curve's normal to the side that is touched
//   g = |p - c| - r                    in space
//   s' = u . T / (1 - k . (p - c))     speed of c along the curve; u  velocity of p in the rail's frame
//   n' = w x n - (k . n) s' T          k  curvature; in the plane
// In the plane a flat face of outward normal m touches the place where T . m = 0,
//   g = m . (c - q)                    q  a place of the face;  n = -m
//   s' = (w_face - w) / (k . N)        N  to the left of T
//   n' = w_face x n
// and an end of an open curve touches as a vertex. A rail is touched from in front only: what comes from
// behind passes.

#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// What ContactKey::feature says of a contact with a rail.
struct RailFeature {
  int rail = 0, piece = 0, vertex = 0;  // faces are numbered after kVertices
  bool left = true;
  int end = 0;  // 1: the beginning of an open curve, 2: its end

  static constexpr int kRails = 128, kPieces = 1 << 15, kVertices = 16;  // and as many faces

  int packed() const { return 1 << 30 | rail << 23 | int(left) << 22 | end << 20 | vertex << 15 | piece; }
  static RailFeature of(int feature) {
    return {feature >> 23 & 0x7f, feature & 0x7fff, feature >> 15 & 0x1f, (feature >> 22 & 1) != 0,
            feature >> 20 & 3};
  }
};

/// The rail of a contact; none where it has none.
template <int D>
const Rail<D>* rail_of(const Model<D>& model, const ContactKey& key) {
  if (model.rails.empty() || key.b < 0 || !(key.feature >> 30 & 1)) return nullptr;
  const auto number = std::size_t(RailFeature::of(key.feature).rail);
  if (number >= model.rails.size()) return nullptr;
  const Rail<D>& rail = model.rails[number];
  return rail.body == key.a || rail.body == key.b ? &rail : nullptr;
}

/// Whether a candidate is of a curve, and of which body it is part.
template <int D>
bool rail_is_of_b(const ContactCandidate<D>& gap) {
  return gap.kind == ContactCandidate<D>::Kind::corner_at_rail_b ||
         gap.kind == ContactCandidate<D>::Kind::face_at_rail_b;
}
template <int D>
bool rail_is_of_a(const ContactCandidate<D>& gap) {
  return gap.kind == ContactCandidate<D>::Kind::corner_at_rail_a ||
         gap.kind == ContactCandidate<D>::Kind::face_at_rail_a;
}
template <int D>
bool is_face_at_rail(const ContactCandidate<D>& gap) {
  return gap.kind == ContactCandidate<D>::Kind::face_at_rail_b ||
         gap.kind == ContactCandidate<D>::Kind::face_at_rail_a;
}

/// How such a gap stands and moves.
template <int D>
struct RailPlace {
  typename Curve<D>::Foot foot;
  Vec<D> tangent;    // room's frame
  Vec<D> place;      // c, room
  Vec<D> normal;     // n, from the rail to the other body
  Vec<D> point;      // of contact
  double gap = 0;    // m
  double speed = 0;  // s', m/s
  Vec<D> normal_rate, point_rate;
};

/// Of a contact candidate of a rail, at given poses.
template <int D>
RailPlace<D> rail_place(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b);

/// Whether a rail is touched by a shape: in the plane by all of some corners, in space by balls and bodies of
/// several balls.
template <int D>
bool touches_rails(const Shape<D>& shape);

/// How deep (m) a vertex of radius r may be in a rail and still touch it: farther behind, it comes from
/// behind.
inline double deepest_in_rail(double r, double scale) { return r > 0 ? r / 2 : 1e-3 * scale; }

/// Appends the gaps below `margin` (m) between the shape of body a and a rail of body b, a and b in any
/// order. `scale`: the room's size, m.
template <int D>
void collide_rail(int a, const Shape<D>& shape, const BodyMotion<D>& at, int b, int number,
                  const Rail<D>& rail, const BodyMotion<D>& rail_at, double margin, double scale,
                  std::vector<ContactCandidate<D>>& out);

}  // namespace obscura::sim
