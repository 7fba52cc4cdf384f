// A camera move from centre c0 and width w0 to c1 and w1, at the part s of the way:
//   w = w0 (w1 / w0)^s                  zoom at an even rate to the eye
//   c = c0 + (c1 - c0) (w - w0) / (w1 - w0)
// so that one place of the world stays where it is on the page: a zoom heads straight for its end.

#include "draw/space/camera.h"

#include <cmath>

namespace obscura::draw {
namespace {

struct Shot {
  sim::Vec3 center;
  double width;  // m
};

Shot shot(const CameraKey& key, const Layout& layout) {
  return {key.center.value_or(layout.center), key.width.value_or(layout.width / layout.scale)};
}

Shot between(const Shot& a, const Shot& b, double s) {
  if (s <= 0) return a;
  if (s >= 1) return b;
  const double zoom = std::log(b.width / a.width);
  const double way = std::abs(zoom) < 1e-9 ? s : std::expm1(s * zoom) / std::expm1(zoom);
  return {a.center + (b.center - a.center) * way, a.width * std::exp(s * zoom)};
}

}  // namespace

double eased(CameraKey::Ease ease, double u) {
  if (u <= 0) return 0;
  if (u >= 1) return 1;
  switch (ease) {
    case CameraKey::Ease::linear:
      return u;
    case CameraKey::Ease::in:
      return u * u * u;
    case CameraKey::Ease::out:
      return 1 - (1 - u) * (1 - u) * (1 - u);
    case CameraKey::Ease::in_out:
      return u * u * u * (u * (6 * u - 15) + 10);
    case CameraKey::Ease::hold:
      return 0;
  }
  return u;
}

View view_at(const Camera& camera, const Layout& layout, double t) {
  Shot now{layout.center, layout.width / layout.scale};
  if (!camera.keys.empty()) {
    // the first key later than t, and the one before it
    std::size_t next = 0;
    while (next < camera.keys.size() && camera.keys[next].time <= t) ++next;
    if (next == 0) {
      now = shot(camera.keys.front(), layout);
    } else if (next == camera.keys.size()) {
      now = shot(camera.keys.back(), layout);
    } else {
      const CameraKey &a = camera.keys[next - 1], &b = camera.keys[next];
      now = between(shot(a, layout), shot(b, layout), eased(b.ease, (t - a.time) / (b.time - a.time)));
    }
  }
  const double scale = layout.width / now.width;
  return {{layout.middle.x() - scale * now.center.x(), layout.middle.y() + scale * now.center.y()},
          scale,
          layout.window};
}

}  // namespace obscura::draw
