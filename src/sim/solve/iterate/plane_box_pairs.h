#pragma once

#include <vector>

#include "sim/collide/core_shapes.h"
#include "sim/solve/iterate/plane_contact_rows.h"

namespace obscura::sim::plane {

/// Half the sides (m) of a body that is one box about its centre; zero for any other.
struct alignas(16) HalfSides {
  double wide = 0, high = 0;
};

/// Of every body; one more, zero, for walls.
std::vector<HalfSides> halves(const CoreShapes& cores);

/// Bodies a and b of four pairs of boxes, and how they meet: words of the features of both touches,
/// ascending, and a lower bound of the distance, m.
struct alignas(64) BoxManifold {
  int a[kLanes], b[kLanes];
  int words[2][kLanes];
  double gap[kLanes];
};

/// A pair whose features are others now.
struct ChangedPair {
  int pair;
  int words[2];
};

/// Among the pairs whose features may have changed in `share` of the time between two pair searches: the
/// boxes whose features have, and the lanes of all others. `passing`: as in CoreShapes.
void find_outdated(const ContactBatch* batches, int count, const Motion* v, const Pose* poses,
                   const HalfSides* halves, double passing, double share, std::vector<ChangedPair>& boxes,
                   LaneList& others);

/// find_features() for pairs of boxes. For pairs of other shapes the result has no meaning.
void collide_boxes(BoxManifold* manifolds, int count, const Pose* poses, const HalfSides* halves,
                   double passing);

}  // namespace obscura::sim::plane
