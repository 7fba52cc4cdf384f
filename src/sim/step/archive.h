#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/model/state.h"

namespace obscura::sim {

/// The whole state as 64-bit words, every double to its bit; `loaded` reads it back.
template <int D>
std::vector<std::uint64_t> saved(const State<D>& state);

/// The state that `words` were saved of; none where they were saved of none.
template <int D>
std::optional<State<D>> loaded(std::span<const std::uint64_t> words);

/// Whether it can be a state of this model: all sizes agree, and all indices are within them. Does not check
/// the state of bonded bodies; Stepper::fits does.
template <int D>
bool fits(const State<D>& state, const Model<D>& model);

}  // namespace obscura::sim
