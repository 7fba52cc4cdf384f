#pragma once

#include <Eigen/Core>

#include "draw/picture/list.h"
#include "sim/math/vec.h"

namespace obscura::draw {

/// How space lies on the page at one instant, by one camera. With p seen from the target as (x, y, z), to the
/// right, up and towards the eye, in metres,
///   page = middle + scale (x, -y) / w,    w = 1 - z / distance,
/// where 1 / distance is 0 for an orthographic camera: w is the depth over the target's.
struct CameraProjection {
  sim::Vec3 target = sim::Vec3::Zero();
  sim::Vec3 right = sim::Vec3::UnitX(), up = sim::Vec3::UnitY(), back = sim::Vec3::UnitZ();  // unit
  double per_distance = 0;  // 1/m: one over the eye's distance from the target; 0: orthographic
  double scale = 1;         // page units a metre at the target
  Point middle = {0, 0};    // where the target lies on the page
  Rect window;              // the part of the page that it fills

  bool perspective() const { return per_distance > 0; }
  /// The eye's place; only for a perspective camera.
  sim::Vec3 eye() const { return target + back / per_distance; }
  /// Towards the eye from a place, unit.
  sim::Vec3 sight(const sim::Vec3& from) const {
    return perspective() ? sim::Vec3((eye() - from).normalized()) : back;
  }
  /// Depth over the target's; not positive at the eye and behind it.
  double depth(const sim::Vec3& place) const { return 1 - per_distance * (place - target).dot(back); }
  /// Page units a metre at a place.
  double scale_at(const sim::Vec3& place) const { return scale / depth(place); }
  /// The point on the page of a place in front of the eye.
  Point page(const sim::Vec3& place) const { return seen(place).head<2>(); }
  /// The point on the page, and the nearness, in page units: straight lines and planes of space stay
  /// straight, and of two places on one sight line the nearer one has the larger third coordinate.
  sim::Vec3 seen(const sim::Vec3& place) const;
  /// (x w, y w, z, w) with page = (x, y): homogeneous, so that it can be clipped before the division. z grows
  /// towards the eye and is 1 for a perspective camera, metres from the target for an orthographic one.
  Eigen::Vector4d homogeneous(const sim::Vec3& place) const;
  /// The direction in which one looks through a point of the page, unit, and a place on that line: the eye,
  /// or the point in the target's plane.
  sim::Vec3 ray(const Point& page, sim::Vec3& from) const;
};

}  // namespace obscura::draw
