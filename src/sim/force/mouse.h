#pragma once

#include "sim/model/state.h"

namespace obscura::sim {

/// The place that a click at `place` grips: the nearest centre of a particle or ball, end of a capsule or
/// vertex of another body that is not fixed; on a tie the lower body, then the lower vertex. Empty if there
/// is no such body. Handout §2.2.
template <int D>
Grip<D> closest(const Model<D>& model, const State<D>& state, const Vec<D>& place);

}  // namespace obscura::sim
