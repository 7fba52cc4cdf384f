#pragma once

#include <vector>

#include "sim/model/model.h"

namespace obscura::sim {

/// Whether a force may ever push a body, one answer a body.
template <int D>
std::vector<char> pushed_by_forces(const Model<D>& model);

/// Which bodies each force ties together: those of pairs, and all with a body at the centre of theirs.
template <int D>
std::vector<std::vector<int>> tied_by_forces(const Model<D>& model);

/// Bodies that must not be put to rest: a force acts on them that changes with the time or with other bodies,
/// or, where the solver does not know of forces at all, any that acts on what does not move.
template <int D>
std::vector<int> restless_by_forces(const Model<D>& model, bool known);

}  // namespace obscura::sim
