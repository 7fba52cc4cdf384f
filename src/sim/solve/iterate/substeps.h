#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "sim/model/model.h"
#include "sim/shape/shape.h"

// Constants and rules of the iterative solvers: how they push bodies out of each other, how many substeps
// they take, what an impact is, and when iterations end. They are the same in the plane and in space, but for
// ruling_rate(), of space, and settled_rate(), of the plane. Bodies are pushed apart at a rate in
// time, whatever the length of the step, and down to an allowed overlap.

namespace obscura::sim {

/// The share of an overlap that is pushed apart in `time` s: half of it in a sixtieth of a second.
inline double corrected_share(double time) {
  constexpr double kHalfLife = 1.0 / 60;
  return time / (time + kHalfLife);
}

/// The overlap of two bodies that is not corrected: next to nothing among few bodies. Among many, the few
/// iterations would open some of the contacts that are corrected to zero. An open contact bears nothing until
/// it closes again, and the heap would creep.
struct AllowedOverlap {
  static constexpr double kLeast = 5e-7;
  double share = 0;       // of the narrower width
  double least = kLeast;  // of the larger bounding radius

  double operator()(double bounding_radius, double width) const {
    return least * bounding_radius + share * width;
  }
};
/// That of the first step, which pushes bodies wholly out of overlaps at the start: only rounding is left.
inline constexpr AllowedOverlap kAllowedAtStart{0, 1e-9};
template <int D>
AllowedOverlap allowed_overlap(const Model<D>& model) {
  constexpr double kMost = 1e-3;
  constexpr double kFew = 50, kMany = 200;  // bodies that move, beside points
  const auto moving = std::count_if(model.bodies.begin(), model.bodies.end(),
                                    [](const Body<D>& body) { return !body.fixed && !is_point(body.shape); });
  const double crowded = std::clamp((double(moving) - kFew) / (kMany - kFew), 0.0, 1.0);
  return {kMost * crowded * crowded * crowded};
}

/// m/s: the target of a contact that is left out; far beyond any that a scene of 1e13 m has.
inline constexpr double kNoAim = -1e30;
/// The most that two bodies may approach in a substep, in widths of the narrower one; see ruling_rate().
inline constexpr double kCloser = 0.025;
/// The fewest and the most substeps a second.
inline constexpr double kFewestSubsteps = 240, kMostSubsteps = 4800;
/// The part of the relative speed of bodies with corners that counts as closing speed: others of their
/// corners may come near.
inline constexpr double kPassing = 0.25;
/// Gaps up to this, in widths of the narrower body, count as nearly touching.
inline constexpr double kNearly = 0.1;
/// Gaps up to this, in widths of the narrower body: one lies on the other, and its rows turn within the
/// substep.
inline constexpr double kNearby = 0.01;
/// Of how fast two pass each other and turn: what bore in the last substep and closes no faster goes on
/// bearing, and is not struck.
inline constexpr double kLasting = 0.05;
/// What closes slower than so many times what the free motion makes it close within the substep does so by
/// that, and strikes nothing.
inline constexpr double kRestingGains = 2;
/// e: what rises by a hundredth of its fall at most goes pair after pair, and its rows hold it after a blow.
inline constexpr double kBounces = 0.1;
/// rad: what turns farther in a substep does so without its rows.
inline constexpr double kMostTurn = 1;
/// What changes how fast two pass each other by more than this, of how fast both are, is a blow: how their
/// rows turned before it says nothing of after it.
inline constexpr double kStrikes = 0.5;
/// The width of a point, of the size of the room.
inline constexpr double kPointWidth = 1e-3;

/// The closing speed at which iterations end, in widths of the narrower body, 1/s. In space it is one number
/// whatever else moves: what rests is not to be held the worse where something fast is near. A larger
/// remainder would let bodies sink and be lifted again, and they would never rest.
inline constexpr double kSettled = 1e-7;
/// The same in the plane. `rate`: the largest closing speed before. `pairs`: that touch, and are awake. Of
/// few it costs little that a blow goes through a whole row of them, and none parts from the others.
inline double settled_rate(double rate, int pairs) {
  constexpr int kFew = 100;
  constexpr double kShareOfFew = 1e-5, kShare = 5e-3;
  return std::max(kSettled, (pairs <= kFew ? kShareOfFew : kShare) * rate);
}

/// Widths of the narrower a second: bodies that pass each other more slowly, in the plane that close or part
/// so, are quiet. Where that share of all contacts is, iterations go on far longer: where forces have been
/// found this costs nothing, and where they are not, heavy lids would sink into what bears them, and towers
/// into themselves.
inline constexpr double kQuiet = 1, kMostlyQuiet = 0.8;
/// The same of what hardly moves.
inline constexpr double kAllButStill = 0.1;

/// Islands of so many contacts at most are solved exactly where iterations do not settle them, by so many
/// linear systems at most.
inline constexpr int kFewSolved = 24, kSolvedSystems = 20;

/// Tolerance of the time of an impact, of a substep; Newton's next correction would be of the order of its
/// square.
inline constexpr double kInTime = 1e-9;
/// Gaps up to this, of a bounding radius, take part in an impact of the same instant.
inline constexpr double kTogether = 1e-6;
/// The same of a pair that overlaps, m. The overlap is an error, but for a deep one, and so is a gap some
/// times as wide on the other side of faces that come to lie on each other. `least_gap` of the pair, m.
inline double closed_up_to(double bounding_radius, double least_gap) {
  constexpr double kErrors = 4, kDeep = 1e-2;
  return bounding_radius * std::clamp(kErrors * -least_gap / bounding_radius, kTogether, kDeep);
}

/// Of many, one in so many rules nothing: a heap of a thousand is not divided as finely as its fastest pair,
/// or its narrowest body, asks for.
inline constexpr std::size_t kOneOf = 200;

/// The closing rate that says how many substeps a step has, 1/s: of many contact points the largest but for a
/// two-hundredth of them, which may close twice as fast, so that a heap of a thousand is not divided as
/// finely as its fastest pair asks for. `rates`: of the points that close; they are reordered. `contacts`:
/// how many points touch or nearly do.
inline double ruling_rate(std::span<double> rates, std::size_t contacts) {
  constexpr double kFaster = 2;
  const std::size_t fastest = contacts / kOneOf;
  if (rates.empty()) return 0;
  const double most = *std::max_element(rates.begin(), rates.end());
  if (fastest == 0) return most;
  if (fastest >= rates.size()) return most / kFaster;
  std::nth_element(rates.begin(), rates.begin() + std::ptrdiff_t(fastest), rates.end(), std::greater<>());
  return std::max(rates[fastest], most / kFaster);
}

/// The fewest substeps a second that hold a heap at rest: in one of them nothing falls farther than a
/// fiftieth of its width, or what is tiny would sink into itself.
///   g h^2 <= w / 50
/// Of few bodies the narrowest rules, of many all but one in two hundred.
template <int D>
double resting_substeps(const Model<D>& model) {
  constexpr double kSinks = 50;
  std::vector<double> widths;
  for (const Body<D>& body : model.bodies)
    if (!body.fixed && !is_point(body.shape)) widths.push_back(2 * half_thickness(body.shape));
  std::erase_if(widths, [](double width) { return !(width > 0); });
  if (widths.empty()) return kFewestSubsteps;
  const auto rules = widths.begin() + std::ptrdiff_t(widths.size() / kOneOf);
  std::nth_element(widths.begin(), rules, widths.end());
  const double g = std::sqrt(model.gravity.squaredNorm());
  return std::clamp(std::sqrt(kSinks * g / *rules), kFewestSubsteps, kMostSubsteps);
}

/// The number of substeps of a step of h s, for a ruling closing rate of `rate` widths a second and at least
/// so many a second.
inline int substeps_for(double rate, double h, double fewest = kFewestSubsteps) {
  return std::max(1, int(std::ceil(h * std::clamp(rate / kCloser, fewest, kMostSubsteps) - 1e-9)));
}

}  // namespace obscura::sim
