// A ball, in the plane a disc.
//   disc   A = pi r^2          K = A r^2 / 2
//   ball   V = 4 pi r^3 / 3    C = V r^2 / 5

#include <numbers>

#include "sim/shape/form.h"

namespace obscura::sim {

template <int D>
Spread<D> Ball<D>::spread() const {
  Spread<D> it;
  it.center = center;
  if constexpr (D == 2) {
    it.content = std::numbers::pi * radius * radius;
    it.second(0) = it.content * radius * radius / 2;
  } else {
    it.content = 4 * std::numbers::pi * radius * radius * radius / 3;
    it.second.diagonal().setConstant(it.content * radius * radius / 5);
  }
  return it;
}

template <int D>
void Ball<D>::add_support_vertices(std::vector<SupportVertex<D>>& all) const {
  all.push_back({center, radius});
}

template <int D>
double Ball<D>::half_thickness() const {
  return radius;
}

template <int D>
double Ball<D>::bounding_radius() const {
  return center.norm() + radius;
}

template <int D>
Bounds<D> Ball<D>::bounds(const Vec<D>& x, const Rotation<D>& room_from_body) const {
  const Vec<D> middle = x + room_from_body * center, far = Vec<D>::Constant(radius);
  return {middle - far, middle + far};
}

template <int D>
double Ball<D>::outside(const Vec<D>& point) const {
  return (point - center).norm() - radius;
}

template <int D>
Shape<D> Ball<D>::moved(const Placing<D>& placing, const Orientation<D>&) const {
  return Ball{radius, placing(center)};
}

template <int D>
std::optional<Vec<D>> Ball<D>::side(const Vec<D>& way) const {
  if (way.cwiseAbs().sum() > 1.5) return {};
  return Vec<D>(way * radius);
}

template <int D>
Vec<D> Ball<D>::hold() const {
  return Vec<D>::Zero();
}

template <int D>
std::vector<DrawnForm> Ball<D>::drawn() const {
  return {{.kind = ShapeKind::ball, .radius = radius, .center = to_3d<D>(center)}};
}

template struct Ball<2>;
template struct Ball<3>;

}  // namespace obscura::sim
