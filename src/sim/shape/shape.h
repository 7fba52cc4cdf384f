#pragma once

#include <span>
#include <vector>

#include "sim/model/model.h"
#include "sim/model/stance.h"

namespace obscura::sim {

/// Principal moments of inertia of `shape` about its centre of mass, kg m^2, of uniform density: in the plane
/// m (x^2 + y^2) / 12 of a box with sides x and y (handout §3.1). Of a hull or compound in space they belong
/// to the body's axes where it is seated (below). Zero for what does not turn: points and balls, which are
/// particles; see solid_inertia for a ball that rolls.
template <int D>
AngularVec<D> inertia(const Shape<D>& shape, double mass);

/// The same, and of a ball what it has when it turns: in the plane m r^2 / 2, in space 2 m r^2 / 5. Zero for
/// a point.
template <int D>
AngularVec<D> solid_inertia(const Shape<D>& shape, double mass);

/// How much of the plane (or of space) a shape fills, and how it lies there. Where parts of a compound
/// overlap, what they share counts once for each.
template <int D>
struct MassProperties {
  double content = 0;              // m^2; in space m^3
  Vec<D> center = Vec<D>::Zero();  // centroid, in the shape's frame, m
  AngularVec<D> second =
      AngularVec<D>::Zero();  // second moment about the centroid, m^4; in space principal ones, m^5
  Orientation<D> axes =
      no_rotation<D>();  // the principal axes in the shape's frame: those it has, where they are
};

/// Of a point: nothing.
template <int D>
MassProperties<D> mass_properties(const Shape<D>& shape);
template <>
MassProperties<2> mass_properties<2>(const Shape<2>& shape);
template <>
MassProperties<3> mass_properties<3>(const Shape<3>& shape);

/// Turns a symmetric tensor into its diagonal; the turn of the axes in which it is that. Axes stay those of
/// the frame where they are principal ones already.
Orientation<3> principal_axes(Eigen::Matrix3d& tensor);

/// The shape as its body sees it, whose origin is the centroid and whose axes are the principal ones of
/// `bulk`. The body then stands at room_from_shape * bulk.center, turned by room_from_shape * bulk.axes.
template <int D>
Shape<D> seated(const Shape<D>& shape, const MassProperties<D>& bulk);

/// Corners of a box: corner i lies on the positive side of axis a where bit a of i is set.
template <int D>
inline constexpr int kCorners = 1 << D;

/// Corner i of a box in its own frame, m.
template <int D>
Vec<D> corner(const Shape<D>& shape, int i) {
  Vec<D> place = shape.half;
  for (int axis = 0; axis < D; ++axis) {
    if (!(i >> axis & 1)) place[axis] = -place[axis];
  }
  return place;
}

/// A point of a shape that may be the first to touch a plane, rounded by a radius.
template <int D>
struct SupportVertex {
  Vec<D> at = Vec<D>::Zero();  // in the body's frame, m
  double radius = 0;           // m
};

/// All of them: the centre of a point or ball, the ends of a capsule, the corners of all else; of a compound
/// those of its parts in order.
template <int D>
std::vector<SupportVertex<D>> support_vertices(const Shape<D>& shape);

/// The tips of many bodies, side by side.
template <int D>
class SupportVertices {
 public:
  explicit SupportVertices(const std::vector<Body<D>>& bodies);

  std::span<const SupportVertex<D>> operator[](int body) const {
    return std::span(all_).subspan(first_[body], first_[body + 1] - first_[body]);
  }
  /// The most that one body has.
  int most() const;

 private:
  std::vector<SupportVertex<D>> all_;
  std::vector<int> first_;  // of each body; one more at the end
};

/// Half the least thickness, m: the radius of a ball or capsule, of a convex shape half the least distance
/// from an edge or face to the vertex farthest below it, of several parts the least; 0 of a point. What goes
/// no farther than this in a step does not pass through it.
template <int D>
double half_thickness(const Shape<D>& shape);

/// The farthest the shape reaches from its centre (the origin of its frame), m.
template <int D>
double bounding_radius(const Shape<D>& shape);

/// An upright box in the room, m.
template <int D>
struct Bounds {
  Vec<D> lower = Vec<D>::Zero(), upper = Vec<D>::Zero();

  bool meets(const Bounds& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
};

/// The smallest upright box around a shape.
template <int D>
Bounds<D> bounds(const Shape<D>& shape, const BodyMotion<D>& at);

}  // namespace obscura::sim
