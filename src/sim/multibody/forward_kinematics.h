#pragma once

#include "sim/multibody/chain.h"

namespace obscura::sim {

/// How a chain stands and moves, link by link, in the room's axes; a link's origin is its joint's, on the
/// link. Room for it is made once; place() and move() allocate nothing.
template <int D>
struct ChainKinematics {
  ChainKinematics() = default;
  explicit ChainKinematics(const Chain<D>& chain);

  // by place(), from q
  std::vector<Pose<D>> joint;          // the joint's frame on the link, seen from the room
  std::vector<Vec<D>> arm;             // from the parent's origin (the room's for -1) to this one, m
  std::vector<Vec<D>> com;             // from the origin to the centre of mass, m
  std::vector<SpinTensor<D>> inertia;  // about the centre of mass, kg m^2
  std::vector<Twist<D>> freedom;       // S, one a velocity, at the origin of its link

  // by move(), from v
  std::vector<Twist<D>> twist;  // of the link at its origin
  std::vector<Twist<D>> bias;   // c: velocity-product acceleration of the link relative to its parent
  std::vector<Twist<D>> velocity_product;  // the acceleration of the link at its origin where v' = 0
};

/// Forward kinematics of places. q: chain.positions() numbers, quaternions of unit length.
template <int D>
void place(const Chain<D>& chain, std::span<const double> q, ChainKinematics<D>& stance);

/// Forward kinematics of velocities, after place(). v: chain.velocities() numbers.
template <int D>
void move(const Chain<D>& chain, std::span<const double> v, ChainKinematics<D>& stance);

/// The frame of a link as its maker stated it, seen from the room.
template <int D>
Pose<D> link_pose(const Chain<D>& chain, const ChainKinematics<D>& stance, int link);

/// Velocity (m/s) of the point of a link that is at `point` (room).
template <int D>
Vec<D> point_velocity(const ChainKinematics<D>& stance, int link, const Vec<D>& point);

/// Acceleration (m/s^2) of that point of the link where v' = 0: the J' v of its row.
template <int D>
Vec<D> point_drift(const ChainKinematics<D>& stance, int link, const Vec<D>& point);

/// Acceleration (m/s^2) of that point where the link's origin accelerates by `a`.
template <int D>
Vec<D> point_acceleration(const ChainKinematics<D>& stance, int link, const Twist<D>& a, const Vec<D>& point);

/// A force or impulse at `point` (room), as a wrench at the link's origin.
template <int D>
Wrench<D> wrench_at(const ChainKinematics<D>& stance, int link, const Vec<D>& point, const Vec<D>& force);

/// A row of J: the factor of each velocity of the chain in the power of `wrench` (at the link's origin). A
/// contact at `point` along `normal` has wrench_at(point, normal); a turn about an axis has (axis, 0). out:
/// chain.velocities() numbers.
template <int D>
void row(const Chain<D>& chain, const ChainKinematics<D>& stance, int link, const Wrench<D>& wrench,
         std::span<double> out);

/// The conserved quantities of a chain.
template <int D>
struct ChainTotals {
  double mass = 0;                                         // kg
  Vec<D> centre = Vec<D>::Zero();                          // centre of mass in the room, m
  double kinetic = 0, potential = 0;                       // J; potential: -m g . x
  Vec<D> momentum = Vec<D>::Zero();                        // kg m/s
  AngularVec<D> angular_momentum = AngularVec<D>::Zero();  // about the room's origin, kg m^2/s
};

/// Sums over the links, after place() and move().
template <int D>
ChainTotals<D> totals(const Chain<D>& chain, const ChainKinematics<D>& stance, const Vec<D>& gravity);

}  // namespace obscura::sim
