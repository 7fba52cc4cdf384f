#pragma once

#include "sim/constraint/response.h"
#include "sim/solve/iterate/plane_contact_rows.h"

// Velocity and inverse mass of a body as the wide kernels of its dimension load them, for the code that both
// dimensions share.

namespace obscura::sim {

template <int D>
struct KernelBody;
template <>
struct KernelBody<2> {
  using Type = plane::Motion;
};
template <>
struct KernelBody<3> {
  using Type = PointBody<3>;
};
template <int D>
using MovingBody = typename KernelBody<D>::Type;

inline Vec<2> velocity(const plane::Motion& m) { return {m.x, m.y}; }
inline AngularVec<2> spin(const plane::Motion& m) { return AngularVec<2>(m.w); }
inline double inverse_mass(const plane::Motion& m) { return m.im; }
inline void set_velocity(plane::Motion& m, const Vec<2>& v, const AngularVec<2>& w) {
  m.x = v[0], m.y = v[1], m.w = w[0];
}

inline const Vec<3>& velocity(const PointBody<3>& m) { return m.v; }
inline const AngularVec<3>& spin(const PointBody<3>& m) { return m.w; }
inline double inverse_mass(const PointBody<3>& m) { return m.inverse_mass; }
inline void set_velocity(PointBody<3>& m, const Vec<3>& v, const AngularVec<3>& w) { m.v = v, m.w = w; }

}  // namespace obscura::sim
