// Rows of contacts and joints, and how they change by the motion alone.
//   v_c = v + w x (c - x)                               the body's matter at the point of contact c
//   row   s . (v_ca - v_cb)                             s  normal or tangent
//   drift s' . (v_ca - v_cb) + s . (w_a x (c' - v_a) - w_b x (c' - v_b))
// with c' the velocity of the point of contact and s' that of the direction: of a face w x s, between corners
// n' = (v_rel - n n . v_rel) / |p_a - p_b| and t' = -(t . n') n.

#include "sim/row.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

// a unit vector across n
template <int D>
Vec<D> across(const Vec<D>& n, int i) {
  if constexpr (D == 2) {
    return {-n[1], n[0]};
  } else {
    // away from the axis that n follows most
    int axis = 0;
    n.cwiseAbs().minCoeff(&axis);
    const Vec<D> t = Vec<D>::Unit(axis).cross(n).normalized();
    return i == 0 ? t : Vec<D>(n.cross(t));
  }
}

// how a direction and a point of contact move
template <int D>
struct Carried {
  Vec<D> n, point;          // the normal from b to a, and the point of contact
  Vec<D> n_rate, velocity;  // theirs
  bool turns_with_face;     // else as the line between two corners
  Spin<D> w;                // of the face
};

template <int D>
Carried<D> carried(const Gap<D>& gap, const Stance<D>& a, const Stance<D>& b, double& value) {
  Carried<D> c;
  const Vec<D> arm_a = a.arm(gap.on_a), arm_b = b.arm(gap.on_b);
  const Vec<D> pa = a.x + arm_a, pb = b.x + arm_b;
  if (gap.kind == Gap<D>::Kind::corners) {
    const Vec<D> d = pa - pb;
    const double l = std::sqrt(d.squaredNorm());
    c.n = l > 0 ? Vec<D>(d / l) : Vec<D>::Unit(0);
    value = l - gap.radius_a - gap.radius_b;
    const Vec<D> va = a.velocity(arm_a), rel = va - b.velocity(arm_b);
    c.n_rate = l > 0 ? Vec<D>((rel - c.n * c.n.dot(rel)) / l) : Vec<D>::Zero();
    c.point = pa - gap.radius_a * c.n;
    c.velocity = va - gap.radius_a * c.n_rate;
    c.turns_with_face = false;
    c.w = Spin<D>::Zero();
    return c;
  }
  const bool mine = gap.kind == Gap<D>::Kind::corner_of_a;  // the corner is a's, the face is b's
  const Stance<D>&corner = mine ? a : b, &face = mine ? b : a;
  const Vec<D> n = face.room_from_body * gap.normal;  // out of the face
  const Vec<D>&p = mine ? pa : pb, &q = mine ? pb : pa;
  const double radius = mine ? gap.radius_a : gap.radius_b;
  value = n.dot(p - q) - gap.radius_a - gap.radius_b;
  const Vec<D> n_rate = swing<D>(face.w, n);
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
             const Stance<D>& a, const Stance<D>& b) {
  Row<D> row;
  const Vec<D> ra = point - a.x, rb = point - b.x;
  row.along = s;
  row.turn_a = moment<D>(ra, s), row.turn_b = moment<D>(rb, s);
  row.drift = s_rate.dot(a.velocity(ra) - b.velocity(rb)) +
              s.dot(swing<D>(a.w, Vec<D>(velocity - a.v)) - swing<D>(b.w, Vec<D>(velocity - b.v)));
  return row;
}

// across a point of a and a point of b, along a direction that stays in the room
template <int D>
Row<D> between(const Vec<D>& s, const Vec<D>& arm_a, const Vec<D>& arm_b, const Stance<D>& a,
               const Stance<D>& b) {
  Row<D> row;
  row.along = s;
  row.turn_a = moment<D>(arm_a, s), row.turn_b = moment<D>(arm_b, s);
  row.drift = s.dot(swing<D>(a.w, swing<D>(a.w, arm_a)) - swing<D>(b.w, swing<D>(b.w, arm_b)));
  return row;
}

template <int D>
Row<D> turning_row(int axis) {
  Row<D> row;
  row.turn_a = Spin<D>::Unit(axis), row.turn_b = Spin<D>::Unit(axis);
  return row;
}

// a corner of a against a face of b through its point, or two corners: what rows slider, rod and rope are
template <int D>
Gap<D> gap_of(const Joint<D>& joint) {
  Gap<D> gap;
  gap.on_a = joint.a.local, gap.on_b = joint.b.local;
  gap.kind = Gap<D>::Kind::corners;
  return gap;
}

}  // namespace

template <int D>
double speed(const Row<D>& row, const std::vector<Stance<D>>& bodies) {
  double sum = 0;
  if (row.a >= 0) sum += row.along.dot(bodies[row.a].v) + row.turn_a.dot(bodies[row.a].w);
  if (row.b >= 0) sum -= row.along.dot(bodies[row.b].v) + row.turn_b.dot(bodies[row.b].w);
  return sum;
}

template <int D>
Width<D> width(const Gap<D>& gap, const Stance<D>& a, const Stance<D>& b) {
  Width<D> at;
  const Carried<D> c = carried(gap, a, b, at.value);
  at.point = c.point, at.normal = c.n;
  return at;
}

template <int D>
Width<D> rows(const Gap<D>& gap, const Stance<D>& a, const Stance<D>& b, Row<D>* out) {
  Width<D> at;
  const Carried<D> c = carried(gap, a, b, at.value);
  at.point = c.point, at.normal = c.n;
  out[0] = along<D>(c.n, c.n_rate, c.point, c.velocity, a, b);
  for (int i = 0; i < D - 1; ++i) {
    const Vec<D> t = across<D>(c.n, i);
    const Vec<D> t_rate = c.turns_with_face ? swing<D>(c.w, t) : Vec<D>(-t.dot(c.n_rate) * c.n);
    out[1 + i] = along<D>(t, t_rate, c.point, c.velocity, a, b);
  }
  for (int i = 0; i < D; ++i) out[i].a = gap.key.a, out[i].b = std::max(-1, gap.key.b);
  return at;
}

template <int D>
int rows(const Joint<D>& joint, const Stance<D>& a, const Stance<D>& b, const Spin<D>& turn, Row<D>* out,
         double* off) {
  static_assert(D == 2, "in space a weld and a slider keep an orientation");
  int n = 0;
  const Vec<D> arm_a = a.arm(joint.a.local), arm_b = b.arm(joint.b.local);
  const Vec<D> apart = (a.x + arm_a) - (b.x + arm_b);
  switch (joint.kind) {
    case JointKind::pin:
    case JointKind::weld:
      for (int axis = 0; axis < D; ++axis, ++n) {
        out[n] = between<D>(Vec<D>::Unit(axis), arm_a, arm_b, a, b);
        off[n] = apart[axis];
      }
      break;
    case JointKind::slider: {
      Gap<D> gap = gap_of(joint);
      gap.kind = Gap<D>::Kind::corner_of_a;
      gap.normal = across<D>(joint.axis, 0);
      Row<D> pair[D];
      off[n] = rows(gap, a, b, pair).value;
      out[n++] = pair[0];
      break;
    }
    case JointKind::rod:
    case JointKind::rope: {
      Row<D> pair[D];
      off[n] = rows(gap_of(joint), a, b, pair).value - joint.length;
      out[n] = pair[0];
      if (joint.kind == JointKind::rope) {
        off[n] = -off[n];
        out[n].along *= -1, out[n].turn_a *= -1, out[n].turn_b *= -1, out[n].drift *= -1;
      }
      ++n;
      break;
    }
  }
  if (joint.kind == JointKind::weld || joint.kind == JointKind::slider) {
    out[n] = turning_row<D>(0);
    off[n++] = (turn - joint.turn)[0];
  }
  for (int i = 0; i < n; ++i) out[i].a = joint.a.body, out[i].b = joint.b.body;
  return n;
}

template <int D>
bool free_row(const Joint<D>& joint, const Stance<D>& a, const Stance<D>& b, const Spin<D>& turn, Row<D>& out,
              double& way) {
  static_assert(D == 2, "in space a pin is a hinge");
  if (joint.kind == JointKind::pin) {
    out = turning_row<D>(0);
    way = (turn - joint.turn)[0];
  } else if (joint.kind == JointKind::slider) {
    Gap<D> gap = gap_of(joint);
    gap.kind = Gap<D>::Kind::corner_of_a;
    gap.normal = joint.axis;
    Row<D> pair[D];
    way = rows(gap, a, b, pair).value;
    out = pair[0];
  } else {
    return false;
  }
  out.a = joint.a.body, out.b = joint.b.body;
  return true;
}

template struct Row<2>;
template double speed<2>(const Row<2>&, const std::vector<Stance<2>>&);
template Width<2> width<2>(const Gap<2>&, const Stance<2>&, const Stance<2>&);
template Width<2> rows<2>(const Gap<2>&, const Stance<2>&, const Stance<2>&, Row<2>*);
template int rows<2>(const Joint<2>&, const Stance<2>&, const Stance<2>&, const Spin<2>&, Row<2>*, double*);
template bool free_row<2>(const Joint<2>&, const Stance<2>&, const Stance<2>&, const Spin<2>&, Row<2>&,
                          double&);

}  // namespace obscura::sim
