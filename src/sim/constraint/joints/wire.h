#pragma once

// Wire: a point of a stays on a curve of b, as a bead that is threaded.
//   C    = n_i . e,  e = x_a + r_a - c             c    the curve's place nearest to the point: T . e = 0
//   J    = [ n_i  r_a x n_i  -n_i  -(r x n_i) ]    n_i  the D-1 directions across the tangent T; r from x_b
//   J' v = n_i' . u + n_i . (w_a x (w_a x r_a) - w_b x (v_p - v_b))
//   n_i' = w_b x n_i - (k . n_i) s' T,  s' = u . T / (1 - k . e)     k curvature, u velocity in b's frame
//   free: the way s along the curve, whose row is T, with T' = w_b x T + s' k; limits act on it at open ends,
//   and friction of at most mu |f| (Coulomb). Breaks by |f|.
// Source: Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems (1989), §3.3 (point follower).

#include "sim/constraint/joints/joint.h"

namespace obscura::sim {

/// Where a bead is on its wire, and how it moves there.
template <int D>
struct WirePlace {
  typename Curve<D>::Foot foot;
  Vec<D> tangent, curvature;  // room's frame
  Vec<D> arm_a, arm_b;        // of the bead's point, m
  Vec<D> apart;               // e, m
  Vec<D> velocity;            // u, m/s
  double speed = 0;           // s', m/s
  Vec<D> centripetal;         // what J' v has of the bodies' turns
};

/// `turn` of the pose has 1 + the number of the piece that the bead is on; 0: the nearest.
template <int D>
WirePlace<D> wire_place(const JointPose<D>& at) {
  const BodyMotion<D>&a = at.a, &b = at.b;
  const Curve<D>& curve = *at.joint.curve;
  WirePlace<D> it;
  it.arm_a = at.arm_a();
  const Vec<D> p = a.x + it.arm_a;
  it.arm_b = p - b.x;
  const Vec<D> local = b.room_from_body.transpose() * it.arm_b;
  const int piece = int(at.turn[0]) - 1;
  it.foot = piece < 0 || piece >= curve.size() ? curve.nearest(local) : curve.foot(piece, local);
  it.tangent = b.arm(it.foot.at.tangent), it.curvature = b.arm(it.foot.at.curvature);
  it.apart = b.arm(Vec<D>(local - it.foot.at.x));
  const Vec<D> rate = a.velocity(it.arm_a) - b.v;
  it.velocity = rate - cross_velocity<D>(b.w, it.arm_b);
  it.speed = it.velocity.dot(it.tangent) / (1 - it.curvature.dot(it.apart));
  it.centripetal = cross_velocity<D>(a.w, cross_velocity<D>(a.w, it.arm_a)) - cross_velocity<D>(b.w, rate);
  return it;
}

/// The row along a direction that changes at a rate.
template <int D>
Row<D> wire_row(const WirePlace<D>& its, const Vec<D>& s, const Vec<D>& s_rate) {
  Row<D> row;
  row.along = s;
  row.angular_a = moment<D>(its.arm_a, s), row.angular_b = moment<D>(its.arm_b, s);
  row.velocity_product = s_rate.dot(its.velocity) + s.dot(its.centripetal);
  return row;
}

template <int D>
void hold_on_wire(const JointPose<D>& at, Row<D>* J, double* C) {
  const WirePlace<D> its = wire_place(at);
  for (int i = 0; i < D - 1; ++i) {
    const Vec<D> n = tangent<D>(its.tangent, i);
    const Vec<D> n_rate = cross_velocity<D>(at.b.w, n) - (its.curvature.dot(n) * its.speed) * its.tangent;
    J[i] = wire_row<D>(its, n, n_rate);
    C[i] = n.dot(its.apart);
  }
}

template <int D>
double way_on_wire(const JointPose<D>& at, Row<D>& J) {
  const WirePlace<D> its = wire_place(at);
  J = wire_row<D>(its, its.tangent,
                  Vec<D>(cross_velocity<D>(at.b.w, its.tangent) + its.speed * its.curvature));
  return at.joint.curve->along(its.foot.piece, its.foot.u);
}

template <int D>
inline constexpr JointEquations<D> kWire = {
    .kind = JointKind::wire, .rows = D - 1, .hold = hold_on_wire<D>, .coordinate = way_on_wire<D>};

}  // namespace obscura::sim
