#pragma once

// Gear: the free coordinate of one joint is a ratio times that of another; angles of pins, in space of
// hinges, and ways of sliders: a slider and a pin are a rack and its pinion.
//   C    = (c_1 - c_1(0)) - n (c_2 - c_2(0))        where coordinates are angles of space, up to the rounds
//                                                   that both may differ by
//   J    = J_1 - n J_2,  J' v likewise              those of the joints' free coordinates
//   free: both coordinates, as one. Its force is that of the teeth, f / r_1 across the line of the centres
//   for two pins of pitch radii r_1 and r_2 = |n| r_1, of the rack for a slider, shown as that on the first.
//   Breaks by it.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §3 (a constraint of two joint variables).

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/hinge.h"
#include "sim/constraint/joints/slider.h"
#include "sim/math/trig.h"

namespace obscura::sim {

/// The row and value of the free coordinate of one of the joints of a gear; in the plane angles are left to
/// the gear's `turn`.
template <int D>
double geared_coordinate(const JointPose<D>& gear, int which, Row<D>& J) {
  const Joint<D>& joint = (*gear.joint.geared)[std::size_t(which)];
  static const AngularVec<D> none = AngularVec<D>::Zero();
  const JointPose<D> at{joint, gear.side(joint.a.body), gear.side(joint.b.body), none, gear.all};
  if (joint.kind == JointKind::slider) return way_of_slider<D>(at, J);
  if constexpr (D == 2) {
    plane_angle(at, J);
    return 0;
  } else {
    return angle_about_axis(at, J);
  }
}

/// How the teeth of two pins' wheels push on the first for a unit of torque, 1/m; zero where both turn about
/// one place.
template <int D>
Vec<D> tooth_force(const JointPose<D>& gear) {
  const Joint<D>&p = (*gear.joint.geared)[0], &q = (*gear.joint.geared)[1];
  const BodyMotion<D>&a = gear.side(p.a.body), &b = gear.side(q.a.body);
  Vec<D> apart = (b.x + b.arm(q.a.local)) - (a.x + a.arm(p.a.local));
  const double n = gear.joint.ratio, far = std::sqrt(apart.squaredNorm());
  // the first inside the second's ring, or around the second, where both turn the same way
  if (n > 1) apart = -apart;
  const double radius = n < 0 ? far / (1 - n) : far / std::fabs(n - 1);
  if (!(far > 0) || !(radius > 0) || n == 1) return Vec<D>::Zero();
  const Vec<D> e = apart / far;
  if constexpr (D == 2) {
    return Vec<D>(-e[1], e[0]) / radius;
  } else {
    const Vec<D> axis = gear.side(p.b.body).arm(p.axis);
    return axis.cross(e) / radius;
  }
}

template <int D>
void hold_ratio(const JointPose<D>& at, Row<D>* J, double* C) {
  const double factors[] = {1, -at.joint.ratio};
  Row<D> row;
  double error = 0;
  for (int k = 0; k < 2; ++k) {
    const Joint<D>& joint = (*at.joint.geared)[std::size_t(k)];
    Row<D> one;
    const double f = factors[k], value = geared_coordinate(at, k, one);
    error += f * value, row.velocity_product += f * one.velocity_product;
    if (joint.a.body >= 0)
      row.more.push_back({joint.a.body, Vec<D>(f * one.along), AngularVec<D>(f * one.angular_a)});
    if (joint.b.body >= 0)
      row.more.push_back({joint.b.body, Vec<D>(-f * one.along), AngularVec<D>(-f * one.angular_b)});
    if (joint.kind == JointKind::slider) row.along += k == 0 ? one.along : Vec<D>(-f * one.along);
  }
  if (row.along.isZero(0)) row.along = tooth_force(at);
  if constexpr (D == 2) {
    C[0] = error + (at.turn - at.joint.turn)[0];
  } else {
    // whole rounds of both joints change the error by multiples of joint.length; 0: by any amount, so C = 0;
    // negative: two sliders, which have no rounds
    const double least = at.joint.length, off = error - at.joint.lower;
    C[0] = least > 0 ? off - least * std::round(off / least) : least < 0 ? off : 0;
  }
  J[0] = std::move(row);
}

template <int D>
inline constexpr JointEquations<D> kGear = {
    .kind = JointKind::gear, .rows = 1, .mechanism = true, .hold = hold_ratio<D>};

}  // namespace obscura::sim
