// Separating axes of convex polygons.
//   s(face) = min over the other's corners p of n . (p - p_face)        s = max over the faces of both
// Where s < 0 they overlap, and -s is the least depth: a shift of -s along that n parts them. Where s > 0
// they are apart. Then s is their distance when the corner lies over the face; otherwise every axis falls
// short of it, and the distance is between two corners.

#include "sim/outline.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace obscura::sim {

namespace {

// distance from p to the segment of face i
double distance(const Outline& outline, int i, const Vec<2>& p) {
  const Vec<2> from = outline.corner(i), along = outline.corner(outline.next(i)) - from;
  const double s = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - s * along).norm();
}

double nearest(const Outline& outline, const Outline& other, const Lie& lies) {
  double least = 1e300;
  for (int i = 0; i < outline.faces(); ++i) {
    for (int k = 0; k < other.corners(); ++k) {
      least = std::min(least, distance(outline, i, lies * other.corner(k)));
    }
  }
  return least;
}

}  // namespace

Outline::Outline(const Shape<2>& shape) : shape_(&shape) {
  assert(shape.kind != ShapeKind::compound);
  switch (shape.kind) {
    case ShapeKind::ball:
      radius_ = shape.radius;
      middle_ = shape.center;
      break;
    case ShapeKind::box:
      corners_ = 4;
      middle_ = shape.center;
      girth_ = shape.half.norm();
      break;
    case ShapeKind::polygon:
      corners_ = int(shape.vertices.size());
      for (const Vec<2>& vertex : shape.vertices) middle_ += vertex / corners_;
      for (const Vec<2>& vertex : shape.vertices) {
        girth_ = std::max(girth_, (vertex - middle_).squaredNorm());
      }
      girth_ = std::sqrt(girth_);
      break;
    case ShapeKind::point:
    case ShapeKind::compound:
      break;
  }
}

Vec<2> Outline::corner(int i) const {
  if (corners_ == 1) return middle_;
  if (shape_->kind == ShapeKind::polygon) return shape_->vertices[i];
  const Vec<2>& half = shape_->half;
  return {middle_[0] + (i == 1 || i == 2 ? half[0] : -half[0]), middle_[1] + (i >= 2 ? half[1] : -half[1])};
}

Vec<2> Outline::normal(int i) const {
  if (shape_->kind == ShapeKind::box) {
    const double out = i == 1 || i == 2 ? 1 : -1;
    return i % 2 ? Vec<2>(out, 0) : Vec<2>(0, out);
  }
  const Vec<2> along = shape_->vertices[next(i)] - shape_->vertices[i];
  return Vec<2>(along[1], -along[0]) / along.norm();
}

int Outline::farthest(const Vec<2>& d) const {
  if (corners_ == 1) return 0;
  if (shape_->kind == ShapeKind::box) {
    if (d[1] > 0) return d[0] > 0 ? 2 : 3;
    return d[0] > 0 ? 1 : 0;
  }
  int best = 0;
  double most = d.dot(shape_->vertices[0]);
  for (int i = 1; i < corners_; ++i) {
    const double here = d.dot(shape_->vertices[i]);
    if (here > most) {
      most = here;
      best = i;
    }
  }
  return best;
}

Lie lie(const Stance<2>& a, const Stance<2>& b) {
  const Rotation<2> b_from_room = b.room_from_body.transpose();
  return {b_from_room * (a.x - b.x), b_from_room * a.room_from_body};
}

Lie inverse(const Lie& of) {
  const Rotation<2> back = of.turn.transpose();
  return {-(back * of.x), back};
}

Separation greatest_separation(const Outline& of, const Outline& other, const Lie& lies, double enough) {
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

double core_separation(const Outline& a, const Outline& b, const Lie& a_in_b) {
  if (a.faces() + b.faces() == 0) return (a_in_b * a.corner(0) - b.corner(0)).norm();
  const Lie b_in_a = inverse(a_in_b);
  double s = -1e300;
  if (b.faces()) s = std::max(s, greatest_separation(b, a, a_in_b, 1e300).value);
  if (a.faces()) s = std::max(s, greatest_separation(a, b, b_in_a, 1e300).value);
  if (s <= 0) return s;
  return std::min(nearest(b, a, a_in_b), nearest(a, b, b_in_a));
}

}  // namespace obscura::sim
