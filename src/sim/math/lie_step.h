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

/// The orientation at the fraction s of the way between two, h (s) apart, with the angular velocities w
/// (room's frame) at either end: the cubic Hermite interpolant of the displacement from the first. In the
/// plane that of the angles.
template <int D>
Orientation<D> between(const Orientation<D>& from, const AngularVec<D>& w_from, const Orientation<D>& to,
                       const AngularVec<D>& w_to, double h, double s) {
  const double r = 1 - s;
  const double p0 = r * r * (1 + 2 * s), p1 = s * s * (3 - 2 * s), m0 = h * s * r * r, m1 = -h * s * s * r;
  if constexpr (D == 2) {
    return p0 * from + p1 * to + m0 * w_from + m1 * w_to;
  } else {
    const AngularVec<D> d = logarithm(product(inverse<D>(from), to));
    const AngularVec<D> begun = from_room<D>(rotation<D>(from), w_from),
                        ended = turn_rate(d, from_room<D>(rotation<D>(to), w_to));
    return sim::turned(from, AngularVec<D>(p1 * d + m0 * begun + m1 * ended));
  }
}

/// The angular velocity of that motion there, rad/s, room's frame. In space from the displacement d as
///   w = d' - d x d' / 2 + d x (d x d') / 6      in the body's frame, with an error of the fourth order in h
template <int D>
AngularVec<D> spin_between(const Orientation<D>& from, const AngularVec<D>& w_from, const Orientation<D>& to,
                           const AngularVec<D>& w_to, double h, double s) {
  const double r = 1 - s;
  const double q1 = 6 * s * r / h, n0 = r * (1 - 3 * s), n1 = s * (3 * s - 2);
  if constexpr (D == 2) {
    return q1 * (to - from) + n0 * w_from + n1 * w_to;
  } else {
    const AngularVec<D> whole = logarithm(product(inverse<D>(from), to));
    const AngularVec<D> begun = from_room<D>(rotation<D>(from), w_from),
                        ended = turn_rate(whole, from_room<D>(rotation<D>(to), w_to));
    const AngularVec<D> d = s * s * (3 - 2 * s) * whole + h * s * r * (r * begun - s * ended),
                        rate = q1 * whole + n0 * begun + n1 * ended;
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
