#pragma once

#include <span>

#include "draw/compose/annotate.h"
#include "draw/page/marks.h"
#include "draw/page/readings.h"
#include "sim/model/snapshot.h"

namespace obscura::draw {

/// An instant and how a picture shows it.
struct SeenInstant {
  const sim::Snapshot* now = nullptr;
  Projection view;
};

/// `scales`, smaller where arrows of a kind would leave the picture, so that all of them end in it: as far as
/// that leaves them a sixth of their length, or half where bodies go out of it. Those that would have to be
/// shorter are cut at its edge (draw/plane/arrows.cpp). `weight`: of arrows.
Scales kept_whole(const Marks& marks, const sim::SceneInfo& cast, std::span<const SeenInstant> seen,
                  double weight, Scales scales);

}  // namespace obscura::draw
