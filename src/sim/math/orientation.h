#pragma once

// The algebra of turning: the one place where plane and space differ.
//   v_P = v + w x r          handout §3.3.1
//   tau = r x f              handout §3.2
//   dw = I^-1 (r x J)        handout §3.4

#include <cmath>

#include "sim/math/exponential.h"
#include "sim/math/trig.h"

namespace obscura::sim {

template <int D>
using Rotation = Eigen::Matrix<double, D, D>;

/// w x r: the velocity (m/s) that spin w gives to a point at arm r.
template <int D>
Vec<D> cross_velocity(const AngularVec<D>& w, const Vec<D>& r) {
  if constexpr (D == 2) {
    return {-w[0] * r[1], w[0] * r[0]};
  } else {
    return w.cross(r);
  }
}

/// r x f: the torque (N m) of a force f at arm r, or the turn of an impulse.
template <int D>
AngularVec<D> moment(const Vec<D>& r, const Vec<D>& f) {
  if constexpr (D == 2) {
    return AngularVec<D>(r[0] * f[1] - r[1] * f[0]);
  } else {
    return r.cross(f);
  }
}

/// Columns are the axes of the body, seen from the room.
template <int D>
Rotation<D> rotation(const Orientation<D>& turn) {
  if constexpr (D == 2) {
    const auto [s, c] = sin_cos(turn[0]);
    Rotation<D> room_from_body;
    room_from_body << c, -s, s, c;
    return room_from_body;
  } else {
    return matrix(turn);
  }
}

/// The same turn as a quaternion of space: one in the plane is about z.
template <int D>
Eigen::Quaterniond quaternion(const Orientation<D>& turn) {
  if constexpr (D == 2) {
    const auto [s, c] = sin_cos(0.5 * turn[0]);
    return {c, 0, 0, s};
  } else {
    return {turn[3], turn[0], turn[1], turn[2]};
  }
}

/// `turn` rotated by `by` (rad; in space a rotation vector in the room's frame, like angular velocities).
template <int D>
Orientation<D> turned(const Orientation<D>& turn, const AngularVec<D>& by) {
  if constexpr (D == 2) {
    return turn + by;
  } else {
    if (by.isZero(0)) return turn;
    const Orientation<D> to = product(exponential(by), turn);
    return to / std::sqrt(to.squaredNorm());
  }
}

/// The turn `inner`, itself turned by `outer`: rotation(outer) rotation(inner).
template <int D>
Orientation<D> composed(const Orientation<D>& outer, const Orientation<D>& inner) {
  if constexpr (D == 2) {
    return outer + inner;
  } else {
    return product(outer, inner);
  }
}

/// The turn that undoes `turn`.
template <int D>
Orientation<D> inverse(const Orientation<D>& turn) {
  if constexpr (D == 2) {
    return -turn;
  } else {
    return {-turn[0], -turn[1], -turn[2], turn[3]};
  }
}

/// A spin or torque of the room's frame as the body sees it: in the plane the same.
template <int D>
AngularVec<D> from_room([[maybe_unused]] const Rotation<D>& room_from_body, const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return w;
  } else {
    return room_from_body.transpose() * w;
  }
}

/// A spin or torque that the body sees, in the room's frame: in the plane the same.
template <int D>
AngularVec<D> to_room([[maybe_unused]] const Rotation<D>& room_from_body, const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return w;
  } else {
    return room_from_body * w;
  }
}

/// I^-1 tau: the spin (or its rate) that a torque (room's frame) gives to a body of these principal moments.
template <int D>
AngularVec<D> inverse_inertia_times(const AngularVec<D>& inertia,
                                    [[maybe_unused]] const Rotation<D>& room_from_body,
                                    const AngularVec<D>& torque) {
  if constexpr (D == 2) {
    return AngularVec<D>(torque[0] / inertia[0]);
  } else {
    return room_from_body * (room_from_body.transpose() * torque).cwiseQuotient(inertia);
  }
}

/// I w: the angular momentum about its centre of a body with the spin w, both in the room's frame.
template <int D>
AngularVec<D> inertia_times(const AngularVec<D>& inertia, const Rotation<D>& room_from_body,
                            const AngularVec<D>& w) {
  return to_room<D>(room_from_body, inertia.cwiseProduct(from_room<D>(room_from_body, w)));
}

/// The spin of a body that is turned from one stance to another and keeps its angular momentum: in the plane
/// the same.
template <int D>
AngularVec<D> carried_spin([[maybe_unused]] const AngularVec<D>& inertia,
                           [[maybe_unused]] const Rotation<D>& from, [[maybe_unused]] const Rotation<D>& to,
                           const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return w;
  } else {
    return inverse_inertia_times<D>(inertia, to, inertia_times<D>(inertia, from, w));
  }
}

/// Kinetic energy of the spin, J.
template <int D>
double spin_energy(const AngularVec<D>& inertia, [[maybe_unused]] const Rotation<D>& room_from_body,
                   const AngularVec<D>& w) {
  if constexpr (D == 2) {
    return 0.5 * inertia[0] * w[0] * w[0];
  } else {
    const AngularVec<D> own = room_from_body.transpose() * w;
    return 0.5 * own.dot(inertia.cwiseProduct(own));
  }
}

}  // namespace obscura::sim
