#pragma once

#include <vector>

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// The way of the point `local` (m, in its body's frame) along a body's track: as many points as its curve
/// needs to be no farther than `tolerance` (m) from the lines through them. Between points of one smooth
/// motion it is the cubic with the velocities at both ends, and the turn with both spins; where the body was
/// struck between two of them, the corner is where the two straight motions meet. Orientations are those of
/// `track`.
std::vector<sim::Track::Point> refined(const std::vector<sim::Track::Point>& track, const sim::Vec3& local,
                                       double tolerance);

/// A body's instant as a point of its track.
sim::Track::Point end_of_way(int body, const sim::Snapshot& now);

}  // namespace obscura::draw
