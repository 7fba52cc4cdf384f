// Narrow phase in the plane: which vertices lie at which faces. The face of greatest separation is the
// touching (reference) face; the other polygon's face most against it is its partner (the incident face).
// Seen along the touching face,
//
//        i1 ______________ i0          partner, of the other polygon
//     r0 ______________ r1             touching face
//         lo          hi               the inner of both ends, on either side
//
// each end of their overlap is a vertex of the one over the face of the other. If the polygons overlap, the
// deepest vertex always lies over the touching face, since a shift by the depth leaves them touching there;
// and no end of the touching face lies deeper in the partner. Parallel faces that share only a vertex (bricks
// across a joint's crossing, a box about to slide from one onto the next) do not touch: with either normal,
// the contact would stop a body that may pass.

#include "sim/collide/narrow_phase.h"

#include <algorithm>
#include <utility>

#include "sim/collide/contact_key.h"
#include "sim/shape/convex_polygon.h"

namespace obscura::sim {

namespace {

constexpr double kOblique = 1e-10;    // the sine from which on faces are no longer parallel
constexpr double kBeyondFace = 1e-9;  // of a face: this far beyond its end is still over it

using CandidateKind = ContactCandidate<2>::Kind;

// two outlines, part by part of two bodies
struct Couple {
  int a, b;
  const ConvexPolygon &of_a, &of_b;
  int part_a, part_b, parts_b;
  int digits_a, digits_b;  // more than any corner's number

  double radii() const { return of_a.radius() + of_b.radius(); }

  // which: numbers of the corner or face of a, and of b
  ContactCandidate<2> gap(CandidateKind kind, int which_a, int which_b, double core) const {
    ContactCandidate<2> made;
    made.key = {a, b,
                pack_features({int(kind), part_a, part_b, which_a, which_b}, parts_b, digits_a, digits_b)};
    made.kind = kind;
    made.on_a = of_a.corner(which_a);
    made.on_b = of_b.corner(which_b);
    if (kind == CandidateKind::corner_of_a) made.normal = of_b.normal(which_b);
    if (kind == CandidateKind::corner_of_b) made.normal = of_a.normal(which_a);
    made.radius_a = of_a.radius();
    made.radius_b = of_b.radius();
    made.value = core - radii();
    return made;
  }
};

// Two outlines of which the first owns the touching face, in its frame.
struct ReferenceFace {
  const ConvexPolygon &base, &other;
  const RelativePose& lies;  // of the other
  bool base_is_b;            // else a
  int face;
  double value;  // greatest separation

  ContactCandidate<2> other_at_base(const Couple& couple, int corner, double core) const {
    return base_is_b ? couple.gap(CandidateKind::corner_of_a, corner, face, core)
                     : couple.gap(CandidateKind::corner_of_b, face, corner, core);
  }
  ContactCandidate<2> base_at_other(const Couple& couple, int corner, int partner, double core) const {
    return base_is_b ? couple.gap(CandidateKind::corner_of_b, partner, corner, core)
                     : couple.gap(CandidateKind::corner_of_a, corner, partner, core);
  }
  ContactCandidate<2> corners(const Couple& couple, int of_base, int of_other, double core) const {
    return base_is_b ? couple.gap(CandidateKind::corners, of_other, of_base, core)
                     : couple.gap(CandidateKind::corners, of_base, of_other, core);
  }
};

void keep(const ContactCandidate<2>& gap, double margin, std::vector<ContactCandidate<2>>& out) {
  if (gap.value < margin) out.push_back(gap);
}

// no face is nearest: the two nearest corners; at one place, the deepest corner at the touching face
void corner_at_corner(const Couple& couple, const ReferenceFace& touching, double aligned, int deepest,
                      double margin, std::vector<ContactCandidate<2>>& out) {
  double least = 1e300;
  int of_base = 0, of_other = 0;
  for (int k = 0; k < touching.other.corners(); ++k) {
    const Vec<2> p = touching.lies * touching.other.corner(k);
    for (int i = 0; i < touching.base.corners(); ++i) {
      const double d = (p - touching.base.corner(i)).squaredNorm();
      if (d < least) {
        least = d;
        of_base = i;
        of_other = k;
      }
    }
  }
  const double apart = std::sqrt(least);
  keep(apart > aligned ? touching.corners(couple, of_base, of_other, apart)
                       : touching.other_at_base(couple, deepest, touching.value),
       margin, out);
}

void corner_at_face(const Couple& couple, const ReferenceFace& touching, double margin,
                    std::vector<ContactCandidate<2>>& out) {
  const Vec<2> r0 = touching.base.corner(touching.face);
  const Vec<2> r1 = touching.base.corner(touching.base.next(touching.face));
  const Vec<2> p = touching.lies * touching.other.corner(0);
  const double length = (r1 - r0).norm(), along = (p - r0).dot(r1 - r0) / length;
  const bool over = along >= 0 && along <= length;
  if (touching.value > 0 && !over) {
    corner_at_corner(couple, touching, kOblique * length, 0, margin, out);
  } else {
    keep(touching.other_at_base(couple, 0, touching.value), margin, out);
  }
}

void face_at_face(const Couple& couple, const ReferenceFace& touching, double margin,
                  std::vector<ContactCandidate<2>>& out) {
  // the touching face and its partner, in the base's frame
  const ConvexPolygon &base = touching.base, &other = touching.other;
  const Vec<2> n = base.normal(touching.face), t(-n[1], n[0]);
  const Vec<2> down = -(touching.lies.turn.transpose() * n);
  const int partner = other.facing(down);
  const int base_ends[2] = {touching.face, base.next(touching.face)};  // lo, hi
  const int other_ends[2] = {other.next(partner), partner};
  const Vec<2> r[2] = {base.corner(base_ends[0]), base.corner(base_ends[1])};
  const Vec<2> i[2] = {touching.lies * other.corner(other_ends[0]),
                       touching.lies * other.corner(other_ends[1])};
  const Vec<2> partner_n = touching.lies.turn * other.normal(partner);
  const Vec<2> partner_t(partner_n[1], -partner_n[0]);  // from lo to hi, as t

  const double length = t.dot(r[1] - r[0]), partner_length = partner_t.dot(i[1] - i[0]);
  const bool parallel = std::abs(t.dot(partner_n)) < kParallel;
  const double small = std::min(length, partner_length), aligned = (parallel ? kAligned : kOblique) * small;
  const double slack = kBeyondFace * small;
  const double other_core[2] = {n.dot(i[0] - r[0]), n.dot(i[1] - r[0])};
  const double base_core[2] = {partner_n.dot(r[0] - i[0]), partner_n.dot(r[1] - i[0])};
  const double place[2] = {t.dot(i[0] - r[0]), t.dot(i[1] - r[0])};

  // apart: is it a face that is nearest? Parallel ones in line with each other's ends pass by.
  if (touching.value > 0) {
    bool over = false;
    for (int end = 0; end < 2; ++end) {
      const double foot = partner_t.dot(r[end] - i[0]);
      over = over || (place[end] >= -slack && place[end] <= length + slack &&
                      other_core[end] <= touching.value + slack);
      over = over ||
             (foot >= -slack && foot <= partner_length + slack && base_core[end] <= touching.value + slack);
    }
    if (!over) {
      if (parallel && std::min(std::abs(place[0] - length), std::abs(place[1])) <= aligned) return;
      const int deepest = other_ends[other_core[1] < other_core[0]];
      return corner_at_corner(couple, touching, aligned, deepest, margin, out);
    }
  }

  // the inner of both corners at either end
  bool others[2];
  double at[2], core[2];
  for (int end = 0; end < 2; ++end) {
    const double base_place = end ? length : 0;
    const double inner = end ? base_place - place[end] : place[end] - base_place;
    others[end] = std::abs(inner) <= aligned ? touching.base_is_b || !parallel : inner > 0;
    at[end] = others[end] ? place[end] : base_place;
    core[end] = others[end] ? other_core[end] : base_core[end];
  }
  const auto keep_end = [&](int end) {
    if (!(core[end] - couple.radii() < margin)) return;
    out.push_back(others[end] ? touching.other_at_base(couple, other_ends[end], core[end])
                              : touching.base_at_other(couple, base_ends[end], partner, core[end]));
  };

  // If the shapes are apart and the faces oblique, a corner beside the partner may seem to lie over it. Its
  // gap is then less than the separation of the shapes: drop it.
  const double nearest = touching.value > 0 ? touching.value * (1 - kAligned) - aligned : -1e300;
  if (core[0] < nearest) return keep_end(1);
  if (core[1] < nearest) return keep_end(0);
  if (at[1] - at[0] <= aligned) {
    if (!parallel) keep_end(core[1] < core[0]);
    return;
  }
  keep_end(0);
  keep_end(1);
}

void outline_gaps(const Couple& couple, const RelativePose& a_in_b, double margin,
                  std::vector<ContactCandidate<2>>& out) {
  const ConvexPolygon &a = couple.of_a, &b = couple.of_b;
  const double far = margin + couple.radii();
  const Vec<2> middles = a_in_b * a.middle() - b.middle();
  const double radii = std::max(far, 0.0) + a.bounding_radius() + b.bounding_radius();
  if (middles.squaredNorm() > radii * radii) return;

  if (a.faces() + b.faces() == 0) {
    if (couple.radii() > 0) keep(couple.gap(CandidateKind::corners, 0, 0, middles.norm()), margin, out);
    return;
  }
  const RelativePose b_in_a = inverse(a_in_b);
  Separation by_a{-1e300, -1}, by_b{-1e300, -1};
  if (b.faces()) by_b = greatest_separation(b, a, a_in_b, far);
  if (by_b.value >= far) return;
  if (a.faces()) by_a = greatest_separation(a, b, b_in_a, far);
  if (by_a.value >= far) return;

  const bool base_is_b = b.faces() && by_b.value >= by_a.value;
  const ReferenceFace touching = base_is_b ? ReferenceFace{b, a, a_in_b, true, by_b.face, by_b.value}
                                           : ReferenceFace{a, b, b_in_a, false, by_a.face, by_a.value};
  if (touching.other.faces()) {
    const std::size_t before = out.size();
    face_at_face(couple, touching, margin, out);
    if (out.size() == before + 2 && out[before + 1].key < out[before].key) {
      std::swap(out[before], out[before + 1]);
    }
  } else {
    corner_at_face(couple, touching, margin, out);
  }
}

}  // namespace

template <int D>
void collide(int a, const Shape<D>& shape_a, const BodyMotion<D>& at_a, int b, const Shape<D>& shape_b,
             const BodyMotion<D>& at_b, double margin, std::vector<ContactCandidate<D>>& out) {
  static_assert(D == 2, "space comes with its own outlines");
  const RelativePose a_in_b = relative_pose(at_a, at_b);
  const int digits_a = feature_digits(shape_a), digits_b = feature_digits(shape_b);
  for (int i = 0; i < parts(shape_a); ++i) {
    const ConvexPolygon of_a(part(shape_a, i));
    for (int k = 0; k < parts(shape_b); ++k) {
      const ConvexPolygon of_b(part(shape_b, k));
      outline_gaps({a, b, of_a, of_b, i, k, parts(shape_b), digits_a, digits_b}, a_in_b, margin, out);
    }
  }
}

template <int D>
void collide(int a, const Shape<D>& shape, const BodyMotion<D>& at, int wall, const Wall<D>& half_space,
             double margin, std::vector<ContactCandidate<D>>& out) {
  static_assert(D == 2, "space comes with its own outlines");
  const int digits_a = feature_digits(shape);
  for (int i = 0; i < parts(shape); ++i) {
    const ConvexPolygon outline(part(shape, i));
    for (int k = 0; k < outline.corners(); ++k) {
      const Vec<D> p = at.x + at.arm(outline.corner(k));
      const double value = half_space.normal.dot(p - half_space.point) - outline.radius();
      if (!(value < margin)) continue;
      ContactCandidate<D> made;
      made.key = {a, -1 - wall, pack_features(i, k, digits_a)};
      made.kind = ContactCandidate<D>::Kind::corner_of_a;
      made.on_a = outline.corner(k);
      made.on_b = half_space.point;
      made.normal = half_space.normal;
      made.radius_a = outline.radius();
      made.value = value;
      out.push_back(made);
    }
  }
}

template <int D>
double separation(const Shape<D>& a, const BodyMotion<D>& at_a, const Shape<D>& b,
                  const BodyMotion<D>& at_b) {
  const RelativePose a_in_b = relative_pose(at_a, at_b);
  double least = 1e300;
  for (int i = 0; i < parts(a); ++i) {
    const ConvexPolygon of_a(part(a, i));
    for (int k = 0; k < parts(b); ++k) {
      const ConvexPolygon of_b(part(b, k));
      least = std::min(least, core_separation(of_a, of_b, a_in_b) - of_a.radius() - of_b.radius());
    }
  }
  return least;
}

template void collide(int, const Shape<2>&, const BodyMotion<2>&, int, const Shape<2>&, const BodyMotion<2>&,
                      double, std::vector<ContactCandidate<2>>&);
template void collide(int, const Shape<2>&, const BodyMotion<2>&, int, const Wall<2>&, double,
                      std::vector<ContactCandidate<2>>&);
template double separation(const Shape<2>&, const BodyMotion<2>&, const Shape<2>&, const BodyMotion<2>&);

}  // namespace obscura::sim
