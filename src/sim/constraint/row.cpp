// Rows of contacts, and their velocity-product terms.
//   v_c = v + w x (c - x)                               the body's matter at the point of contact c
//   row   s . (v_ca - v_cb)                             s  normal or tangent
//   J' v  s' . (v_ca - v_cb) + s . (w_a x (c' - v_a) - w_b x (c' - v_b))
// with c' the velocity of the point of contact and s' that of the direction: for a face w x s; between
// vertices n' = (v_rel - n n . v_rel) / |p_a - p_b| and t' = -(t . n') n. A vertex at an edge is treated as
// one at its foot on the edge, which moves along. For edges that cross, u = e_a x e_b and n = u / |u|:
//   n' = (u' - n n . u') / |u|,  u' = e_a' x e_b + e_a x e_b',  e' = w x e
//   c = p_a + s e_a,  s = (c_ab d . e_b - d . e_a) / |u|^2,  c_ab = e_a . e_b,  d = p_a - p_b

#include "sim/constraint/row.h"

#include <algorithm>
#include <cmath>

#include "sim/collide/rails.h"

namespace obscura::sim {

namespace {

// how a direction and a point of contact move
template <int D>
struct Carried {
  Vec<D> n, point;          // the normal from b to a, and the point of contact
  Vec<D> n_rate, velocity;  // theirs
  bool turns_with_face;     // else as the line between two corners
  AngularVec<D> w;          // of the face
};

// between two points that move: corners, or a corner and the foot of it on an edge
template <int D>
Carried<D> between_points(const ContactCandidate<D>& gap, const Vec<D>& pa, const Vec<D>& va,
                          const Vec<D>& pb, const Vec<D>& vb, const Vec<D>& if_none, double& value) {
  Carried<D> c;
  const Vec<D> d = pa - pb, rel = va - vb;
  const double l = std::sqrt(d.squaredNorm());
  c.n = l > 0 ? Vec<D>(d / l) : if_none;
  value = l - gap.radius_a - gap.radius_b;
  c.n_rate = l > 0 ? Vec<D>((rel - c.n * c.n.dot(rel)) / l) : Vec<D>::Zero();
  c.point = pa - gap.radius_a * c.n;
  c.velocity = va - gap.radius_a * c.n_rate;
  c.turns_with_face = false;
  c.w = AngularVec<D>::Zero();
  return c;
}

// the foot of a point on an edge through p, and how it moves
template <int D>
void foot(const Vec<D>& point, const Vec<D>& velocity, const Vec<D>& edge, const AngularVec<D>& w, Vec<D>& p,
          Vec<D>& v) {
  const Vec<D> d = point - p, edge_rate = cross_velocity<D>(w, edge);
  const double s = edge.dot(d), s_rate = edge_rate.dot(d) + edge.dot(velocity - v);
  p += s * edge;
  v += s_rate * edge + s * edge_rate;
}

Carried<3> between_edges(const ContactCandidate<3>& gap, const BodyMotion<3>& a, const BodyMotion<3>& b,
                         const Vec<3>& pa, const Vec<3>& va, const Vec<3>& pb, const Vec<3>& vb,
                         double& value) {
  const Vec<3> ea = a.arm(gap.edge_a), eb = b.arm(gap.edge_b), u = ea.cross(eb);
  const Vec<3> ea_rate = a.w.cross(ea), eb_rate = b.w.cross(eb), d = pa - pb, d_rate = va - vb;
  const double sine2 = u.squaredNorm(), sine = std::sqrt(sine2);
  Carried<3> c;
  c.n = u / sine;
  value = c.n.dot(d) - gap.radius_a - gap.radius_b;
  const Vec<3> u_rate = ea_rate.cross(eb) + ea.cross(eb_rate);
  c.n_rate = (u_rate - c.n * c.n.dot(u_rate)) / sine;

  // the point of a's edge that is nearest
  const double cosine = ea.dot(eb), da = d.dot(ea), db = d.dot(eb);
  const double s = (cosine * db - da) / sine2;
  const double cosine_rate = ea_rate.dot(eb) + ea.dot(eb_rate);
  const double top_rate =
      cosine_rate * db + cosine * (d_rate.dot(eb) + d.dot(eb_rate)) - (d_rate.dot(ea) + d.dot(ea_rate));
  const double s_rate = (top_rate - s * 2 * u.dot(u_rate)) / sine2;
  c.point = pa + s * ea - gap.radius_a * c.n;
  c.velocity = va + s_rate * ea + s * ea_rate - gap.radius_a * c.n_rate;
  c.turns_with_face = false;
  c.w.setZero();
  return c;
}

// between a corner or face and a rail
template <int D>
Carried<D> on_rail(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                   double& value) {
  const bool mine = rail_is_of_b(gap);
  const RailPlace<D> its = rail_place(gap, a, b);
  Carried<D> c;
  value = its.gap;
  c.n = mine ? its.normal : Vec<D>(-its.normal);
  c.n_rate = mine ? its.normal_rate : Vec<D>(-its.normal_rate);
  c.point = its.point, c.velocity = its.point_rate;
  c.turns_with_face = is_face_at_rail(gap);
  c.w = mine ? a.w : b.w;
  return c;
}

template <int D>
Carried<D> carried(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                   double& value) {
  using Kind = typename ContactCandidate<D>::Kind;
  const Vec<D> arm_a = a.arm(gap.on_a), arm_b = b.arm(gap.on_b);
  Vec<D> pa = a.x + arm_a, pb = b.x + arm_b;
  if (rail_is_of_b(gap) || rail_is_of_a(gap)) return on_rail(gap, a, b, value);
  if (gap.kind != Kind::corner_of_a && gap.kind != Kind::corner_of_b) {
    Vec<D> va = a.velocity(arm_a), vb = b.velocity(arm_b), if_none = Vec<D>::Unit(0);
    if constexpr (D == 3) {
      if (gap.kind == Kind::edges) return between_edges(gap, a, b, pa, va, pb, vb, value);
    }
    if (gap.kind == Kind::corner_at_edge_b) {
      const Vec<D> edge = b.arm(gap.edge_b);
      foot<D>(pa, va, edge, b.w, pb, vb), if_none = perpendicular<D>(edge);
    } else if (gap.kind == Kind::corner_at_edge_a) {
      const Vec<D> edge = a.arm(gap.edge_a);
      foot<D>(pb, vb, edge, a.w, pa, va), if_none = perpendicular<D>(edge);
    }
    return between_points(gap, pa, va, pb, vb, if_none, value);
  }
  Carried<D> c;
  const bool mine = gap.kind == Kind::corner_of_a;  // the corner is a's, the face is b's
  const BodyMotion<D>&corner = mine ? a : b, &face = mine ? b : a;
  const Vec<D> n = face.room_from_body * gap.normal;  // out of the face
  const Vec<D>&p = mine ? pa : pb, &q = mine ? pb : pa;
  const double radius = mine ? gap.radius_a : gap.radius_b;
  value = n.dot(p - q) - gap.radius_a - gap.radius_b;
  const Vec<D> n_rate = cross_velocity<D>(face.w, n);
  c.point = p - radius * n;
  c.velocity = corner.velocity(mine ? arm_a : arm_b) - radius * n_rate;
  c.n = mine ? n : Vec<D>(-n);
  c.n_rate = mine ? n_rate : Vec<D>(-n_rate);
  c.turns_with_face = true;
  c.w = face.w;
  return c;
}

template <int D>
Row<D> along(const Vec<D>& s, const Vec<D>& s_rate, const Vec<D>& point, const Vec<D>& velocity,
             const BodyMotion<D>& a, const BodyMotion<D>& b) {
  Row<D> row;
  const Vec<D> ra = point - a.x, rb = point - b.x;
  row.along = s;
  row.angular_a = moment<D>(ra, s), row.angular_b = moment<D>(rb, s);
  row.velocity_product =
      s_rate.dot(a.velocity(ra) - b.velocity(rb)) +
      s.dot(cross_velocity<D>(a.w, Vec<D>(velocity - a.v)) - cross_velocity<D>(b.w, Vec<D>(velocity - b.v)));
  return row;
}

}  // namespace

template <int D>
double speed(const Row<D>& row, const std::vector<BodyMotion<D>>& bodies) {
  double sum = row.drift;
  if (row.a >= 0) sum += row.along.dot(bodies[row.a].v) + row.angular_a.dot(bodies[row.a].w);
  if (row.b >= 0) sum -= row.along.dot(bodies[row.b].v) + row.angular_b.dot(bodies[row.b].w);
  for (const RowSide<D>& side : row.more)
    sum += side.along.dot(bodies[side.body].v) + side.angular.dot(bodies[side.body].w);
  return sum;
}

template <int D>
EvaluatedContact<D> rows(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                         Row<D>* out) {
  EvaluatedContact<D> at;
  const Carried<D> c = carried(gap, a, b, at.value);
  at.point = c.point, at.normal = c.n;
  out[0] = along<D>(c.n, c.n_rate, c.point, c.velocity, a, b);
  for (int i = 0; i < D - 1; ++i) {
    const Vec<D> t = tangent<D>(c.n, i);
    const Vec<D> t_rate = c.turns_with_face ? cross_velocity<D>(c.w, t) : Vec<D>(-t.dot(c.n_rate) * c.n);
    out[1 + i] = along<D>(t, t_rate, c.point, c.velocity, a, b);
  }
  for (int i = 0; i < D; ++i) out[i].a = gap.key.a, out[i].b = std::max(-1, gap.key.b);
  return at;
}

template <int D>
Vec<D> belt_velocity(const Body<D>& body, const Rotation<D>& room_from_body, const Vec<D>& outward) {
  if constexpr (D == 2) {
    return body.belt[0] * Vec<D>(outward[1], -outward[0]);
  } else {
    const Vec<D> u = room_from_body * body.belt;
    return u - outward * outward.dot(u);
  }
}

// The direction of a belt turns with its face. Where a round body rolls over a round one the normal turns
// besides; that part of J' v is left out.
template <int D>
void add_belts(const Model<D>& model, const ContactKey& key, const std::vector<BodyMotion<D>>& bodies,
               Row<D>* out) {
  Vec<D> u = Vec<D>::Zero();
  const Vec<D>& n = out[0].along;
  const auto add = [&](int body, double sign) {
    if (body < 0 || model.bodies[std::size_t(body)].belt.isZero(0)) return;
    u += sign * belt_velocity<D>(model.bodies[std::size_t(body)], bodies[std::size_t(body)].room_from_body,
                                 Vec<D>(-sign * n));
  };
  add(key.a, 1), add(key.b, -1);
  for (int i = 1; i < D; ++i) out[i].drift = out[i].along.dot(u);
}

template struct Row<2>;
template double speed<2>(const Row<2>&, const std::vector<BodyMotion<2>>&);
template EvaluatedContact<2> rows<2>(const ContactCandidate<2>&, const BodyMotion<2>&, const BodyMotion<2>&,
                                     Row<2>*);
template Vec<2> belt_velocity<2>(const Body<2>&, const Rotation<2>&, const Vec<2>&);
template Vec<3> belt_velocity<3>(const Body<3>&, const Rotation<3>&, const Vec<3>&);
template void add_belts<2>(const Model<2>&, const ContactKey&, const std::vector<BodyMotion<2>>&, Row<2>*);
template void add_belts<3>(const Model<3>&, const ContactKey&, const std::vector<BodyMotion<3>>&, Row<3>*);
template struct Row<3>;
template double speed<3>(const Row<3>&, const std::vector<BodyMotion<3>>&);
template EvaluatedContact<3> rows<3>(const ContactCandidate<3>&, const BodyMotion<3>&, const BodyMotion<3>&,
                                     Row<3>*);

}  // namespace obscura::sim
