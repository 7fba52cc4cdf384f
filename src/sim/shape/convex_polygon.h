#pragma once

#include "sim/shape/shape.h"

namespace obscura::sim {

/// The convex core of a form of the plane, seen in the frame of its body: its corners
/// counter-clockwise, and the radius that rounds it. Corner i of a box counts around it from the lower left.
/// Face i runs from corner i to the next. A point and a ball have one corner and no face. Refers to the
/// form, which must live longer.
class ConvexPolygon {
 public:
  /// Requires any form but a compound.
  explicit ConvexPolygon(const Shape<2>& shape) : ConvexPolygon(core(shape)) {}
  explicit ConvexPolygon(const Core<2>& core);

  int corners() const { return corners_; }
  int faces() const { return corners_ > 1 ? corners_ : 0; }
  int next(int i) const { return i + 1 < corners_ ? i + 1 : 0; }
  double radius() const { return radius_; }
  Vec<2> corner(int i) const {
    if (corners_ == 1) return middle_;
    if (!box_) return vertices_[i];
    return {middle_[0] + (i == 1 || i == 2 ? half()[0] : -half()[0]),
            middle_[1] + (i >= 2 ? half()[1] : -half()[1])};
  }

  /// Outward unit normal of face i.
  Vec<2> normal(int i) const {
    if (is_box()) return i % 2 ? Vec<2>(2 - i, 0) : Vec<2>(0, i - 1);
    const Vec<2> along = vertices_[next(i)] - vertices_[i];
    return Vec<2>(along[1], -along[0]) / along.norm();
  }

  /// A circle that holds the core without its radius, around `middle`.
  Vec<2> middle() const { return middle_; }
  double bounding_radius() const { return bounding_radius_; }

  /// Which corner lies farthest along d, the first of equals.
  int farthest(const Vec<2>& d) const;

  /// Which face's normal lies most along d, the first of equals. Requires faces.
  int facing(const Vec<2>& d) const;

  bool is_box() const { return box_ != nullptr; }
  const Vec<2>& half() const { return box_->half; }  // of a box

 private:
  const Vec<2>* vertices_;
  const Box<2>* box_;
  int corners_ = 1;
  double radius_ = 0, bounding_radius_ = 0;
  Vec<2> middle_ = Vec<2>::Zero();
};

/// How a lies in the frame of b.
struct RelativePose {
  Vec<2> x = Vec<2>::Zero();
  Rotation<2> turn = Rotation<2>::Identity();

  Vec<2> operator*(const Vec<2>& local) const { return x + turn * local; }
};
RelativePose relative_pose(const BodyMotion<2>& a, const BodyMotion<2>& b);
RelativePose inverse(const RelativePose& of);

/// A face of one outline and how far the corners of the other stay from it, m.
struct Separation {
  double value = 0;
  int face = -1;
};

/// The face of `of` that the other outline, lying so in its frame, keeps the greatest separation from, the
/// first of equals. Stops at the first face beyond `enough`. Requires faces.
Separation greatest_separation(const ConvexPolygon& of, const ConvexPolygon& other, const RelativePose& lies,
                               double enough);

/// Distance (m) between two polygons without their radii, `a_in_b` the pose of a in b's frame; if they
/// overlap, minus the depth.
double core_separation(const ConvexPolygon& a, const ConvexPolygon& b, const RelativePose& a_in_b);

}  // namespace obscura::sim
