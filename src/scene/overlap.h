#pragma once

#include "scene/complaints.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// How deep bodies may be in each other, and in walls, at the start: parts of the smaller one's size. They
/// are pushed apart by the first steps.
constexpr double kAllowedOverlap = 1e-6;

/// Complains of bodies that overlap at the start by more than a millionth of their size, unless the model
/// separates them: the first pair of each declaration, and how many more there are. Complains also if more
/// pairs are near each other than can be simulated. These may overlap: fixed bodies among themselves, groups
/// that ignore each other, bodies with a joint between them. Requires the joints.
template <int D>
void refuse_overlaps(const NameTable& roster, const sim::World<D>& world, Diagnostics& complaints);

}  // namespace obscura::scene
