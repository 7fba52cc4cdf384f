#pragma once

#include "draw/layout.h"

namespace obscura::draw {

/// How far a move has come at the part u of its time; 0 at 0 and 1 at 1, exactly.
double eased(CameraKey::Ease ease, double u);

/// Where the world lies on the page at time t (s).
View view_at(const Camera& camera, const Layout& layout, double t);

}  // namespace obscura::draw
