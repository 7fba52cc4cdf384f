#include "sim/collide/rails.h"

#include <algorithm>
#include <cmath>

#include "sim/shape/shape.h"

namespace obscura::sim {

namespace {

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

}  // namespace

template <int D>
RailPlace<D> rail_place(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  const bool mine = gap.kind == ContactCandidate<D>::Kind::corner_at_rail_b;
  const BodyMotion<D>&corner = mine ? a : b, &body = mine ? b : a;
  const double radius = mine ? gap.radius_a : gap.radius_b;
  const Vec<D> arm = corner.arm(mine ? gap.on_a : gap.on_b), p = corner.x + arm;
  const Vec<D> p_rate = corner.velocity(arm);
  RailPlace<D> it;
  it.foot = gap.curve->foot(gap.piece, Vec<D>(body.room_from_body.transpose() * (p - body.x)));
  const Vec<D> out = body.arm(it.foot.at.x);
  it.tangent = body.arm(it.foot.at.tangent), it.curvature = body.arm(it.foot.at.curvature);
  it.place = body.x + out;
  const Vec<D> e = p - it.place, matter = body.velocity(out);
  it.normal = normal_beside<D>(it.tangent, e, gap.side);
  it.gap = it.normal.dot(e) - radius;
  const Vec<D> u = p_rate - matter - cross_velocity<D>(body.w, e);
  it.speed = u.dot(it.tangent) / (1 - it.curvature.dot(e));
  it.place_rate = matter + it.speed * it.tangent;
  if constexpr (D == 2) {
    it.normal_rate =
        cross_velocity<D>(body.w, it.normal) - (it.curvature.dot(it.normal) * it.speed) * it.tangent;
  } else {
    const double far = it.gap + radius;
    const Vec<D> e_rate = p_rate - it.place_rate;
    it.normal_rate = far > 0 ? Vec<D>((e_rate - it.normal * it.normal.dot(e_rate)) / far) : Vec<D>::Zero();
  }
  return it;
}

template <int D>
EvaluatedContact<D> evaluate_at_rail(const ContactCandidate<D>& gap, const BodyMotion<D>& a,
                                     const BodyMotion<D>& b) {
  const bool mine = gap.kind == ContactCandidate<D>::Kind::corner_at_rail_b;
  const RailPlace<D> its = rail_place(gap, a, b);
  return {its.gap, Vec<D>(its.place + its.normal * (its.gap / 2)), mine ? its.normal : Vec<D>(-its.normal)};
}

template <int D>
bool touches_rails(const Shape<D>& shape) {
  if (is_point(shape)) return D == 2;
  for (int i = 0; i < parts(shape); ++i)
    if (!form<Ball<D>>(part(shape, i))) return false;
  return parts(shape) <= RailFeature::kVertices;
}

template <int D>
void collide_rail(int a, const Shape<D>& shape, const BodyMotion<D>& at, int b, int number,
                  const Rail<D>& rail, const BodyMotion<D>& rail_at, double margin, double scale,
                  std::vector<ContactCandidate<D>>& out) {
  using Kind = typename ContactCandidate<D>::Kind;
  const Curve<D>& curve = *rail.curve;
  std::vector<SupportVertex<D>> vertices = support_vertices(shape);
  std::vector<typename Curve<D>::Foot> feet;
  for (int vertex = 0; vertex < int(vertices.size()); ++vertex) {
    const SupportVertex<D>& tip = vertices[std::size_t(vertex)];
    const Vec<D> p = rail_at.room_from_body.transpose() * (at.x + at.arm(tip.at) - rail_at.x);
    const double deepest = deepest_in_rail(tip.radius, scale);
    ContactCandidate<D> made;
    RailFeature feature{number, 0, vertex};
    const auto add = [&](Kind mine, Kind other, const Vec<D>& on_rail, double value) {
      if (!(value < margin && value > -deepest)) return;
      made.key = {std::min(a, b), std::max(a, b), feature.packed()};
      made.kind = a < b ? mine : other;
      made.on_a = a < b ? tip.at : on_rail, made.on_b = a < b ? on_rail : tip.at;
      made.radius_a = a < b ? tip.radius : 0, made.radius_b = a < b ? 0 : tip.radius;
      made.value = value;
      out.push_back(made);
    };
    feet.clear();
    curve.feet(p, tip.radius + std::max(margin, 0.0), feet);
    for (const typename Curve<D>::Foot& foot : feet) {
      made.curve = &curve, made.piece = feature.piece = foot.piece;
      const Vec<D> e = p - foot.at.x;
      for (const double side : {1.0, -1.0}) {
        if (D == 2 ? !(side > 0 ? rail.left : rail.right) : side < 0) continue;
        const Vec<D> n = normal_beside<D>(foot.at.tangent, e, side);
        made.side = D == 2 ? side : 0, feature.left = side > 0;
        add(Kind::corner_at_rail_b, Kind::corner_at_rail_a, foot.at.x, n.dot(e) - tip.radius);
      }
    }
    if (curve.closed() || tip.radius == 0) continue;
    // beyond an open end
    made.curve = nullptr, made.side = 0;
    for (const int end : {1, 2}) {
      const int piece = end == 1 ? 0 : curve.size() - 1;
      const auto last = curve.at(piece, end == 1 ? 0 : curve.piece(piece).end);
      const Vec<D> e = p - last.x;
      if ((end == 1 ? -1 : 1) * e.dot(last.tangent) < 0) continue;
      if constexpr (D == 2) {
        const double off = e.dot(normal_beside<D>(last.tangent, e, 1));
        if (!(off >= 0 ? rail.left : rail.right)) continue;
        feature.left = off >= 0;
      }
      feature.piece = piece, feature.end = end;
      add(Kind::corners, Kind::corners, last.x, std::sqrt(e.squaredNorm()) - tip.radius);
      feature.end = 0;
    }
  }
}

template RailPlace<2> rail_place<2>(const ContactCandidate<2>&, const BodyMotion<2>&, const BodyMotion<2>&);
template RailPlace<3> rail_place<3>(const ContactCandidate<3>&, const BodyMotion<3>&, const BodyMotion<3>&);
template EvaluatedContact<2> evaluate_at_rail<2>(const ContactCandidate<2>&, const BodyMotion<2>&,
                                                 const BodyMotion<2>&);
template EvaluatedContact<3> evaluate_at_rail<3>(const ContactCandidate<3>&, const BodyMotion<3>&,
                                                 const BodyMotion<3>&);
template bool touches_rails<2>(const Shape<2>&);
template bool touches_rails<3>(const Shape<3>&);
template void collide_rail<2>(int, const Shape<2>&, const BodyMotion<2>&, int, int, const Rail<2>&,
                              const BodyMotion<2>&, double, double, std::vector<ContactCandidate<2>>&);
template void collide_rail<3>(int, const Shape<3>&, const BodyMotion<3>&, int, int, const Rail<3>&,
                              const BodyMotion<3>&, double, double, std::vector<ContactCandidate<3>>&);

}  // namespace obscura::sim
