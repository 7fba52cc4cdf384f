#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "draw/picture/lens.h"
#include "draw/picture/look.h"
#include "draw/picture/solids.h"
#include "draw/space/polyhedron.h"

namespace obscura::draw {

/// A far, round light: the same direction everywhere, and rays that stand for its disc.
struct Light {
  sim::Vec3 toward;                   // the light, unit
  sim::Vec3 across;                   // a weak light from there tells faces apart that the other one misses
  std::array<sim::Vec3, kRays> rays;  // towards places of its disc, not unit
  std::array<sim::Vec3, kRays>
      fine;  // of a smaller disc, for what is so thin that its shadow would be a smudge
};

/// Radius of the light's disc at distance 1.
inline constexpr double kSpread = 0.055;

/// `toward`: a direction to the light; from above.
Light light(const sim::Vec3& toward);

/// The colours of a surface in light and in shadow.
struct Shaded {
  Color lit, shaded;
};

/// The colour of a body's surface with this normal (unit, world). Brightest where it faces the light, and
/// never black: the sky lights what looks up a little more than what looks down.
Shaded shade(Color own, Theme theme, const Light& light, const sim::Vec3& normal);

/// The same of a surface that is round; `sight`: the way from there to the eye, unit. It is brighter where it
/// faces the eye, and the light is mirrored in it a little: a cone would be a triangle otherwise, where the
/// sky and the light balance each other.
Shaded shade_round(Color own, Theme theme, const Light& light, const sim::Vec3& normal,
                   const sim::Vec3& sight);

/// The same of polished metal, which shows the sky, the horizon and the light.
Shaded shine(Color own, Theme theme, const Light& light, const sim::Vec3& normal, const sim::Vec3& sight);

/// The colours of a body's outline, and of edges between faces that are seen: on the dark theme these catch
/// the light.
Color edge(Color own, Theme theme);
Color crease(Color own, Theme theme);

/// A plane of the ground, as far as it takes shadows.
struct Ground {
  sim::Vec3 point = sim::Vec3::Zero(), normal = sim::Vec3::UnitY();
  std::vector<sim::Vec3> loop{};  // around where it takes them, a convex polygon; empty: everywhere
};

/// Which of the light's rays a body stops that is matter in this share of its form: a coil lets light
/// through.
std::uint32_t stopped(double share);

/// How the light falls on the ground, as one camera sees it.
class GroundShadow {
 public:
  GroundShadow(const Ground& ground, const Light& light, const CameraProjection& lens);

  /// Adds the shadow of a convex body that has these corners, each a ball of `radius`, and stops `rays`. With
  /// `many` bodies every second ray is enough.
  void cast(std::span<const sim::Vec3> corners, double radius, bool many, std::uint32_t rays,
            Solids& solids) {
    cast(corners, radius, many, rays, false, solids);
  }
  /// The same of a thin rod: of a smaller light.
  void cast_fine(std::span<const sim::Vec3> corners, double radius, bool many, std::uint32_t rays,
                 Solids& solids) {
    cast(corners, radius, many, rays, true, solids);
  }

  /// The ground is darker around where such a body is near it, up to `reach` from it, m: a ray each for so
  /// many distances, all that is nearer than that.
  void touch(std::span<const sim::Vec3> corners, double radius, double reach, bool many, Solids& solids);

 private:
  static constexpr int kRim = 14;
  // in (x w, y w, w) of the page, see CameraProjection::homogeneous
  struct Ray {
    sim::Vec3 down;                     // what a metre of height moves a corner by
    std::array<sim::Vec3, kRim> round;  // the rim of the shadow of a ball of 1 m
  };
  Ray ray(const sim::Vec3& along) const;
  void cast(std::span<const sim::Vec3> corners, double radius, bool many, std::uint32_t rays, bool fine,
            Solids& solids);

  void put(std::vector<Solids::Shade>& where, std::uint32_t rays, Solids& solids);

  Ground ground_;
  std::vector<Point> bound_;  // its loop on the page
  Light light_;
  CameraProjection lens_;
  double slope_;                     // how straight the light comes down
  std::array<Ray, kRays + 1> rays_;  // the last one the light's middle
  std::array<Ray, kRays> fine_;
  Ray plumb_;  // straight down
  std::vector<sim::Vec3> seen_;
  std::vector<double> heights_;
  std::vector<Point> cast_, outline_;
};

}  // namespace obscura::draw
