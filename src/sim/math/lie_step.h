#pragma once

// Turning as a step integrates it: a displacement d of the turn and a spin, both as the body sees them. In
// the plane they are the room's own.
//   turn = turn0 exp(d),   d' = dexp^-1(d, w),   w' = I^-1 (tau - w x I w)          sim/math/exponential.h
// A step that turns far is cut in pieces: a Runge-Kutta step of 2.9 rad gives energy to what tumbles.
// In space w is kept as base + v. v starts with the rounding error of earlier steps (BodySpin::residual), so
// that steps add up as if rounded once.

#include <algorithm>
#include <cmath>

#include "sim/math/limits.h"
#include "sim/math/orientation.h"

namespace obscura::sim {

/// A step turns a body at most kFarTurn rad in one piece; a longer turn is cut into pieces of kPieceOfTurn.
/// At 0.1 rad classical Runge-Kutta keeps the energy of a wobble to 1e-8.
inline constexpr double kFarTurn = 0.25, kPieceOfTurn = 0.1;

/// Whether a body of these principal moments wobbles as it turns: in the plane none does, in space all but
/// balls and their like.
template <int D>
bool wobbles([[maybe_unused]] const AngularVec<D>& inertia) {
  if constexpr (D == 2) {
    return false;
  } else {
    return inertia.maxCoeff() - inertia.minCoeff() > 1e-9 * inertia.maxCoeff();
  }
}

/// How many equal pieces a step of h (s) is cut in for what turns with this spin.
template <int D>
int pieces_of_turn(const AngularVec<D>& w, double h) {
  const double angle2 = w.squaredNorm() * (h * h);
  if (!(angle2 > kFarTurn * kFarTurn)) return 1;
  return int(std::min(std::ceil(std::sqrt(angle2) / kPieceOfTurn), kFarthestTurn / kPieceOfTurn));
}

/// -I^-1 (w x I w), rad/s^2, of principal moments and a spin that the body sees: nothing in the plane.
template <int D>
AngularVec<D> gyroscopic_acceleration([[maybe_unused]] const AngularVec<D>& inertia,
                                      [[maybe_unused]] const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return AngularVec<D>::Zero();
  } else {
    return inertia.cwiseProduct(w).cross(w).cwiseQuotient(inertia);
  }
}

/// The rate of the displacement d of a turn under the spin w.
template <int D>
AngularVec<D> displacement_rate([[maybe_unused]] const AngularVec<D>& d, const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return w;
  } else {
    return turn_rate(d, w);
  }
}

/// The spin that the body sees, of a base and what is kept beside it.
template <int D>
AngularVec<D> whole_spin([[maybe_unused]] const AngularVec<D>& base, const AngularVec<D>& v) {
  if constexpr (D == 2) {
    return v;
  } else {
    return base + v;
  }
}

/// The orientation displaced by d.
template <int D>
Orientation<D> displaced(const Orientation<D>& turn, const AngularVec<D>& d) {
  if constexpr (D == 2) {
    return turn + d;
  } else {
    return sim::turned(turn, d);
  }
}

/// A displacement of the orientation (rad) and its rate (rad/s), in the body's frame where it begins.
struct MovingDisplacement {
  AngularVec<3> d, rate;
};

/// From the first of two orientations, at the fraction s of the way to the other, h (s) apart, with the
/// angular velocities w (rad/s, room's frame) at either end: the cubic Hermite interpolant.
inline MovingDisplacement displacement_between(const Orientation<3>& from, const AngularVec<3>& w_from,
                                               const Orientation<3>& to, const AngularVec<3>& w_to, double h,
                                               double s) {
  const double r = 1 - s;
  const AngularVec<3> whole = logarithm(product(inverse<3>(from), to));
  const AngularVec<3> begun = from_room<3>(rotation<3>(from), w_from),
                      ended = turn_rate(whole, from_room<3>(rotation<3>(to), w_to));
  const double p1 = s * s * (3 - 2 * s), m0 = h * s * r * r, m1 = -h * s * s * r;
  return {p1 * whole + m0 * begun + m1 * ended,
          6 * s * r / h * whole + r * (1 - 3 * s) * begun + s * (3 * s - 2) * ended};
}

/// The orientation at the fraction s of the way between two, h (s) apart, with the angular velocities w
/// (rad/s, room's frame) at either end. In the plane the cubic of the angles.
template <int D>
Orientation<D> between(const Orientation<D>& from, const AngularVec<D>& w_from, const Orientation<D>& to,
                       const AngularVec<D>& w_to, double h, double s) {
  if constexpr (D == 2) {
    const double r = 1 - s;
    const double p0 = r * r * (1 + 2 * s), p1 = s * s * (3 - 2 * s), m0 = h * s * r * r, m1 = -h * s * s * r;
    return p0 * from + p1 * to + m0 * w_from + m1 * w_to;
  } else {
    return sim::turned(from, displacement_between(from, w_from, to, w_to, h, s).d);
  }
}

/// The angular velocity of that motion there, rad/s, room's frame. In space of the displacement d
///   w = d' - d x d' / 2 + d x (d x d') / 6      in the body's frame, with an error of the fourth order in h
/// Source: the series of the inverse of turn_rate().
template <int D>
AngularVec<D> spin_between(const Orientation<D>& from, const AngularVec<D>& w_from, const Orientation<D>& to,
                           const AngularVec<D>& w_to, double h, double s) {
  if constexpr (D == 2) {
    const double r = 1 - s;
    return 6 * s * r / h * (to - from) + r * (1 - 3 * s) * w_from + s * (3 * s - 2) * w_to;
  } else {
    const auto [d, rate] = displacement_between(from, w_from, to, w_to, h, s);
    const AngularVec<D> across = d.cross(rate);
    return to_room<D>(rotation<D>(sim::turned(from, d)),
                      AngularVec<D>(rate - across / 2 + d.cross(across) / 6));
  }
}

/// The angle of a turn in the plane, whole rounds included; zero in space, where the rotation says all.
template <int D>
AngularVec<D> rounds([[maybe_unused]] const Orientation<D>& turn) {
  if constexpr (D == 2) {
    return turn;
  } else {
    return AngularVec<D>::Zero();
  }
}

}  // namespace obscura::sim
