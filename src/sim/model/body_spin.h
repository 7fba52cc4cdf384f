#pragma once

#include <algorithm>

#include "sim/math/lie_step.h"
#include "sim/model/state.h"

namespace obscura::sim {

// A body's spin in the state, and as a step of an integrator takes and leaves it (math/lie_step.h).

/// The spin of the k-th turning body in its own frame, split for a step into base + v. `whole`: base = 0 and
/// v is all of it, for a scheme that takes v itself as the rate of d (semi-implicit Euler).
template <int D>
void load_spin(const State<D>& state, int k, bool whole, AngularVec<D>& base, double* v) {
  base.setZero();
  if constexpr (D == 2) {
    std::copy_n(state.spin[k].data(), kAngular<D>, v);
  } else {
    const Rotation<D> axes = rotation<D>(state.turn[k]);
    BodySpin<D> own;
    if (k < int(state.body_spin.size())) own = state.body_spin[k];
    if (to_room<D>(axes, own.w) != state.spin[k])
      own = {from_room<D>(axes, state.spin[k]), AngularVec<D>::Zero()};
    Eigen::Map<AngularVec<D>> given(v);
    if (whole) {
      given = own.w;
    } else {
      base = own.w, given = own.residual;
    }
  }
}

/// Writes back the orientation and spin of the k-th turning body after a step; its orientation was `from`.
template <int D>
void store_spin(State<D>& state, int k, const Orientation<D>& from, const double* d,
                const AngularVec<D>& base, const double* v) {
  const Eigen::Map<const AngularVec<D>> by(d), more(v);
  state.turn[k] = displaced<D>(from, by);
  if constexpr (D == 2) {
    state.spin[k] = more;
  } else {
    const AngularVec<D> w = base + more;
    state.spin[k] = to_room<D>(rotation<D>(state.turn[k]), w);
    if (k < int(state.body_spin.size())) state.body_spin[k] = {w, more - (w - base)};
  }
}

}  // namespace obscura::sim
