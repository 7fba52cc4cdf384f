#pragma once

#include <optional>
#include <vector>

#include "draw/page/layout.h"
#include "draw/picture/lens.h"

namespace obscura::draw {

/// How far a move has come at the part u of its time; 0 at 0 and 1 at 1, exactly.
double eased(CameraKey::Ease ease, double u);

/// The view from the world to the page at time t (s).
View view_at(const Camera& camera, const Layout& layout, double t);

// In space.

/// The named views: from the front, almost level; and from the right and above.
Camera side();
Camera slant();

/// The default aim of a camera: a place, and the width (m) that its window shows there.
struct Aim {
  sim::Vec3 target = sim::Vec3::Zero();
  double width = 1;
};

/// The aim from which all of `corners` lie in the window, with a margin, whatever the orbit.
Aim aim(const Camera& camera, const std::vector<sim::Vec3>& corners, const Rect& window);

/// The projection from space into the window at time t (s). `followed`: the place of the body that the camera
/// follows.
CameraProjection lens_at(const Camera& camera, const Aim& fitted, const Rect& window, double t,
                         const std::optional<sim::Vec3>& followed = {});

}  // namespace obscura::draw
