#pragma once

// Pulley: a rope without mass runs from a over points, of bodies or the room, to b, and is no longer than L.
//   C    = L - sum l_i - q_a (phi_a - theta_a) + q_b (phi_b - theta_b) >= 0,  f >= 0,  f C = 0
//                                l_i  the free pieces, straight from one to the next, of direction d_i
//   J v  = - sum d_i . (v_i+1 - v_i) + q_a w_a - q_b w_b
//   J' v = - sum (|u|^2 - (d . u)^2) / l + d . (w x (w x r))_i+1 - d . (w x (w x r))_i,   u = v_i+1 - v_i
// A wheel at an end (in the plane) takes the rope up without slipping: q is its radius, negative where the
// rope runs around it clockwise, phi the angle of the rope there, all rounds counted from the start, theta
// that of the wheel. The poses tell phi but for its rounds: it is the angle nearest to State::wound. The
// piece between two ends p_a and p_b, centres of wheels or points, is tangent to both:
//   p_b - p_a = l d - q perp(d),   q = q_a - q_b
// free: all, until it is tight. Its force is the tension, shown as that on a. Breaks by it.
// Source: Featherstone, Rigid Body Dynamics Algorithms (2008), §8, as a sum of distance constraints.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "sim/constraint/joints/joint.h"
#include "sim/math/elementary.h"

namespace obscura::sim {

/// A straight piece of rope: from one end to the next, how long, and which way.
template <int D>
struct RopePiece {
  Vec<D> direction = Vec<D>::Zero();
  double length = 0;  // m
};

/// The piece between two places whose wheels offset it by q in all.
template <int D>
RopePiece<D> rope_piece(const Vec<D>& from, const Vec<D>& to, double q) {
  const Vec<D> u = to - from;
  const double far2 = u.squaredNorm();
  RopePiece<D> piece;
  piece.length = std::sqrt(std::max(0.0, far2 - q * q));
  if (!(far2 > 0)) return piece;
  piece.direction = piece.length / far2 * u;
  if constexpr (D == 2) piece.direction += q / far2 * Vec<D>(-u[1], u[0]);
  return piece;
}

/// The angle from one direction of the plane to another, rad, within pi.
inline double angle_between(const Vec<2>& from, const Vec<2>& to) {
  return elementary::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
}

/// That angle, whole rounds added, that is nearest to another.
inline double angle_between(const Vec<2>& from, const Vec<2>& to, double near) {
  constexpr double kRound = 2 * std::numbers::pi;
  const double angle = angle_between(from, to);
  return angle + kRound * std::round((near - angle) / kRound);
}

/// The first place of a rope, or the last, and the place next to it; how far their wheels offset the piece
/// between.
struct RopeEnd {
  Vec<2> from, to;
  double offset = 0;
  Vec<2> rate;  // of to - from, m/s
};
inline RopeEnd rope_end(const JointPose<2>& at, bool first) {
  const Joint<2>& joint = at.joint;
  const bool lone = joint.over.empty();
  const End<2>&from = first || lone ? joint.a : joint.over.back(),
        &to = !first || lone ? joint.b : joint.over.front();
  const BodyMotion<2>&p = at.side(from.body), &q = at.side(to.body);
  const Vec<2> arm_p = p.arm(from.local), arm_q = q.arm(to.local);
  const double on_a = first || lone ? joint.on_a.offset : 0, on_b = !first || lone ? joint.on_b.offset : 0;
  return {p.x + arm_p, q.x + arm_q, on_a - on_b, q.velocity(arm_q) - p.velocity(arm_p)};
}

/// Whether the piece will have no length left within a time h, as the end is then on the rim of the wheel: on
/// the straight way from here, (u + u' s)^2 = q^2. Or turns by more than a radian in it, as it is so short.
inline bool runs_out(const RopeEnd& end, const RopePiece<2>& piece, double h) {
  if (!(piece.length > 0)) return true;
  const double l2 = piece.length * piece.length, along = (end.to - end.from).dot(end.rate);
  const double reach = along * along - l2 * end.rate.squaredNorm();
  if (along < 0 && reach > 0 && l2 <= h * (std::sqrt(reach) - along)) return true;
  const double across = piece.direction[0] * end.rate[1] - piece.direction[1] * end.rate[0];
  return h * std::fabs(across) > piece.length;
}

/// Where the rope is on its wheels, all rounds counted; none where a piece at them runs out within a time h,
/// s.
inline std::optional<Wound> on_wheels(const JointPose<2>& at, double h) {
  Wound now = at.wound;
  for (const bool first : {true, false}) {
    const Winding<2>& wheel = first ? at.joint.on_a : at.joint.on_b;
    if (wheel.offset == 0) continue;
    const RopeEnd end = rope_end(at, first);
    const RopePiece<2> piece = rope_piece<2>(end.from, end.to, end.offset);
    if (runs_out(end, piece, h)) return {};
    double& angle = first ? now.a : now.b;
    angle = angle_between(wheel.start, piece.direction, angle);
  }
  return now;
}

template <int D>
void hold_rope(const JointPose<D>& at, Row<D>* J, double* C) {
  const Joint<D>& joint = at.joint;
  Row<D> row;
  const int points = int(joint.over.size()) + 2;
  const auto end = [&](int i) -> const End<D>& {
    return i == 0 ? joint.a : i + 1 == points ? joint.b : joint.over[std::size_t(i - 1)];
  };
  const auto offset = [&](int i) {
    return i == 0 ? joint.on_a.offset : i + 1 == points ? joint.on_b.offset : 0;
  };
  double free = 0;  // how long the pieces are, and what wheels have given out
  // what a piece adds at one of its ends: `sign` times d there, less the turn of a wheel
  const auto side = [&](int i, const Vec<D>& d, double sign) {
    const int body = end(i).body;
    if (body < 0) return;
    const Vec<D> arm = at.side(body).arm(end(i).local);
    RowSide<D> it{body, Vec<D>(sign * d), moment<D>(arm, Vec<D>(sign * d))};
    if constexpr (D == 2) it.angular[0] += sign * offset(i);
    row.more.push_back(it);
  };
  for (int i = 0; i + 1 < points; ++i) {
    const BodyMotion<D>&p = at.side(end(i).body), &q = at.side(end(i + 1).body);
    const Vec<D> arm_p = p.arm(end(i).local), arm_q = q.arm(end(i + 1).local);
    const RopePiece<D> piece =
        rope_piece<D>(Vec<D>(p.x + arm_p), Vec<D>(q.x + arm_q), offset(i) - offset(i + 1));
    const Vec<D>& d = piece.direction;
    free += piece.length;
    side(i, d, 1), side(i + 1, d, -1);
    const Vec<D> u = q.velocity(arm_q) - p.velocity(arm_p);
    const double along = d.dot(u);
    if (piece.length > 0) row.velocity_product -= (u.squaredNorm() - along * along) / piece.length;
    row.velocity_product -= d.dot(cross_velocity<D>(q.w, cross_velocity<D>(q.w, arm_q)) -
                                  cross_velocity<D>(p.w, cross_velocity<D>(p.w, arm_p)));
    if (i == 0) row.along = d;
    if constexpr (D == 2) {
      if (i == 0 && joint.on_a.offset != 0)
        free += joint.on_a.offset * angle_between(joint.on_a.start, d, at.wound.a);
      if (i + 2 == points && joint.on_b.offset != 0)
        free -= joint.on_b.offset * angle_between(joint.on_b.start, d, at.wound.b);
    }
  }
  C[0] = joint.length - free;
  if constexpr (D == 2) {
    if (!joint.turns.empty()) C[0] += (at.turn - joint.turn)[0];
  }
  J[0] = std::move(row);
}

template <int D>
inline constexpr JointEquations<D> kPulley = {.kind = JointKind::pulley,
                                              .rows = 1,
                                              .one_sided = true,
                                              .apart = true,
                                              .mechanism = true,
                                              .hold = hold_rope<D>};

}  // namespace obscura::sim
