#pragma once

#include "sim/model/model.h"

namespace obscura::sim {

/// The largest force that is taken for one, N.
inline constexpr double kLargestForce = 1e300;

/// Throws NotFinite: the force `of` on body `body` at time t (s) came to `force`, at `place`, and to
/// `torque`.
template <int D>
[[noreturn]] void refuse_force(const Model<D>& model, const Force<D>& of, int body, double t,
                               const Vec<D>& force, const Vec<D>& place,
                               const AngularVec<D>& torque = AngularVec<D>::Zero());

}  // namespace obscura::sim
