#pragma once

// Spatial vectors and inertias, after Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 2 and §7.1;
// one text for the plane (1 + 2 numbers) and space (3 + 3).
//   twist   (w, v)    spin, and velocity of the point of the link that is at the origin
//   wrench  (n, f)    torque about the origin, and force
//   seen from an origin at r:      w' = w,  v' = v + w x r
//   moved from r to the origin:     n = n' + r x f',  f = f'
//   inertia of a link whose centre of mass is at c, w x c = K w:
//     [ J  H ]   [ Jc + m K'K   m K' ]
//     [ H' M ] = [ m K          m 1  ]
//   seen from an origin at -r, w x r = K w:   J + HK + (HK)' + K'MK,  H + K'M,  M
// Axes are the room's and origins move with the links, so between links there are shifts only. Accelerations
// are those of the moving points, not Featherstone's spatial ones: they differ by w x v, and without it
// nothing depends on how fast the whole chain travels.

#include "sim/math/orientation.h"

namespace obscura::sim {

/// Rotational inertia (kg m^2): a number in the plane, a symmetric 3 x 3 in space.
template <int D>
using SpinTensor = Eigen::Matrix<double, kAngular<D>, kAngular<D>>;

/// Spin (rad/s) and velocity (m/s) of a rigid motion at an origin; or its acceleration, or one direction of
/// freedom.
template <int D>
struct Twist {
  AngularVec<D> w = AngularVec<D>::Zero();
  Vec<D> v = Vec<D>::Zero();

  Twist& operator+=(const Twist& b) {
    w += b.w;
    v += b.v;
    return *this;
  }
  friend Twist operator+(Twist a, const Twist& b) { return a += b; }
  friend Twist operator*(const Twist& a, double s) { return {a.w * s, a.v * s}; }
};

/// Torque (N m) about an origin and force (N); or impulses of both, or momenta.
template <int D>
struct Wrench {
  AngularVec<D> n = AngularVec<D>::Zero();
  Vec<D> f = Vec<D>::Zero();

  Wrench& operator+=(const Wrench& b) {
    n += b.n;
    f += b.f;
    return *this;
  }
  Wrench& operator-=(const Wrench& b) {
    n -= b.n;
    f -= b.f;
    return *this;
  }
  friend Wrench operator+(Wrench a, const Wrench& b) { return a += b; }
  friend Wrench operator-(Wrench a, const Wrench& b) { return a -= b; }
  friend Wrench operator*(const Wrench& a, double s) { return {a.n * s, a.f * s}; }
};

/// Power (W) of a wrench on a twist, both at one origin.
template <int D>
double power(const Wrench<D>& f, const Twist<D>& t) {
  return f.n.dot(t.w) + f.f.dot(t.v);
}

/// The twist seen from an origin at `r` (m).
template <int D>
Twist<D> shifted(const Twist<D>& t, const Vec<D>& r) {
  return {t.w, t.v + cross_velocity<D>(t.w, r)};
}

/// A wrench about the point `r` (m), as a wrench about the origin.
template <int D>
Wrench<D> transformed_to_origin(const Wrench<D>& f, const Vec<D>& r) {
  return {f.n + moment<D>(r, f.f), f.f};
}

/// K: D x spins with w x r = K w.
template <int D>
Eigen::Matrix<double, D, kAngular<D>> lever(const Vec<D>& r) {
  Eigen::Matrix<double, D, kAngular<D>> k;
  if constexpr (D == 2) {
    k << -r[1], r[0];
  } else {
    k << 0, r[2], -r[1], -r[2], 0, r[0], r[1], -r[0], 0;
  }
  return k;
}

/// w x u for two spins: nothing in the plane.
template <int D>
AngularVec<D> spin_cross([[maybe_unused]] const AngularVec<D>& w, [[maybe_unused]] const AngularVec<D>& u) {
  if constexpr (D == 2) {
    return AngularVec<D>::Zero();
  } else {
    return w.cross(u);
  }
}

/// Articulated or rigid inertia of a link, with all that hangs on it: symmetric, twist -> wrench.
/// Featherstone §7.1.
template <int D>
struct ArticulatedInertia {
  SpinTensor<D> J = SpinTensor<D>::Zero();
  Eigen::Matrix<double, kAngular<D>, D> H = Eigen::Matrix<double, kAngular<D>, D>::Zero();
  Eigen::Matrix<double, D, D> M = Eigen::Matrix<double, D, D>::Zero();

  ArticulatedInertia& operator+=(const ArticulatedInertia& b) {
    J += b.J;
    H += b.H;
    M += b.M;
    return *this;
  }
};

/// Inertia of one rigid link: `com` from the origin (m), `inertia` about the centre of mass.
template <int D>
ArticulatedInertia<D> rigid_inertia(double mass, const Vec<D>& com, const SpinTensor<D>& inertia) {
  const Eigen::Matrix<double, D, kAngular<D>> k = lever<D>(com);
  ArticulatedInertia<D> out;
  out.J.noalias() = inertia + mass * (k.transpose() * k);
  out.H = mass * k.transpose();
  out.M.diagonal().setConstant(mass);
  return out;
}

template <int D>
Wrench<D> operator*(const ArticulatedInertia<D>& i, const Twist<D>& t) {
  Wrench<D> out;
  out.n.noalias() = i.J * t.w + i.H * t.v;
  out.f.noalias() = i.H.transpose() * t.w + i.M * t.v;
  return out;
}

/// An inertia about the point `r` (m), as an inertia about the origin.
template <int D>
ArticulatedInertia<D> transformed_to_origin(const ArticulatedInertia<D>& i, const Vec<D>& r) {
  const Eigen::Matrix<double, D, kAngular<D>> k = lever<D>(r);
  const Eigen::Matrix<double, kAngular<D>, D> km = k.transpose() * i.M;
  const SpinTensor<D> hk = i.H * k;
  ArticulatedInertia<D> out;
  out.J = i.J + hk + hk.transpose() + km * k;
  out.H = i.H + km;
  out.M = i.M;
  return out;
}

/// Takes away what moves freely along a direction of freedom: I -= U U' / D.
template <int D>
void eliminate_freedom(ArticulatedInertia<D>& i, const Wrench<D>& u, double over_D) {
  const Wrench<D> scaled = u * over_D;
  i.J.noalias() -= scaled.n * u.n.transpose();
  i.H.noalias() -= scaled.n * u.f.transpose();
  i.M.noalias() -= scaled.f * u.f.transpose();
}

/// A frame: its place and orientation in another frame.
template <int D>
struct Pose {
  Rotation<D> turn = Rotation<D>::Identity();
  Vec<D> place = Vec<D>::Zero();

  /// Room from b, where this is room from a and `b` is a from b.
  Pose operator*(const Pose& b) const { return {turn * b.turn, place + turn * b.place}; }
  Vec<D> operator*(const Vec<D>& point) const { return place + turn * point; }
  Pose inverse() const { return {turn.transpose(), -(turn.transpose() * place)}; }
};

}  // namespace obscura::sim
