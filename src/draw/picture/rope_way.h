#pragma once

#include <vector>

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// The place of a point of a body, or of the room, m.
sim::Vec3 place_of(const sim::Snapshot& now, const sim::SceneInfo::Joint::Place& at);

/// A straight piece of a pulley's rope, m.
struct RopeLine {
  sim::Vec3 from, to, along;  // the last a unit vector
};

/// The straight pieces of the rope of joint `i`, in the order of its places; tangent to the wheels that it is
/// on. Of one that has left the wheel at its end it goes on to the end of the rope's next joints; those have
/// none.
std::vector<RopeLine> rope_lines(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now);

/// A rope of this length from a to b, longer than the way: a parabola, m. `down`: a unit vector.
std::vector<sim::Vec3> hanging_rope(const sim::Vec3& a, const sim::Vec3& b, const sim::Vec3& down,
                                    double length);

/// All of the rope of joint `i`, m: how it lies on the wheel where it begins, from where the joint before it
/// ends, then its straight pieces. What of it is loose hangs from the piece that goes farthest across
/// gravity.
std::vector<sim::Vec3> rope_way(const sim::SceneInfo& cast, std::size_t i, const sim::Snapshot& now);

}  // namespace obscura::draw
