#include "draw/picture/lens.h"

namespace obscura::draw {

sim::Vec3 CameraProjection::seen(const sim::Vec3& place) const {
  const sim::Vec3 p = place - target;
  const double z = p.dot(back), w = 1 - per_distance * z;
  // near the target both are scale * z, up to a constant
  const double near = perspective() ? scale / (per_distance * w) : scale * z;
  return {middle.x() + scale * p.dot(right) / w, middle.y() - scale * p.dot(up) / w, near};
}

Eigen::Vector4d CameraProjection::homogeneous(const sim::Vec3& place) const {
  const sim::Vec3 p = place - target;
  const double z = p.dot(back), w = 1 - per_distance * z;
  return {middle.x() * w + scale * p.dot(right), middle.y() * w - scale * p.dot(up), perspective() ? 1 : z,
          w};
}

sim::Vec3 CameraProjection::ray(const Point& page, sim::Vec3& from) const {
  const Point d = (page - middle) / scale;
  const sim::Vec3 through = target + d.x() * right - d.y() * up;
  from = perspective() ? eye() : through;
  return perspective() ? sim::Vec3((through - from).normalized()) : sim::Vec3(-back);
}

}  // namespace obscura::draw
