#pragma once

// Contacts of round bodies with rails: curves that are part of a body. The gap is that between the vertex p
// of the one and the place c on the other's curve that is nearest to it, T . (p - c) = 0,
//   g = n . (p - c) - r                n  in the plane the curve's normal to the side that is touched
//   g = |p - c| - r                    in space
//   s' = u . T / (1 - k . (p - c))     speed of c along the curve; u  velocity of p in the rail's frame
//   n' = w x n - (k . n) s' T          k  curvature; in the plane
// and between the vertex and an end of an open curve that of two vertices. A rail is touched from in front
// only: one that comes from behind passes.

#include <vector>

#include "sim/collide/narrow_phase.h"

namespace obscura::sim {

/// What ContactKey::feature says of a contact with a rail.
struct RailFeature {
  int rail = 0, piece = 0, vertex = 0;
  bool left = true;
  int end = 0;  // 1: the beginning of an open curve, 2: its end

  static constexpr int kRails = 256, kPieces = 1 << 15, kVertices = 16;

  int packed() const { return 1 << 30 | rail << 22 | int(left) << 21 | end << 19 | vertex << 15 | piece; }
  static RailFeature of(int feature) {
    return {feature >> 22 & 0xff, feature & 0x7fff, feature >> 15 & 0xf, (feature >> 21 & 1) != 0,
            feature >> 19 & 3};
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

/// How such a gap stands and moves.
template <int D>
struct RailPlace {
  typename Curve<D>::Foot foot;
  Vec<D> tangent, curvature;  // room's frame
  Vec<D> place;               // c, room
  Vec<D> normal;              // n, from the rail to the vertex
  double gap = 0;             // m
  double speed = 0;           // s', m/s
  Vec<D> place_rate, normal_rate;
};

/// Of a contact candidate of a rail, at given poses.
template <int D>
RailPlace<D> rail_place(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b);

/// Whether a rail is touched by a shape: balls and points, and bodies of several balls. A point touches a
/// rail in the plane alone.
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
