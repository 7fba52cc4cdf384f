// Separating axes of convex polygons.
//   s(face) = min over the other's corners p of n . (p - p_face)        s = max over the faces of both
// If s < 0 they overlap, and -s is the least depth: a shift of -s along that n separates them. If s > 0 they
// are apart. Then s is their distance when the vertex lies over the face; otherwise every axis gives less
// than the distance, which is between two vertices.

#include "sim/shape/convex_polygon.h"

#include <algorithm>
#include <cmath>

namespace obscura::sim {

namespace {

// distance from p to the segment of face i
double distance(const ConvexPolygon& outline, int i, const Vec<2>& p) {
  const Vec<2> from = outline.corner(i), along = outline.corner(outline.next(i)) - from;
  const double s = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - s * along).norm();
}

double nearest(const ConvexPolygon& outline, const ConvexPolygon& other, const RelativePose& lies) {
  double least = 1e300;
  for (int i = 0; i < outline.faces(); ++i) {
    for (int k = 0; k < other.corners(); ++k) {
      least = std::min(least, distance(outline, i, lies * other.corner(k)));
    }
  }
  return least;
}

// the same as by corners, for the two axes of a box at once
Separation of_boxes(const ConvexPolygon& of, const ConvexPolygon& other, const RelativePose& lies) {
  const Vec<2> away = lies * other.middle() - of.middle();
  const Vec<2> s = away.cwiseAbs() - of.half() - lies.turn.cwiseAbs() * other.half();
  const int upright = away[1] > 0 ? 2 : 0, across = away[0] < 0 ? 3 : 1;
  if (s[0] == s[1]) return {s[0], std::min(upright, across)};
  return s[1] > s[0] ? Separation{s[1], upright} : Separation{s[0], across};
}

}  // namespace

ConvexPolygon::ConvexPolygon(const Core<2>& core)
    : vertices_(core.corners.data()), box_(core.box), radius_(core.radius), middle_(core.middle) {
  if (box_) {
    corners_ = 4;
    bounding_radius_ = box_->half.norm();
  } else if (!core.corners.empty()) {
    corners_ = int(core.corners.size());
    for (const Vec<2>& vertex : core.corners) middle_ += vertex / corners_;
    for (const Vec<2>& vertex : core.corners) {
      bounding_radius_ = std::max(bounding_radius_, (vertex - middle_).squaredNorm());
    }
    bounding_radius_ = std::sqrt(bounding_radius_);
  }
}

int ConvexPolygon::farthest(const Vec<2>& d) const {
  if (corners_ == 1) return 0;
  if (is_box()) {
    if (d[1] > 0) return d[0] > 0 ? 2 : 3;
    return d[0] > 0 ? 1 : 0;
  }
  int best = 0;
  double most = d.dot(vertices_[0]);
  for (int i = 1; i < corners_; ++i) {
    const double here = d.dot(vertices_[i]);
    if (here > most) {
      most = here;
      best = i;
    }
  }
  return best;
}

int ConvexPolygon::facing(const Vec<2>& d) const {
  if (is_box()) {
    const int upright = d[1] > 0 ? 2 : 0, across = d[0] < 0 ? 3 : 1;
    const double height = std::abs(d[1]), width = std::abs(d[0]);
    if (height == width) return std::min(upright, across);
    return height > width ? upright : across;
  }
  int best = 0;
  double most = -1e300;
  for (int i = 0; i < corners_; ++i) {
    const double along = d.dot(normal(i));
    if (along > most) {
      most = along;
      best = i;
    }
  }
  return best;
}

RelativePose relative_pose(const BodyMotion<2>& a, const BodyMotion<2>& b) {
  const Rotation<2> b_from_room = b.room_from_body.transpose();
  return {b_from_room * (a.x - b.x), b_from_room * a.room_from_body};
}

RelativePose inverse(const RelativePose& of) {
  const Rotation<2> back = of.turn.transpose();
  return {-(back * of.x), back};
}

Separation greatest_separation(const ConvexPolygon& of, const ConvexPolygon& other, const RelativePose& lies,
                               double enough) {
  if (of.is_box() && other.is_box()) return of_boxes(of, other, lies);
  Separation best{-1e300, 0};
  for (int i = 0; i < of.faces(); ++i) {
    const Vec<2> n = of.normal(i);
    const Vec<2> down = -(lies.turn.transpose() * n);
    const Vec<2> deepest = lies * other.corner(other.farthest(down));
    const double value = n.dot(deepest - of.corner(i));
    if (value > best.value) best = {value, i};
    if (value > enough) break;
  }
  return best;
}

double core_separation(const ConvexPolygon& a, const ConvexPolygon& b, const RelativePose& a_in_b) {
  if (a.faces() + b.faces() == 0) return (a_in_b * a.corner(0) - b.corner(0)).norm();
  const RelativePose b_in_a = inverse(a_in_b);
  double s = -1e300;
  if (b.faces()) s = std::max(s, greatest_separation(b, a, a_in_b, 1e300).value);
  if (a.faces()) s = std::max(s, greatest_separation(a, b, b_in_a, 1e300).value);
  if (s <= 0) return s;
  return std::min(nearest(b, a, a_in_b), nearest(a, b, b_in_a));
}

}  // namespace obscura::sim
