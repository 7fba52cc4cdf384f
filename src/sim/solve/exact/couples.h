#pragma once

#include <functional>

#include "sim/model/model.h"

namespace obscura::sim {

/// The number of pairs of bodies, and of bodies and walls, that the exact solver would test in every step of
/// a model. Pairs that groups or joints exclude are counted too.
template <int D>
double couples(const Model<D>& model);

/// So many take 160 MB, and a step half a second: scenes with more are refused.
inline constexpr double kMostCouples = 2e7;

/// Calls `found` with all pairs (a, b), a < b, of bodies that may touch each other, and with (a, -1 - wall)
/// for each moving body and each wall; in the order of a, walls first. Tries fixed bodies only against moving
/// ones, and points only against bodies with an extent: the time is that of the pairs found, even for a
/// hundred thousand fixed bodies or points.
template <int D>
void list_couples(const Model<D>& model, const std::function<void(int, int)>& found);

}  // namespace obscura::sim
