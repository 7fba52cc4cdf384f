// Where faces end: what slides off one, or tips about its edge, is held by other features from there on, or
// by none.

#include <algorithm>
#include <cmath>

#include "sim/solve/exact/exact.h"

namespace obscura::sim {

namespace {

constexpr double kOver = 1e-6;      // of the scale: how far features that bear may be apart
constexpr double kFeature = 1e-13;  // of an interval
constexpr double kPast =
    4e-10;  // of the larger body: so far behind an edge a corner is past it, see collide()
constexpr double kMostWork = 0.25;  // of what a step of `contact` may cost
constexpr double kApart = 4;        // touching gaps
constexpr double kLater = 1e-3;     // of an interval
constexpr double kLook = 1e-3;      // of the way: over so much of it what leaves a face is seen to slide,
constexpr double kLastWay = 1e-5;   // or so far, of the smaller body

// whether a candidate is a corner at a face, or in space two edges that cross
template <int D>
bool at_face(const ContactCandidate<D>& candidate) {
  using Kind = typename ContactCandidate<D>::Kind;
  return candidate.kind == Kind::corner_of_a || candidate.kind == Kind::corner_of_b ||
         candidate.kind == Kind::edges;
}

}  // namespace

// how a's matter at a place of the room moves over b from one part of the way to another, in the room
template <int D>
Vec<D> ExactSolver<D>::slid(const State<D>& state, Couple couple, const Vec<D>& place, double h, double from,
                            double to) {
  const auto [a, b] = couple;
  const auto pose = [&](int body, double part) {
    return shifts(body) ? pose_at(state, body, h, part) : poses_[body];
  };
  const BodyMotion<D> a0 = pose(a, from), b0 = pose(b, from), a1 = pose(a, to), b1 = pose(b, to);
  const Vec<D> with_a = a1.x + a1.arm(a0.room_from_body.transpose() * (place - a0.x));
  const Vec<D> with_b = b1.x + b1.arm(b0.room_from_body.transpose() * (place - b0.x));
  return with_a - with_b;
}

// Parallel faces that slide off each other are no pair from shortly before their end on, see kAligned of the
// narrow phase. The part of the way at which they end, of a couple that is one until `low`, from the extent
// that they share,
//   part = low + d E(low) / (E(low - d) - E(low))
template <int D>
double ExactSolver<D>::end_of_faces(const State<D>& state, Couple couple, double h, double low) {
  const auto gaps = [&](double part, auto&& found) {
    for (const int body : {couple.a, couple.b})
      if (shifts(body)) poses_[body] = pose_at(state, body, h, part);
    near_contacts(poses_, couple, kOver * model_.scale, [&](const ContactCandidate<D>& gap) {
      found(evaluate(gap, poses_[couple.a], poses_[couple.b]).point);
    });
  };
  Vec<D> place = Vec<D>::Zero();
  int many = 0;
  gaps(low, [&](const Vec<D>& point) { place = point, ++many; });
  if (many < 2) return low;
  const double size = std::min(limits_.bounding_radius[couple.a], limits_.bounding_radius[couple.b]);
  double part = std::min(low, kLook);
  Vec<D> way = slid(state, couple, place, h, low, low - part);
  if (const double far = way.norm(); far > kLastWay * size) part *= kLastWay * size / far;
  if (!(part > 0)) return low;
  way = slid(state, couple, place, h, low, low - part).normalized();
  const auto extent = [&](double at) {
    double least = 1e300, most = -1e300;
    gaps(at, [&](const Vec<D>& point) {
      least = std::min(least, point.dot(way)), most = std::max(most, point.dot(way));
    });
    return most - least;
  };
  const double left = extent(low), shrinks = extent(low - part) - left;
  return shrinks > 0 && left < shrinks ? low + part * left / shrinks : low;
}

// The part of the way after which a corner that bears has left its face, as of what slides over an edge: its
// features are others from there on. In `contact` few times a step, and not where much meets.
template <int D>
double ExactSolver<D>::feature_time(const State<D>& state, double h) {
  double first = progress_.late = kNever;
  if (model_.collision != Collision::event &&
      (progress_.faces == 0 || progress_.work > kMostWork * limits_.budget))
    return first;
  for (const Constraint& constraint : constraints_) {
    if (constraint.kind != Constraint::Kind::contact || !active(constraint)) continue;
    const ContactCandidate<D>& candidate = candidates_[constraint.of];
    const Couple couple{candidate.key.a, candidate.key.b};
    if (couple.b < 0 || candidate.of_poses || !at_face(candidate)) continue;
    bool alone = true;  // no other feature of the two is near
    const auto there = [&](double part) {
      for (const int body : {couple.a, couple.b})
        if (shifts(body)) poses_[body] = pose_at(state, body, h, part);
      bool any = false;
      alone = true;
      near_contacts(poses_, couple, kOver * model_.scale, [&](const ContactCandidate<D>& gap) {
        any = any || gap.key == candidate.key;
        alone = false;
      });
      return any;
    };
    const double size = std::max(limits_.bounding_radius[couple.a], limits_.bounding_radius[couple.b]);
    // of what is round the middle, for where it rolls its rim stands still
    const EvaluatedContact<D> now = evaluate(candidate, poses_[couple.a], poses_[couple.b]);
    const double inward =
        candidate.kind == ContactCandidate<D>::Kind::corner_of_b ? -candidate.radius_b : candidate.radius_a;
    const Vec<D> place = now.point + inward * now.normal;
    const double slides = slid(state, couple, place, h, 1, 0).norm();
    // of one that has cut the interval before, the end may lie a little beyond: it was seen from afar
    const bool seen = progress_.leaving == candidate.key;
    const bool ends = !there(1);
    if (slides > std::max(kPast * size, kApart * limits_.touching_gap) &&
        (ends || (seen && !there(1 + kLater))) && there(0)) {
      double low = ends ? 0 : 1, high = ends ? 1 : 1 + kLater;
      while (high - low > kFeature) {
        const double middle = 0.5 * (low + high);
        (there(middle) ? low : high) = middle;
      }
      there(high);
      if (alone) high = std::max(high, end_of_faces(state, couple, h, low));
      // so far that it does not touch what is beside the face; what is round rolls on about its edge
      const bool round = candidate.radius_a + candidate.radius_b > 0;
      const double past = high + std::max(kPast * size, round ? 0 : kApart * limits_.touching_gap) / slides;
      if ((past < 1 || !ends) && past < first) {
        first = past, progress_.leaving = candidate.key;
        if (!ends) progress_.late = past;
      }
    }
    for (const int body : {couple.a, couple.b})
      if (shifts(body)) poses_[body] = end_pose(state, body);
  }
  if (first < kNever) --progress_.faces;
  return first;
}

template double ExactSolver<2>::feature_time(const State<2>&, double);
template double ExactSolver<3>::feature_time(const State<3>&, double);

}  // namespace obscura::sim
