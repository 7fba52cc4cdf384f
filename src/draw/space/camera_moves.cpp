// A camera in space: target c, direction to the eye by azimuth a and elevation e, width W.
//   back  = (sin a cos e, sin e, cos a cos e),  right = (cos a, 0, -sin a),  up = back x right
//   scale = window width / W,  distance = longer side / (2 scale tan(field / 2))
// Between two keys c and W move as in the plane (camera.cpp), the angles evenly: an orbit stays an orbit.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draw/space/camera.h"

namespace obscura::draw {
namespace {

using sim::Vec3;

constexpr double kMargin = 0.06;  // of the window's shorter side
constexpr int kOrbit = 24;        // directions that an orbit is fitted for

struct CameraAim {
  Vec3 target;
  double azimuth, elevation, width;
};

/// Page units from the eye to what is shown in its own size.
double page_distance(const Camera& camera, const Rect& window) {
  return std::max(window.width, window.height) / (2 * std::tan(camera.field / 2));
}

CameraProjection lens(const Camera& camera, const CameraAim& shot, const Rect& window) {
  const double sa = std::sin(shot.azimuth), ca = std::cos(shot.azimuth), se = std::sin(shot.elevation),
               ce = std::cos(shot.elevation);
  CameraProjection l;
  l.target = shot.target;
  l.back = {sa * ce, se, ca * ce};
  l.right = {ca, 0, -sa};
  l.up = l.back.cross(l.right);
  l.scale = window.width / shot.width;
  l.middle = {window.x + window.width / 2, window.y + window.height / 2};
  l.window = window;
  if (camera.projection == Camera::Projection::perspective)
    l.per_distance = l.scale / page_distance(camera, window);
  return l;
}

CameraAim shot(const Camera& camera, const CameraKey& key, const Aim& fitted, const Rect& window) {
  CameraAim s{key.center.value_or(fitted.target), key.azimuth.value_or(camera.azimuth),
              key.elevation.value_or(camera.elevation), key.width.value_or(fitted.width)};
  if (key.height) s.width = *key.height * window.width / window.height;
  if (!key.eye) return s;
  const Vec3 back = *key.eye - s.target;
  const double far = back.norm();
  if (!(far > 0)) return s;
  s.elevation = std::asin(std::clamp(back.y() / far, -1.0, 1.0));
  if (std::hypot(back.x(), back.z()) > 1e-9 * far) s.azimuth = std::atan2(back.x(), back.z());
  if (!key.width && !key.height && camera.projection == Camera::Projection::perspective)
    s.width = window.width * far / page_distance(camera, window);
  return s;
}

/// The way round is the short one to an eye, and as told between azimuths.
CameraAim between(const CameraAim& a, CameraAim b, bool short_way, double s) {
  constexpr double turn = 2 * std::numbers::pi;
  if (short_way) b.azimuth -= turn * std::round((b.azimuth - a.azimuth) / turn);
  if (s <= 0) return a;
  if (s >= 1) return b;
  const double zoom = std::log(b.width / a.width);
  const double way = std::abs(zoom) < 1e-9 ? s : std::expm1(s * zoom) / std::expm1(zoom);
  return {a.target + (b.target - a.target) * way, a.azimuth + s * (b.azimuth - a.azimuth),
          a.elevation + s * (b.elevation - a.elevation), a.width * std::exp(s * zoom)};
}

}  // namespace

Camera side() {
  Camera camera;
  camera.azimuth = 0;
  camera.elevation = 8 * std::numbers::pi / 180;
  return camera;
}

Camera slant() {
  Camera camera;
  camera.azimuth = 30 * std::numbers::pi / 180;
  camera.elevation = 25 * std::numbers::pi / 180;
  return camera;
}

Aim aim(const Camera& camera, const std::vector<Vec3>& corners, const Rect& window) {
  Aim found;
  if (corners.empty()) return found;
  Vec3 low = corners[0], high = corners[0];
  for (const Vec3& c : corners) low = low.cwiseMin(c), high = high.cwiseMax(c);
  found.target = (low + high) / 2;
  found.width = std::max((high - low).norm(), 1e-9) * std::max(1.0, window.width / window.height);

  const double margin = kMargin * std::min(window.width, window.height);
  const double wide = std::max(1.0, window.width / 2 - margin),
               tall = std::max(1.0, window.height / 2 - margin);
  const bool turns = camera.orbit != 0;
  // a few rounds: a nearer camera shows things larger, and elsewhere too
  for (int round = 0; round < 24; ++round) {
    double over = 0;  // how much too large the picture is
    Point away = Point::Zero();
    for (int k = 0; k < (turns ? kOrbit : 1); ++k) {
      const CameraProjection l = lens(
          camera,
          {found.target, camera.azimuth + 2 * std::numbers::pi * k / kOrbit, camera.elevation, found.width},
          window);
      double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
      for (const Vec3& c : corners) {
        if (l.depth(c) < 0.05) {
          over = std::max(over, 1.5);
          continue;
        }
        const Point p = l.page(c) - l.middle;
        x0 = std::min(x0, p.x()), x1 = std::max(x1, p.x()), y0 = std::min(y0, p.y()),
        y1 = std::max(y1, p.y());
      }
      if (x0 > x1) continue;
      if (turns) {
        over = std::max({over, x1 / wide, -x0 / wide, y1 / tall, -y0 / tall});
      } else {
        over = std::max({over, (x1 - x0) / (2 * wide), (y1 - y0) / (2 * tall)});
        away = {(x0 + x1) / 2, (y0 + y1) / 2};
        found.target += (away.x() * l.right - away.y() * l.up) / l.scale;
      }
    }
    if (over > 0) found.width *= over;
  }
  return found;
}

CameraProjection lens_at(const Camera& camera, const Aim& fitted, const Rect& window, double t,
                         const std::optional<Vec3>& followed) {
  CameraAim now{fitted.target, camera.azimuth, camera.elevation, fitted.width};
  if (!camera.keys.empty()) {
    // the first key later than t, and the one before it
    std::size_t next = 0;
    while (next < camera.keys.size() && camera.keys[next].time <= t) ++next;
    if (next == 0 || next == camera.keys.size()) {
      now = shot(camera, next == 0 ? camera.keys.front() : camera.keys.back(), fitted, window);
    } else {
      const CameraKey &a = camera.keys[next - 1], &b = camera.keys[next];
      now = between(shot(camera, a, fitted, window), shot(camera, b, fitted, window), b.eye.has_value(),
                    eased(b.ease, (t - a.time) / (b.time - a.time)));
    }
  }
  now.azimuth += camera.orbit * t;
  if (followed) now.target = *followed;
  return lens(camera, now, window);
}

}  // namespace obscura::draw
