#pragma once

#include "sim/model/state.h"

namespace obscura::sim {

/// What a click at `place` takes: the closest particle or ball (its centre), end of a capsule or corner of
/// anything else that is not fixed; of equals the lower body, then the lower corner. Nothing where nothing
/// can be taken. Handout §2.2.
template <int D>
Grip<D> closest(const Model<D>& model, const State<D>& state, const Vec<D>& place);

}  // namespace obscura::sim
