#pragma once

// Gear: the free coordinate of one joint is a ratio times that of another; angles of pins, in space of
// hinges, and ways of sliders: a slider and a pin are a rack and its pinion.
//   C    = (c_1 - c_1(0)) - n (c_2 - c_2(0)) + F . p_1 - F . p_2
//                                                   where coordinates are angles of space, up to the rounds
//                                                   that both may differ by; p  what the pins are off
//   J    = J_1 - n J_2 + F . P_1 - F . P_2          those of the joints' free coordinates, P of their pins
//   J' v likewise, with F' . (the velocities of the pins)
//   free: both coordinates, as one. F is the force of the teeth on the first for a unit of torque, 1 / r_1
//   across the line of the centres for two pins of pitch radii r_1 and r_2 = |n| r_1, along the rack for a
//   slider. The pins hold, so their terms change no motion: by them the teeth push wheels and not only turn
//   them, and axles bear that. F is zero of wheels about one place, about axes that are not parallel, or
//   on different bodies, or of a belt; then the gear is a couple. Breaks by
//   its force or its torque, and where one of its joints breaks.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §3 (a constraint of two joint variables).

#include <algorithm>
#include <cmath>

#include "sim/constraint/joints/hinge.h"
#include "sim/constraint/joints/slider.h"
#include "sim/math/trig.h"

namespace obscura::sim {

inline constexpr double kSkew = 1e-6;  // rad: how far axes may be from parallel

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

/// Whether one body, or the room, bears both of its joints: then teeth may mesh.
template <int D>
bool one_frame(const Joint<D>& gear) {
  return (*gear.geared)[0].b.body == (*gear.geared)[1].b.body;
}

/// How the teeth push on the first for a unit of torque, 1/m, or of force along a rack; and its rate, 1/(m
/// s).
template <int D>
struct ToothForce {
  Vec<D> value = Vec<D>::Zero(), rate = Vec<D>::Zero();
};

/// That of two pins' wheels; zero where both turn about one place, about axes that are not parallel, or on
/// different bodies.
template <int D>
ToothForce<D> tooth_force(const JointPose<D>& gear) {
  if (!one_frame(gear.joint) || gear.joint.belt) return {};
  const Joint<D>&p = (*gear.joint.geared)[0], &q = (*gear.joint.geared)[1];
  const BodyMotion<D>&a = gear.side(p.a.body), &b = gear.side(q.a.body), &frame = gear.side(p.b.body);
  const Vec<D> arm_a = a.arm(p.a.local), arm_b = b.arm(q.a.local);
  // of the first inside the second's ring, or around the second, where both turn the same way, backwards
  const double n = gear.joint.ratio, sign = n > 1 ? -1 : 1;
  Vec<D> apart = sign * ((b.x + arm_b) - (a.x + arm_a)),
         moves = sign * (b.velocity(arm_b) - a.velocity(arm_a));
  Vec<D> axis = Vec<D>::Zero(), tilts = axis;  // of space, and its rate
  if constexpr (D == 3) {
    axis = frame.arm(p.axis), tilts = frame.w.cross(axis);
    if (axis.cross(frame.arm(q.axis)).squaredNorm() > kSkew * kSkew) return {};
    // across the axis: one wheel may lie before the other
    const double before = axis.dot(apart);
    moves -= tilts * before + axis * (tilts.dot(apart) + axis.dot(moves)), apart -= axis * before;
  }
  const double far = std::sqrt(apart.squaredNorm()), radius = far / std::fabs(1 - n);
  if (!(far > 0) || n == 1) return {};
  const Vec<D> e = apart / far, turns = (moves - e * e.dot(moves)) / far;
  ToothForce<D> force;
  if constexpr (D == 2) {
    force.value = Vec<D>(-e[1], e[0]), force.rate = Vec<D>(-turns[1], turns[0]);
  } else {
    force.value = axis.cross(e), force.rate = tilts.cross(e) + axis.cross(turns);
  }
  force.rate = (force.rate - force.value * (e.dot(moves) / far)) / radius;
  force.value /= radius;
  return force;
}

template <int D>
void hold_ratio(const JointPose<D>& at, Row<D>* J, double* C) {
  const auto& joints = *at.joint.geared;
  const double factors[] = {1, -at.joint.ratio};
  const bool slides[] = {joints[0].kind == JointKind::slider, joints[1].kind == JointKind::slider};
  Row<D> row, own[2];
  double error = 0;
  for (int k = 0; k < 2; ++k) {
    error += factors[k] * geared_coordinate(at, k, own[k]);
    row.velocity_product += factors[k] * own[k].velocity_product;
  }
  ToothForce<D> teeth = slides[0] || slides[1] ? ToothForce<D>{} : tooth_force(at);
  if (slides[0] || slides[1]) {
    const int k = slides[0] ? 0 : 1;
    teeth.value = (k == 0 ? 1 : -factors[1]) * own[k].along;
    teeth.rate = cross_velocity<D>(at.side(joints[std::size_t(k)].b.body).w, teeth.value);
  }
  row.along = teeth.value, row.of_wheels = !slides[0];
  for (int k = 0; k < 2; ++k) {
    const Joint<D>& joint = joints[std::size_t(k)];
    // what the teeth push at a pin
    const double side = slides[k] || !one_frame(at.joint) ? 0 : k == 0 ? 1 : -1;
    const Vec<D> push = side * teeth.value;
    const BodyMotion<D>&a = at.side(joint.a.body), &b = at.side(joint.b.body);
    const Vec<D> arm_a = a.arm(joint.a.local), arm_b = b.arm(joint.b.local);
    error += push.dot((a.x + arm_a) - (b.x + arm_b));
    row.velocity_product += push.dot(cross_velocity<D>(a.w, cross_velocity<D>(a.w, arm_a)) -
                                     cross_velocity<D>(b.w, cross_velocity<D>(b.w, arm_b))) +
                            side * teeth.rate.dot(a.velocity(arm_a) - b.velocity(arm_b));
    const auto add = [&](int body, double sign, const AngularVec<D>& angular, const Vec<D>& arm) {
      if (body < 0) return;
      row.more.push_back({body, Vec<D>(sign * (factors[k] * own[k].along + push)),
                          AngularVec<D>(sign * (factors[k] * angular + moment<D>(arm, push)))});
    };
    add(joint.a.body, 1, own[k].angular_a, arm_a), add(joint.b.body, -1, own[k].angular_b, arm_b);
  }
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
