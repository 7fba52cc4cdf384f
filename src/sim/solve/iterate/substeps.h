#pragma once

#include <algorithm>
#include <cmath>

#include "sim/model/model.h"
#include "sim/shape/shape.h"

// How the solvers for many bodies push bodies out of each other, in both dimensions: by time, however many
// steps it takes, and down to an overlap that is let be.

namespace obscura::sim {

/// Of how much of an overlap is pushed apart in `time` s: half of it in a sixtieth of a second.
inline double corrected_share(double time) {
  constexpr double kHalfLife = 1.0 / 60;
  return time / (time + kHalfLife);
}

/// The overlap of two bodies that is let be: next to nothing where there are few bodies. Of many, the few
/// iterations would part some contacts that are corrected to zero; a contact that has parted bears nothing
/// until it closes again, and the heap creeps.
struct AllowedOverlap {
  static constexpr double kLeast = 5e-7;  // of the larger bounding radius
  double share = 0;                       // of the narrower width

  double operator()(double bounding_radius, double width) const {
    return kLeast * bounding_radius + share * width;
  }
};
template <int D>
AllowedOverlap allowed_overlap(const Model<D>& model) {
  constexpr double kMost = 1e-3;
  constexpr double kFew = 50, kMany = 200;  // bodies that move, beside points
  const auto moving = std::count_if(model.bodies.begin(), model.bodies.end(),
                                    [](const Body<D>& body) { return !body.fixed && !is_point(body.shape); });
  const double crowded = std::clamp((double(moving) - kFew) / (kMany - kFew), 0.0, 1.0);
  return {kMost * crowded * crowded * crowded};
}

/// By how much two bodies may come nearer in a substep, of the narrower one's width; how many substeps a
/// second there are at least and at most.
inline constexpr double kCloser = 0.025, kFewestSubsteps = 240, kMostSubsteps = 4800;
/// Of the speed of bodies with corners against each other: as others of their corners may come near.
inline constexpr double kPassing = 0.25;
/// Of a width: how near is nearly touching.
inline constexpr double kNearly = 0.1;
/// Of the room: how wide a point counts.
inline constexpr double kPointWidth = 1e-3;

/// How fast a pair may still close where iterations end, in widths of the narrower body, 1/s, where pairs
/// close by at most `rate` widths a second before. What is left would sink, be lifted again, and never come
/// to rest.
inline double settled_rate(double rate) {
  constexpr double kStill = 1e-7, kShare = 5e-3;
  return std::max(kStill, kShare * rate);
}

/// Of a substep: how exactly in time an impact is found; the next correction would be by its square. Of a
/// bounding radius: no wider open, a gap takes part in an impact.
inline constexpr double kInTime = 1e-9, kTogether = 1e-6;

/// Into how many substeps to divide a step of h s, where pairs close by at most `rate` widths a second.
inline int substeps_for(double rate, double h) {
  return std::max(1, int(std::ceil(h * std::clamp(rate / kCloser, kFewestSubsteps, kMostSubsteps) - 1e-9)));
}

}  // namespace obscura::sim
