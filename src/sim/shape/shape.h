#pragma once

#include <cassert>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "sim/math/body_motion.h"
#include "sim/shape/form.h"

namespace obscura::sim {

/// Principal moments of inertia of `shape` about its centre of mass, kg m^2, for uniform density: in the
/// plane m (x^2 + y^2) / 12 for a box with sides x and y (handout §3.1). For a hull or compound in space they
/// belong to the body's axes once it is seated (below). Zero for points and balls, which are particles and do
/// not turn; see solid_inertia for a ball that rolls.
template <int D>
AngularVec<D> inertia(const Shape<D>& shape, double mass);

/// The same, and of a ball what it has when it turns: in the plane m r^2 / 2, in space 2 m r^2 / 5. Zero for
/// a point.
template <int D>
AngularVec<D> solid_inertia(const Shape<D>& shape, double mass);

/// Content (area or volume), centre and second moments of a shape. Where parts of a compound overlap, the
/// overlap counts once for each.
template <int D>
struct MassProperties {
  double content = 0;              // m^2; in space m^3
  Vec<D> center = Vec<D>::Zero();  // centroid, in the shape's frame, m
  AngularVec<D> second =
      AngularVec<D>::Zero();  // second moment about the centroid, m^4; in space principal ones, m^5
  Orientation<D> axes =
      no_rotation<D>();  // the principal axes in the shape's frame: those it has, where they are
};

/// The mass properties of a shape of uniform density; all zero for a point.
template <int D>
MassProperties<D> mass_properties(const Shape<D>& shape);

/// Diagonalises a symmetric tensor, and returns the rotation to its principal axes; the identity if the axes
/// of the frame are principal ones already.
Orientation<3> principal_axes(Eigen::Matrix3d& tensor);

/// The shape in its body's frame, whose origin is the centroid and whose axes are the principal ones of
/// `bulk`. The body then stands at room_from_shape * bulk.center, turned by room_from_shape * bulk.axes.
template <int D>
Shape<D> seated(const Shape<D>& shape, const MassProperties<D>& bulk);

/// The radius of a shape that is the same in every orientation: a ball's; zero for a point. Empty for all
/// others.
template <int D>
std::optional<double> round_radius(const Shape<D>& shape) {
  if (form<Point<D>>(shape)) return 0;
  const Ball<D>* ball = form<Ball<D>>(shape);
  return ball ? std::optional(ball->radius) : std::nullopt;
}

/// How many forms collide: the parts of a compound, or itself.
template <int D>
int parts(const Shape<D>& shape) {
  const Compound<D>* several = form<Compound<D>>(shape);
  return several ? int(several->parts.size()) : 1;
}
template <int D>
const Shape<D>& part(const Shape<D>& shape, int i) {
  const Compound<D>* several = form<Compound<D>>(shape);
  return several ? several->parts[i] : shape;
}

/// The core shape by which a part collides. Requires a form other than a compound.
template <int D>
Core<D> core(const Shape<D>& part) {
  return of_form(part, []<class F>(const F& form) -> Core<D> {
    if constexpr (std::is_same_v<F, Compound<D>>) {
      assert(false && "a compound has no core of its own");
      return {};
    } else {
      return form.core();
    }
  });
}

/// The same shape in another frame, where `turn` is how that frame turns what stands in it.
template <int D>
Shape<D> moved(const Shape<D>& shape, const Placing<D>& placing, const Orientation<D>& turn) {
  return of_form(shape, [&](const auto& form) { return form.moved(placing, turn); });
}

/// All of them: the centre of a point or ball, the ends of a capsule, the vertices of other forms; for a
/// compound those of its parts in order.
template <int D>
std::vector<SupportVertex<D>> support_vertices(const Shape<D>& shape);

/// The tips of many bodies, side by side.
template <int D>
class SupportVertices {
 public:
  template <class Body>
  explicit SupportVertices(const std::vector<Body>& bodies) {
    for (const Body& body : bodies) {
      first_.push_back(int(all_.size()));
      of_form(body.shape, [&](const auto& form) { form.add_support_vertices(all_); });
    }
    first_.push_back(int(all_.size()));
  }

  std::span<const SupportVertex<D>> operator[](int body) const {
    return std::span(all_).subspan(first_[body], first_[body + 1] - first_[body]);
  }
  /// The most that one body has.
  int most() const;

 private:
  std::vector<SupportVertex<D>> all_;
  std::vector<int> first_;  // of each body; one more at the end
};

/// Half the least thickness, m: the radius of a ball or capsule; for a convex shape half the least distance
/// from an edge or face to the vertex farthest below it; for several parts the least of theirs; 0 for a
/// point. A body that moves no farther than this in a step cannot pass through it.
template <int D>
double half_thickness(const Shape<D>& shape);

/// The farthest the shape reaches from its centre (the origin of its frame), m.
template <int D>
double bounding_radius(const Shape<D>& shape);

/// The smallest upright box around a shape.
template <int D>
Bounds<D> bounds(const Shape<D>& shape, const BodyMotion<D>& at);

}  // namespace obscura::sim
