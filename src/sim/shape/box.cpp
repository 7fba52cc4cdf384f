// A box. In the plane one that is turned is a polygon.
//   plane   A = x y            K = A (x^2 + y^2) / 12       x, y  sides
//   space   V = 8 hx hy hz     C = V diag(h^2) / 3          h  half its sides

#include "sim/shape/form.h"

namespace obscura::sim {

namespace {

// the axes of a box that is turned in the frame `axes`
template <int D>
Rotation<D> box_axes(const Rotation<D>& axes, const Orientation<D>& turn) {
  if (turn == no_rotation<D>()) return axes;
  return axes * rotation<D>(turn);
}

}  // namespace

template <int D>
Spread<D> Box<D>::spread() const {
  Spread<D> it;
  it.center = center;
  if constexpr (D == 2) {
    it.content = 4 * half[0] * half[1];
    it.second(0) = it.content * half.squaredNorm() / 3;
  } else {
    it.content = 8 * half.prod();
    it.second.diagonal() = it.content / 3 * half.cwiseAbs2();
    it.turn(turn);
  }
  return it;
}

template <int D>
void Box<D>::add_support_vertices(std::vector<SupportVertex<D>>& all) const {
  const bool turned = turn != no_rotation<D>();
  for (int i = 0; i < (1 << D); ++i)
    all.push_back({turned ? Vec<D>(center + rotation<D>(turn) * corner(i)) : Vec<D>(center + corner(i)), 0});
}

template <int D>
double Box<D>::half_thickness() const {
  return half.minCoeff();
}

template <int D>
double Box<D>::bounding_radius() const {
  if (turn == no_rotation<D>()) return (center.cwiseAbs() + half).norm();
  std::vector<SupportVertex<D>> all;
  add_support_vertices(all);
  return farthest_reach(all);
}

template <int D>
Bounds<D> Box<D>::bounds(const Vec<D>& x, const Rotation<D>& room_from_body) const {
  const Vec<D> middle = x + room_from_body * center;
  const Vec<D> far = box_axes<D>(room_from_body, turn).cwiseAbs() * half;
  return {middle - far, middle + far};
}

template <int D>
double Box<D>::outside(const Vec<D>& point) const {
  Vec<D> own = point - center;
  if (turn != no_rotation<D>()) own = (rotation<D>(turn).transpose() * own).eval();
  return (own.cwiseAbs() - half).maxCoeff();
}

template <int D>
Shape<D> Box<D>::moved(const Placing<D>& placing, const Orientation<D>& by) const {
  if constexpr (D == 2) {
    if (by == no_rotation<D>()) return Box{half, placing(center)};
    return outline().moved(placing, by);
  } else {
    return Box{half, placing(center), by == no_rotation<D>() ? turn : composed<D>(by, turn)};
  }
}

template <int D>
std::optional<Vec<D>> Box<D>::side(const Vec<D>& way) const {
  return Vec<D>(way.cwiseProduct(half));
}

template <int D>
Vec<D> Box<D>::hold() const {
  return half;
}

template <int D>
std::vector<DrawnForm> Box<D>::drawn() const {
  return {{.kind = ShapeKind::box,
           .half = to_3d<D>(half),
           .center = to_3d<D>(center),
           .turn = quaternion<D>(turn)}};
}

template <>
Polygon Box<2>::outline() const {
  Polygon it;
  for (const int i : {0, 1, 3, 2}) it.vertices.push_back(center + corner(i));
  return it;
}

template struct Box<2>;
template struct Box<3>;

}  // namespace obscura::sim
