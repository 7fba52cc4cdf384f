#pragma once

#include <cmath>

#include "sim/model/model.h"

namespace obscura::sim {

// A spring with a dashpot along its axis, handout §2.2.
//   f = -(k (l - l_rest) + c dl/dt) d        d  from b to a, unit;  f  on a, and -f on b
// Where both ends lie in one place the axis is taken along x: a spring with a rest length pushes them apart
// there too.

/// The law that springs of the scene and the mouse's spring share.
struct SpringLaw {
  double rest_length = 0;  // m
  double stiffness = 0;    // N/m
  double damping = 0;      // N s/m
};

template <class Springy>
SpringLaw law(const Springy& s) {
  return {s.rest_length, s.stiffness, s.damping};
}

/// Force (N) on end a at `a` moving with `va`, its other end being at `b` moving with `vb`.
template <int D>
Vec<D> pull(const SpringLaw& s, const Vec<D>& a, const Vec<D>& va, const Vec<D>& b, const Vec<D>& vb) {
  const Vec<D> across = a - b;
  const double l = std::sqrt(across.squaredNorm());
  const Vec<D> d = l > 0 ? Vec<D>(across / l) : Vec<D>::Unit(0);
  const double rate = (va - vb).dot(d);
  return -(s.stiffness * (l - s.rest_length) + s.damping * rate) * d;
}

/// The energy stored when the ends are at a and b, J.
template <int D>
double spring_energy(const SpringLaw& s, const Vec<D>& a, const Vec<D>& b) {
  const double stretch = std::sqrt((a - b).squaredNorm()) - s.rest_length;
  return 0.5 * s.stiffness * stretch * stretch;
}

}  // namespace obscura::sim
