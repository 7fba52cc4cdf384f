// Rows of contacts and joints, and how they change by the motion alone.
//   v_c = v + w x (c - x)                               the body's matter at the point of contact c
//   row   s . (v_ca - v_cb)                             s  normal or tangent
//   drift s' . (v_ca - v_cb) + s . (w_a x (c' - v_a) - w_b x (c' - v_b))
// with c' the velocity of the point of contact and s' that of the direction: of a face w x s, between corners
// n' = (v_rel - n n . v_rel) / |p_a - p_b| and t' = -(t . n') n. A corner at an edge is one at the foot of it
// on the edge, which moves along. Of edges that cross, u = e_a x e_b and n = u / |u|:
//   n' = (u' - n n . u') / |u|,  u' = e_a' x e_b + e_a x e_b',  e' = w x e
//   c = p_a + s e_a,  s = (c_ab d . e_b - d . e_a) / |u|^2,  c_ab = e_a . e_b,  d = p_a - p_b

#include "sim/constraint/row.h"

#include <algorithm>
#include <cmath>

#include "sim/math/exponential.h"

namespace obscura::sim {

namespace {

// a unit vector across n
template <int D>
Vec<D> across(const Vec<D>& n, int i) {
  if constexpr (D == 2) {
    return perpendicular<D>(n);
  } else {
    const Vec<D> t = perpendicular<D>(n);
    return i == 0 ? t : Vec<D>(n.cross(t));
  }
}

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

template <int D>
Carried<D> carried(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                   double& value) {
  using Kind = typename ContactCandidate<D>::Kind;
  const Vec<D> arm_a = a.arm(gap.on_a), arm_b = b.arm(gap.on_b);
  Vec<D> pa = a.x + arm_a, pb = b.x + arm_b;
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

// across a point of a and a point of b, along a direction that stays in the room
template <int D>
Row<D> between(const Vec<D>& s, const Vec<D>& arm_a, const Vec<D>& arm_b, const BodyMotion<D>& a,
               const BodyMotion<D>& b) {
  Row<D> row;
  row.along = s;
  row.angular_a = moment<D>(arm_a, s), row.angular_b = moment<D>(arm_b, s);
  row.velocity_product = s.dot(cross_velocity<D>(a.w, cross_velocity<D>(a.w, arm_a)) -
                               cross_velocity<D>(b.w, cross_velocity<D>(b.w, arm_b)));
  return row;
}

template <int D>
Row<D> turning_row(int axis) {
  Row<D> row;
  row.angular_a = AngularVec<D>::Unit(axis), row.angular_b = AngularVec<D>::Unit(axis);
  return row;
}

// a corner of a against a face of b through its point, or two corners: what rows slider, rod and rope are
template <int D>
ContactCandidate<D> gap_of(const Joint<D>& joint) {
  ContactCandidate<D> gap;
  gap.on_a = joint.a.local, gap.on_b = joint.b.local;
  gap.kind = ContactCandidate<D>::Kind::corners;
  return gap;
}

// the way of a's point against b's along a direction of b's frame
template <int D>
Row<D> way_row(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b, const Vec<D>& direction,
               double& way) {
  ContactCandidate<D> gap = gap_of(joint);
  gap.kind = ContactCandidate<D>::Kind::corner_of_a;
  gap.normal = direction;
  Row<D> all[D];
  way = rows(gap, a, b, all).value;
  return all[0];
}

// an axis of a against one of b that should be across it: J v = (A x B) . (w_a - w_b), off A . B
Row<3> across_row(const BodyMotion<3>& a, const BodyMotion<3>& b, const Vec<3>& axis_a, const Vec<3>& axis_b,
                  double& off) {
  Row<3> row;
  const Vec<3> turn = axis_a.cross(axis_b);
  row.angular_a = turn, row.angular_b = turn;
  row.velocity_product = (a.w.cross(axis_a).cross(axis_b) + axis_a.cross(b.w.cross(axis_b))).dot(a.w - b.w);
  off = axis_a.dot(axis_b);
  return row;
}

// b's frame turned by what the joint keeps, as a would stand
Rotation<3> kept(const Joint<3>& joint, const BodyMotion<3>& b) {
  return b.room_from_body * matrix(exponential(joint.turn));
}

// all that two bodies turn against each other, and how far a is turned off: of E = R_a R_kept' the part that
// is a turn about an axis, sin(angle) axis
template <int D>
void turning_rows(const Joint<D>& joint, [[maybe_unused]] const BodyMotion<D>& a,
                  [[maybe_unused]] const BodyMotion<D>& b, [[maybe_unused]] const AngularVec<D>& turn,
                  Row<D>* out, double* off) {
  for (int axis = 0; axis < kAngular<D>; ++axis) out[axis] = turning_row<D>(axis);
  if constexpr (D == 2) {
    off[0] = (turn - joint.turn)[0];
  } else {
    const Rotation<3> e = a.room_from_body * kept(joint, b).transpose();
    off[0] = 0.5 * (e(2, 1) - e(1, 2)), off[1] = 0.5 * (e(0, 2) - e(2, 0)),
    off[2] = 0.5 * (e(1, 0) - e(0, 1));
  }
}

// angle whose sine and cosine are given
double angle(double sine, double cosine) {
  // half of it about the third axis
  const double half = std::sqrt(0.5 * std::max(0.0, 1 + std::fabs(cosine)));
  Eigen::Vector4d q(0, 0, 0, 0);
  if (cosine >= 0) {
    q[3] = half, q[2] = 0.5 * sine / half;
  } else {
    q[2] = sine < 0 ? -half : half, q[3] = 0.5 * std::fabs(sine) / half;
  }
  return logarithm(q)[2];
}

}  // namespace

template <int D>
double speed(const Row<D>& row, const std::vector<BodyMotion<D>>& bodies) {
  double sum = 0;
  if (row.a >= 0) sum += row.along.dot(bodies[row.a].v) + row.angular_a.dot(bodies[row.a].w);
  if (row.b >= 0) sum -= row.along.dot(bodies[row.b].v) + row.angular_b.dot(bodies[row.b].w);
  return sum;
}

template <int D>
EvaluatedContact<D> width(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b) {
  EvaluatedContact<D> at;
  const Carried<D> c = carried(gap, a, b, at.value);
  at.point = c.point, at.normal = c.n;
  return at;
}

template <int D>
EvaluatedContact<D> rows(const ContactCandidate<D>& gap, const BodyMotion<D>& a, const BodyMotion<D>& b,
                         Row<D>* out) {
  EvaluatedContact<D> at;
  const Carried<D> c = carried(gap, a, b, at.value);
  at.point = c.point, at.normal = c.n;
  out[0] = along<D>(c.n, c.n_rate, c.point, c.velocity, a, b);
  for (int i = 0; i < D - 1; ++i) {
    const Vec<D> t = across<D>(c.n, i);
    const Vec<D> t_rate = c.turns_with_face ? cross_velocity<D>(c.w, t) : Vec<D>(-t.dot(c.n_rate) * c.n);
    out[1 + i] = along<D>(t, t_rate, c.point, c.velocity, a, b);
  }
  for (int i = 0; i < D; ++i) out[i].a = gap.key.a, out[i].b = std::max(-1, gap.key.b);
  return at;
}

template <int D>
int rows(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b, const AngularVec<D>& turn,
         Row<D>* out, double* off) {
  int n = 0;
  const Vec<D> arm_a = a.arm(joint.a.local), arm_b = b.arm(joint.b.local);
  const Vec<D> apart = (a.x + arm_a) - (b.x + arm_b);
  switch (joint.kind) {
    case JointKind::pin:
    case JointKind::weld:
    case JointKind::hinge:
      for (int axis = 0; axis < D; ++axis, ++n) {
        out[n] = between<D>(Vec<D>::Unit(axis), arm_a, arm_b, a, b);
        off[n] = apart[axis];
      }
      break;
    case JointKind::slider:
      for (int i = 0; i < D - 1; ++i, ++n) {
        out[n] = way_row<D>(joint, a, b, across<D>(joint.axis, i), off[n]);
      }
      break;
    case JointKind::rod:
    case JointKind::rope: {
      Row<D> pair[D];
      off[n] = rows(gap_of(joint), a, b, pair).value - joint.length;
      out[n] = pair[0];
      if (joint.kind == JointKind::rope) {
        off[n] = -off[n];
        out[n].along *= -1, out[n].angular_a *= -1, out[n].angular_b *= -1, out[n].velocity_product *= -1;
      }
      ++n;
      break;
    }
  }
  if (joint.kind == JointKind::weld || joint.kind == JointKind::slider) {
    turning_rows<D>(joint, a, b, turn, out + n, off + n);
    n += kAngular<D>;
  }
  if constexpr (D == 3) {
    if (joint.kind == JointKind::hinge) {
      const Vec<D> axis_a = a.room_from_body * (matrix(exponential(joint.turn)).transpose() * joint.axis);
      for (int i = 0; i < 2; ++i, ++n) {
        out[n] = across_row(a, b, axis_a, b.arm(across<D>(joint.axis, i)), off[n]);
      }
    }
  }
  for (int i = 0; i < n; ++i) out[i].a = joint.a.body, out[i].b = joint.b.body;
  return n;
}

template <int D>
bool free_row(const Joint<D>& joint, const BodyMotion<D>& a, const BodyMotion<D>& b,
              [[maybe_unused]] const AngularVec<D>& turn, Row<D>& out, double& way) {
  if (!has_free_row<D>(joint.kind)) return false;
  if (joint.kind == JointKind::slider) {
    out = way_row<D>(joint, a, b, joint.axis, way);
  } else if constexpr (D == 2) {
    out = turning_row<D>(0);
    way = (turn - joint.turn)[0];
  } else {
    const Vec<D> axis = b.arm(joint.axis), aside = across<D>(joint.axis, 0);
    out = Row<D>();
    out.angular_a = axis, out.angular_b = axis;
    out.velocity_product = b.w.cross(axis).dot(a.w - b.w);
    const Vec<D> from = b.arm(aside);
    const Vec<D> to = a.room_from_body * (matrix(exponential(joint.turn)).transpose() * aside);
    way = angle(axis.dot(from.cross(to)), from.dot(to));
  }
  out.a = joint.a.body, out.b = joint.b.body;
  return true;
}

template struct Row<2>;
template double speed<2>(const Row<2>&, const std::vector<BodyMotion<2>>&);
template EvaluatedContact<2> width<2>(const ContactCandidate<2>&, const BodyMotion<2>&, const BodyMotion<2>&);
template EvaluatedContact<2> rows<2>(const ContactCandidate<2>&, const BodyMotion<2>&, const BodyMotion<2>&,
                                     Row<2>*);
template int rows<2>(const Joint<2>&, const BodyMotion<2>&, const BodyMotion<2>&, const AngularVec<2>&,
                     Row<2>*, double*);
template bool free_row<2>(const Joint<2>&, const BodyMotion<2>&, const BodyMotion<2>&, const AngularVec<2>&,
                          Row<2>&, double&);
template struct Row<3>;
template double speed<3>(const Row<3>&, const std::vector<BodyMotion<3>>&);
template EvaluatedContact<3> width<3>(const ContactCandidate<3>&, const BodyMotion<3>&, const BodyMotion<3>&);
template EvaluatedContact<3> rows<3>(const ContactCandidate<3>&, const BodyMotion<3>&, const BodyMotion<3>&,
                                     Row<3>*);
template int rows<3>(const Joint<3>&, const BodyMotion<3>&, const BodyMotion<3>&, const AngularVec<3>&,
                     Row<3>*, double*);
template bool free_row<3>(const Joint<3>&, const BodyMotion<3>&, const BodyMotion<3>&, const AngularVec<3>&,
                          Row<3>&, double&);

}  // namespace obscura::sim
