#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "sim/math/orientation.h"
#include "sim/math/vec.h"

namespace obscura::sim {

// The forms a body can have. Each is a plain struct in its own frame, and answers what is below the same way:
// sim/shape/NAME.cpp. A form that leaves out an answer does not compile, because Shape asks it of every form.
//
//   spread                 content, centroid and second moment, for mass and inertia
//   add_support_vertices   the points that may be the first to touch a plane
//   half_thickness         a point that moves less than this in a step cannot pass through it, m
//   bounding_radius        the farthest it reaches from the origin of its frame, m
//   bounds                 the smallest upright box in the room around it, m
//   outside                approximate signed distance of a point in its frame; negative inside, m
//   moved                  the same form in another frame
//   side                   the named place on it, `at = "top right"` in a scene: directions of -1, 0 and 1
//                          along the axes; none if it has no such place
//   hold                   the point that yields most to a pull, where the spring of a hand is stiffest
//   core                   what collides: convex, and rounded by a radius
//   drawn                  what is seen, in three dimensions; the plane lies at z = 0

template <int D>
struct Shape;
template <int D>
struct Box;
struct Capsule;
struct Polygon;
struct DrawnForm;

/// A point of a shape that may be the first to touch a plane, rounded by a radius.
template <int D>
struct SupportVertex {
  Vec<D> at = Vec<D>::Zero();  // in the body's frame, m
  double radius = 0;           // m
};

/// An upright box in the room, m.
template <int D>
struct Bounds {
  Vec<D> lower = Vec<D>::Zero(), upper = Vec<D>::Zero();

  bool meets(const Bounds& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
};

/// How much a form fills, and how far from its centroid: K = int |r - c|^2 dA in the plane, in space
/// C = int (r - c)(r - c)' dV along the axes of the form's frame.
template <int D>
struct Spread {
  using Second = std::conditional_t<D == 2, Eigen::Matrix<double, 1, 1>, Eigen::Matrix3d>;

  double content = 0;              // m^2; in space m^3
  Vec<D> center = Vec<D>::Zero();  // centroid, m
  Second second = Second::Zero();  // m^4; in space m^5

  /// The same of the form turned in its frame, in space.
  void turn(const Orientation<D>& by) {
    if (by == no_rotation<D>()) return;
    const Rotation<D> axes = rotation<D>(by);
    second = (axes * second * axes.transpose()).eval();
  }
};

/// From the places of one frame to those of another.
template <int D>
using Placing = std::function<Vec<D>(const Vec<D>&)>;

/// The convex core of a form of the plane: corners counter-clockwise, or one corner alone, or a box, whose
/// faces are known without looking. Refers to the form, which must live longer.
template <int D>
struct Core {
  Vec<D> middle = Vec<D>::Zero();  // the corner where there is one alone, m
  double radius = 0;               // that rounds it, m
  std::span<const Vec<D>> corners{};
  const Box<D>* box = nullptr;
};

/// The same in space: corners and the loops of them around faces, or one corner alone, or a box or capsule.
template <>
struct Core<3> {
  Vec<3> middle = Vec<3>::Zero();
  double radius = 0;
  std::span<const Vec<3>> corners{};
  std::span<const std::vector<int>> faces{};
  const Box<3>* box = nullptr;
  const Capsule* capsule = nullptr;
};

/// A polygon is of the plane, a hull of space.
enum class ShapeKind { point, ball, box, polygon, compound, capsule, hull };

/// A form as it is drawn, in the body's frame.
struct DrawnForm {
  ShapeKind kind = ShapeKind::ball;
  double radius = 0;                                         // m
  Vec3 half = Vec3::Zero();                                  // m
  Vec3 center = Vec3::Zero();                                // of a ball, box or capsule, m
  std::vector<Vec3> vertices{};                              // of a polygon, counter-clockwise, or a hull, m
  std::vector<std::vector<int>> faces{};                     // of a hull, as a body's
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  // of a box or capsule
};

/// Declares the functions that every form in D dimensions has.
#define OBSCURA_FORM_ANSWERS(D)                                                \
  Spread<D> spread() const;                                                    \
  void add_support_vertices(std::vector<SupportVertex<D>>& all) const;         \
  double half_thickness() const;                                               \
  double bounding_radius() const;                                              \
  Bounds<D> bounds(const Vec<D>& x, const Rotation<D>& room_from_body) const;  \
  double outside(const Vec<D>& point) const;                                   \
  Shape<D> moved(const Placing<D>& placing, const Orientation<D>& turn) const; \
  std::optional<Vec<D>> side(const Vec<D>& way) const;                         \
  Vec<D> hold() const;                                                         \
  std::vector<DrawnForm> drawn() const

template <int D>
struct Point {
  OBSCURA_FORM_ANSWERS(D);
  Core<D> core() const { return {}; }
};

template <int D>
struct Ball {
  double radius = 0;               // m
  Vec<D> center = Vec<D>::Zero();  // m

  OBSCURA_FORM_ANSWERS(D);
  Core<D> core() const { return {.middle = center, .radius = radius}; }
};

/// In the plane a box is not turned: one that is, is a polygon.
template <int D>
struct Box {
  Vec<D> half = Vec<D>::Zero();            // half its sides, m
  Vec<D> center = Vec<D>::Zero();          // m
  Orientation<D> turn = no_rotation<D>();  // in space

  OBSCURA_FORM_ANSWERS(D);
  Core<D> core() const { return {.middle = center, .box = this}; }

  /// Corner i lies on the positive side of axis a where bit a of i is set; from the centre and without its
  /// turn, m.
  Vec<D> corner(int i) const {
    Vec<D> place = half;
    for (int axis = 0; axis < D; ++axis) {
      if (!(i >> axis & 1)) place[axis] = -place[axis];
    }
    return place;
  }
  /// The same as a polygon, in the plane.
  Polygon outline() const;
};

/// In space: all places within a radius of a segment along its own y axis.
struct Capsule {
  double half = 0;                         // of the length of its axis, m
  double radius = 0;                       // m
  Vec<3> center = Vec<3>::Zero();          // m
  Orientation<3> turn = no_rotation<3>();  // of the axis

  OBSCURA_FORM_ANSWERS(3);
  Core<3> core() const { return {.middle = center, .radius = radius, .capsule = this}; }
};

/// In the plane, convex.
struct Polygon {
  std::vector<Vec<2>> vertices;  // counter-clockwise, m

  OBSCURA_FORM_ANSWERS(2);
  Core<2> core() const { return {.corners = vertices}; }
};

/// In space, convex.
struct Hull {
  std::vector<Vec<3>> vertices;         // m
  std::vector<std::vector<int>> faces;  // loops of vertices, counter-clockwise seen from outside

  OBSCURA_FORM_ANSWERS(3);
  Core<3> core() const { return {.corners = vertices, .faces = faces}; }
};

/// Several forms as one. It has no core of its own: its parts collide.
template <int D>
struct Compound {
  std::vector<Shape<D>> parts;  // in the body's frame; none a compound

  OBSCURA_FORM_ANSWERS(D);
};

#undef OBSCURA_FORM_ANSWERS

/// The forms there are: the table that all else asks.
template <int D>
using Forms = std::conditional_t<D == 2, std::variant<Point<2>, Ball<2>, Box<2>, Polygon, Compound<2>>,
                                 std::variant<Point<3>, Ball<3>, Box<3>, Capsule, Hull, Compound<3>>>;

/// The form of a body about its centre of mass, in its own frame.
template <int D>
struct Shape : Forms<D> {
  using Form = Forms<D>;
  using Form::Form;
};

/// The form F of a shape; none where it has another.
template <class F, int D>
const F* form(const Shape<D>& shape) {
  return std::get_if<F>(&static_cast<const Forms<D>&>(shape));
}
template <class F, int D>
F* form(Shape<D>& shape) {
  return std::get_if<F>(&static_cast<Forms<D>&>(shape));
}

/// The farthest that any of them reaches from the origin of their frame, m.
template <int D>
double farthest_reach(const std::vector<SupportVertex<D>>& all) {
  double most = 0;
  for (const SupportVertex<D>& tip : all) most = std::max(most, tip.at.norm() + tip.radius);
  return most;
}

/// The smallest upright box around places of a body.
template <int D>
Bounds<D> bounds_of(const std::vector<Vec<D>>& places, const Vec<D>& x, const Rotation<D>& room_from_body) {
  Bounds<D> all{x + room_from_body * places[0], x + room_from_body * places[0]};
  for (const Vec<D>& own : places) {
    const Vec<D> place = x + room_from_body * own;
    all.lower = all.lower.cwiseMin(place);
    all.upper = all.upper.cwiseMax(place);
  }
  return all;
}

template <int D>
bool is_point(const Shape<D>& shape) {
  return form<Point<D>>(shape) != nullptr;
}

/// Calls `answer` with the form that a shape has.
template <int D, class Answer>
decltype(auto) of_form(const Shape<D>& shape, Answer&& answer) {
  return std::visit(std::forward<Answer>(answer), static_cast<const Forms<D>&>(shape));
}

}  // namespace obscura::sim
