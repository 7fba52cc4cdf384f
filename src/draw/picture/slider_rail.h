#pragma once

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// How far the rail of a slider goes along its axis from its place on b, m; infinite where nothing ends it.
struct SliderRail {
  double from = 0, to = 0;
};

/// From limit to limit. Where the slider has none: over all of b and as far as its a, if b is a body that
/// moves, and without an end else.
SliderRail slider_rail(const sim::SceneInfo& cast, const sim::Snapshot& now, std::size_t joint);

}  // namespace obscura::draw
