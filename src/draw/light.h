#pragma once

#include <array>
#include <vector>

#include "draw/lens.h"
#include "draw/look.h"
#include "draw/polyhedron.h"
#include "draw/solids.h"

namespace obscura::draw {

/// A far, round light: the same direction everywhere, and rays that stand for its disc.
struct Light {
  sim::Vec3 toward;                   // the light, unit
  std::array<sim::Vec3, kRays> rays;  // towards places of its disc, not unit
};

/// `toward`: a direction to the light; from above.
Light light(const sim::Vec3& toward);

/// What a surface looks like in the light and out of it.
struct Shaded {
  Color lit, shaded;
};

/// The colour of a body's surface with this normal (unit, world). Brightest where it faces the light, and
/// never black: the sky lights what looks up a little more than what looks down.
Shaded shade(Color own, Theme theme, const Light& light, const sim::Vec3& normal);

/// The colour of edges on a body.
Color edge(Color own, Theme theme);

/// A plane of the ground, as far as it takes shadows.
struct Ground {
  sim::Vec3 point = sim::Vec3::Zero(), normal = sim::Vec3::UnitY();
};

/// Adds the shadow on the ground of a convex body that has these corners, each a ball of `radius`. Where
/// there are `many` bodies every second ray will do.
void cast_on(const Ground& ground, const Light& light, const Lens& lens,
             const std::vector<sim::Vec3>& corners, double radius, bool many, Solids& solids);

}  // namespace obscura::draw
