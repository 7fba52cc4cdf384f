#pragma once

// Friction and elasticity of a pair in contact, from its two sides (docs/scene.md, `friction`, `elasticity`):
//   mu = sqrt(mu_a mu_b),  e = sqrt(e_a e_b)      the body's own value if a wall has none
// mu of what slips, and likewise mu_s >= mu of what does not.
// The geometric mean is zero if one side is: ice under rubber slides, clay does not bounce.

#include <algorithm>
#include <cmath>
#include <optional>

#include "sim/model/model.h"

namespace obscura::sim {

/// Mixes two values. Equal values stay the same bits, even where their product is out of range.
inline double mixed(double a, double b) { return a == b ? a : std::sqrt(a * b); }
/// Mixes a body's value with a wall's, which may be absent.
inline double mixed(double body, const std::optional<double>& wall) {
  return wall ? mixed(body, *wall) : body;
}

/// Coulomb's friction and Newton's elasticity, of a body or of a pair that touches.
struct Material {
  double friction = 0;         // mu
  double static_friction = 0;  // mu_s
  double elasticity = 0;       // e

  Material() = default;
  Material(double mu, double e) : friction(mu), static_friction(mu), elasticity(e) {}
  template <int D>
  explicit Material(const Body<D>& body)
      : friction(body.friction),
        static_friction(body.static_friction.value_or(body.friction)),
        elasticity(body.elasticity) {}
};

inline Material mixed(Material a, const Material& b) {
  a.friction = mixed(a.friction, b.friction);
  a.static_friction = mixed(a.static_friction, b.static_friction);
  a.elasticity = mixed(a.elasticity, b.elasticity);
  return a;
}
/// Mixes a body's with that of a wall or a rail.
template <class Surface>
Material mixed(Material body, const Surface& surface) requires requires {
  surface.static_friction;
}
{
  body.friction = mixed(body.friction, surface.friction);
  body.static_friction =
      mixed(body.static_friction, surface.static_friction ? surface.static_friction : surface.friction);
  body.elasticity = mixed(body.elasticity, surface.elasticity);
  return body;
}

/// Whether anything of a model has another friction before it slips than then.
template <int D>
bool has_static_friction(const Model<D>& model) {
  const auto given = [](const auto& all) {
    return std::any_of(all.begin(), all.end(), [](const auto& it) { return it.static_friction.has_value(); });
  };
  return given(model.bodies) || given(model.walls) || given(model.rails);
}

/// Mixes the materials of body a and of b: another body, or wall -1 - b if b is negative.
template <int D>
Material material(const Model<D>& model, int a, int b) {
  const Material own(model.bodies[a]);
  return b >= 0 ? mixed(own, Material(model.bodies[b])) : mixed(own, model.walls[-1 - b]);
}

}  // namespace obscura::sim
