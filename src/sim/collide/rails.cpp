#include "sim/collide/rails.h"

#include <algorithm>
#include <cmath>

#include "sim/shape/convex_polygon.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

constexpr double kAtEnd = 1e-9;  // of the length of a curve: what is so near an end is at it

// the normal of a curve on a side of it
template <int D>
Vec<D> normal_beside(const Vec<D>& tangent, const Vec<D>& e, double side) {
  if constexpr (D == 2) {
    return side * Vec<D>(-tangent[1], tangent[0]);
  } else {
    const double far = std::sqrt(e.squaredNorm());
    return far > 0 ? Vec<D>(e / far) : perpendicular<D>(tangent);
  }
}

template <int D>
RailPlace<D> corner_place(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  const bool mine = rail_is_of_b(gap);
  const BodyMotion<D>&corner = mine ? a : b, &body = mine ? b : a;
  const double radius = mine ? gap.radius_a : gap.radius_b;
  const Vec<D> arm = corner.arm(mine ? gap.on_a : gap.on_b), p = corner.x + arm;
  const Vec<D> p_rate = corner.velocity(arm);
  RailPlace<D> it;
  it.foot = gap.curve->foot(gap.piece, Vec<D>(body.room_from_body.transpose() * (p - body.x)));
  const Vec<D> out = body.arm(it.foot.at.x), curvature = body.arm(it.foot.at.curvature);
  it.tangent = body.arm(it.foot.at.tangent);
  it.place = body.x + out;
  const Vec<D> e = p - it.place, matter = body.velocity(out);
  it.normal = normal_beside<D>(it.tangent, e, gap.side);
  it.gap = it.normal.dot(e) - radius;
  const Vec<D> u = p_rate - matter - cross_velocity<D>(body.w, e);
  it.speed = u.dot(it.tangent) / (1 - curvature.dot(e));
  if constexpr (D == 2) {
    it.normal_rate =
        cross_velocity<D>(body.w, it.normal) - (curvature.dot(it.normal) * it.speed) * it.tangent;
  } else {
    const double far = it.gap + radius;
    const Vec<D> e_rate = p_rate - matter - it.speed * it.tangent;
    it.normal_rate = far > 0 ? Vec<D>((e_rate - it.normal * it.normal.dot(e_rate)) / far) : Vec<D>::Zero();
  }
  it.point = p - radius * it.normal;
  it.point_rate = p_rate - radius * it.normal_rate;
  return it;
}

RailPlace<2> face_place(const ContactCandidate<2>& gap, const BodyMotion<2>& a, const BodyMotion<2>& b) {
  const bool mine = rail_is_of_b(gap);
  const BodyMotion<2>&face = mine ? a : b, &body = mine ? b : a;
  const Vec<2> m = face.arm(gap.normal), q = face.x + face.arm(mine ? gap.on_a : gap.on_b);
  RailPlace<2> it;
  it.foot = gap.curve->under_face(gap.piece, Vec<2>(body.room_from_body.transpose() * m));
  const Vec<2> out = body.arm(it.foot.at.x), curvature = body.arm(it.foot.at.curvature);
  it.tangent = body.arm(it.foot.at.tangent);
  it.place = it.point = body.x + out;
  it.normal = -m;
  it.gap = m.dot(it.place - q);
  const double bend = curvature.dot(Vec<2>(-it.tangent[1], it.tangent[0]));
  it.speed = (face.w[0] - body.w[0]) / bend;
  it.normal_rate = cross_velocity<2>(face.w, it.normal);
  it.point_rate = body.velocity(out) + it.speed * it.tangent;
  return it;
}

}  // namespace

template <int D>
RailPlace<D> rail_place(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  if constexpr (D == 2) {
    if (is_face_at_rail(gap)) return face_place(gap, a, b);
  }
  return corner_place(gap, a, b);
}

template <int D>
EvaluatedContact<D> evaluate_at_rail(const ContactCandidate<D>& gap, const BodyMotion<D>& a,
                                     const BodyMotion<D>& b) {
  const RailPlace<D> its = rail_place(gap, a, b);
  return {its.gap, Vec<D>(its.place + its.normal * (its.gap / 2)),
          rail_is_of_b(gap) ? its.normal : Vec<D>(-its.normal)};
}

template <int D>
bool touches_rails(const Shape<D>& shape) {
  if (D == 2) return int(support_vertices(shape).size()) <= RailFeature::kVertices;
  if (is_point(shape)) return false;
  for (int i = 0; i < parts(shape); ++i)
    if (!form<Ball<D>>(part(shape, i))) return false;
  return parts(shape) <= RailFeature::kVertices;
}

namespace {

// one body and one rail, of which gaps are collected
template <int D>
struct RailCollision {
  using Kind = typename ContactCandidate<D>::Kind;

  int a, b, number;
  const Rail<D>& rail;
  double margin, scale;
  Vec<D> middle;  // of the body, in the rail's frame: a corner touches where that is in front of the rail too
  bool round;     // one vertex is all of it
  std::vector<ContactCandidate<D>>& out;

  // a gap between a feature of a and one of b's rail, as if a came first
  void add(ContactCandidate<D> made, const RailFeature& feature, Kind mine, Kind other, const Vec<D>& on_a,
           double radius, const Vec<D>& on_rail, double value) const {
    if (!(value < margin && value > -deepest_in_rail(radius, scale))) return;
    made.key = {std::min(a, b), std::max(a, b), feature.packed()};
    made.kind = a < b ? mine : other;
    made.on_a = a < b ? on_a : on_rail, made.on_b = a < b ? on_rail : on_a;
    made.radius_a = a < b ? radius : 0, made.radius_b = a < b ? 0 : radius;
    made.value = value;
    out.push_back(made);
  }

  bool has(double side) const { return D == 3 || (side > 0 ? rail.left : rail.right); }

  void corner(int vertex, const SupportVertex<D>& tip, const Vec<D>& p) const {
    const Curve<D>& curve = *rail.curve;
    RailFeature feature{number, 0, vertex};
    std::vector<typename Curve<D>::Foot> feet;
    curve.feet(p, tip.radius + std::max(margin, 0.0), feet);
    for (const typename Curve<D>::Foot& foot : feet) {
      ContactCandidate<D> made;
      made.curve = &curve, made.piece = feature.piece = foot.piece;
      const Vec<D> e = p - foot.at.x;
      for (const double side : {1.0, -1.0}) {
        if (!has(side) || (D == 3 && side < 0)) continue;
        const Vec<D> n = normal_beside<D>(foot.at.tangent, e, side);
        if (!round && !(n.dot(middle - foot.at.x) > 0)) continue;
        made.side = D == 2 ? side : 0, feature.left = side > 0;
        add(made, feature, Kind::corner_at_rail_b, Kind::corner_at_rail_a, tip.at, tip.radius, foot.at.x,
            n.dot(e) - tip.radius);
      }
    }
    if (curve.closed() || tip.radius == 0) return;
    // beyond an open end
    for (const int end : {1, 2}) {
      const int piece = end == 1 ? 0 : curve.size() - 1;
      const auto last = curve.at(piece, end == 1 ? 0 : curve.piece(piece).end);
      const Vec<D> e = p - last.x;
      if ((end == 1 ? -1 : 1) * e.dot(last.tangent) < -kAtEnd * curve.length()) continue;
      if constexpr (D == 2) {
        feature.left = e.dot(normal_beside<D>(last.tangent, e, 1)) >= 0;
        if (!has(feature.left ? 1 : -1)) continue;
      }
      feature.piece = piece, feature.end = end;
      add({}, feature, Kind::corners, Kind::corners, tip.at, tip.radius, last.x,
          std::sqrt(e.squaredNorm()) - tip.radius);
      feature.end = 0;
    }
  }

  // a face from one corner to another, in the body's frame; `at` how that stands in the rail's
  void face(int vertex, const Vec<2>& from, const Vec<2>& to, const Vec<2>& normal,
            const RelativePose& at) const {
    const Curve<2>& curve = *rail.curve;
    const Vec<2> m = at.turn * normal, q = at * from, t(-m[1], m[0]);
    const double length = std::sqrt((to - from).squaredNorm()), reach = length + std::max(margin, 0.0);
    RailFeature feature{number, 0, RailFeature::kVertices + vertex};
    const auto over = [&](const Vec<2>& x) {
      const double along = t.dot(x - q);
      return along > 0 && along < length;
    };
    std::vector<typename Curve<2>::Foot> feet;
    curve.under_faces(m, q, reach, feet);
    for (const typename Curve<2>::Foot& foot : feet) {
      const double side = normal_beside<2>(foot.at.tangent, m, 1).dot(m) < 0 ? 1 : -1;
      if (!has(side) || !over(foot.at.x)) continue;
      ContactCandidate<2> made;
      made.curve = &curve, made.piece = feature.piece = foot.piece;
      made.normal = normal, made.side = side, feature.left = side > 0;
      add(made, feature, Kind::face_at_rail_b, Kind::face_at_rail_a, from, 0, foot.at.x,
          m.dot(foot.at.x - q));
    }
    if (curve.closed()) return;
    // an end of the curve at the face
    for (const int end : {1, 2}) {
      const int piece = end == 1 ? 0 : curve.size() - 1;
      const auto last = curve.at(piece, end == 1 ? 0 : curve.piece(piece).end);
      const double off = normal_beside<2>(last.tangent, m, 1).dot(m),
                   onward = (end == 1 ? -1 : 1) * last.tangent.dot(m);
      // the face looks against the side, or against the end
      const double side = off < 0 ? 1 : -1;
      if (!over(last.x) || !has(side) || !(onward < 1e-9)) continue;
      ContactCandidate<2> made;
      made.normal = normal, feature.left = side > 0, feature.piece = piece, feature.end = end;
      add(made, feature, Kind::corner_of_b, Kind::corner_of_a, from, 0, last.x, m.dot(last.x - q));
      feature.end = 0;
    }
  }
};

}  // namespace

template <int D>
void collide_rail(int a, const Shape<D>& shape, const BodyMotion<D>& at, int b, int number,
                  const Rail<D>& rail, const BodyMotion<D>& rail_at, double margin, double scale,
                  std::vector<ContactCandidate<D>>& out) {
  const std::vector<SupportVertex<D>> vertices = support_vertices(shape);
  const Vec<D> middle = rail_at.room_from_body.transpose() * (at.x - rail_at.x);
  const RailCollision<D> collision{a,  b, number, rail, margin, scale, middle, D == 3 || vertices.size() == 1,
                                   out};
  int vertex = 0;
  for (const SupportVertex<D>& tip : vertices) {
    const Vec<D> p = rail_at.room_from_body.transpose() * (at.x + at.arm(tip.at) - rail_at.x);
    collision.corner(vertex++, tip, p);
  }
  if constexpr (D == 2) {
    const RelativePose lies = relative_pose(at, rail_at);
    int face = 0;
    for (int i = 0; i < parts(shape); ++i) {
      const ConvexPolygon polygon(part(shape, i));
      for (int k = 0; k < polygon.faces(); ++k)
        collision.face(face++, polygon.corner(k), polygon.corner(polygon.next(k)), polygon.normal(k), lies);
    }
  }
}

#define OBSCURA_INSTANTIATE(D)                                                                        \
  template RailPlace<D> rail_place<D>(const ContactCandidate<D>&, const BodyMotion<D>&,               \
                                      const BodyMotion<D>&);                                          \
  template EvaluatedContact<D> evaluate_at_rail<D>(const ContactCandidate<D>&, const BodyMotion<D>&,  \
                                                   const BodyMotion<D>&);                             \
  template bool touches_rails<D>(const Shape<D>&);                                                    \
  template void collide_rail<D>(int, const Shape<D>&, const BodyMotion<D>&, int, int, const Rail<D>&, \
                                const BodyMotion<D>&, double, double, std::vector<ContactCandidate<D>>&)
OBSCURA_INSTANTIATE(2);
OBSCURA_INSTANTIATE(3);
#undef OBSCURA_INSTANTIATE

}  // namespace obscura::sim
