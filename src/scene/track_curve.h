#pragma once

#include <optional>
#include <vector>

#include "scene/complaints.h"
#include "scene/expressions.h"
#include "scene/fields.h"
#include "sim/shape/curve.h"

namespace obscura::scene {

/// The curve of a track in the frame that was typed, m.
template <int D>
struct TypedCurve {
  std::vector<typename sim::Curve<D>::Piece> pieces;
  bool closed = false;
};

/// The curve that a track's keys say (`points`, or `x`, `y`, `z`, `from` and `to`). None, and a complaint,
/// where they make none.
template <int D>
std::optional<TypedCurve<D>> track_curve(const Fields& fields, Constants& constants, Diagnostics& complaints);

}  // namespace obscura::scene
