// A point fills nothing and has nothing but its centre.

#include "sim/shape/form.h"

namespace obscura::sim {

template <int D>
Spread<D> Point<D>::spread() const {
  return {};
}

template <int D>
void Point<D>::add_support_vertices(std::vector<SupportVertex<D>>& all) const {
  all.push_back({});
}

template <int D>
double Point<D>::half_thickness() const {
  return 0;
}

template <int D>
double Point<D>::bounding_radius() const {
  return 0;
}

template <int D>
Bounds<D> Point<D>::bounds(const Vec<D>& x, const Rotation<D>&) const {
  return {x, x};
}

template <int D>
double Point<D>::outside(const Vec<D>& point) const {
  return point.norm();
}

template <int D>
Shape<D> Point<D>::moved(const Placing<D>& placing, const Orientation<D>&) const {
  return Ball<D>{0, placing(Vec<D>::Zero())};
}

template <int D>
std::optional<Vec<D>> Point<D>::side(const Vec<D>& way) const {
  return way.isZero(0) ? std::optional<Vec<D>>(way) : std::nullopt;
}

template <int D>
Vec<D> Point<D>::hold() const {
  return Vec<D>::Zero();
}

template <int D>
std::vector<DrawnForm> Point<D>::drawn() const {
  return {{.kind = ShapeKind::point}};
}

template struct Point<2>;
template struct Point<3>;

}  // namespace obscura::sim
