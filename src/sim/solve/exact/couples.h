#pragma once

#include <functional>

#include "sim/model/model.h"

namespace obscura::sim {

/// How many couples of bodies, and of bodies and walls, the direct solver would look at in every step of a
/// model, those that groups or joints keep apart among them.
template <int D>
double couples(const Model<D>& model);

/// So many take 160 MB, and a step half a second: scenes with more are refused.
inline constexpr double kMostCouples = 2e7;

/// Calls `found` with all (a, b), a < b, of bodies that may touch each other, and (a, -1 - wall) of those
/// that move with all walls, in the order of a, walls first. Fixed bodies are tried against those that move,
/// and points against those with an extent: a hundred thousand of either take no longer than their couples.
template <int D>
void list_couples(const Model<D>& model, const std::function<void(int, int)>& found);

}  // namespace obscura::sim
