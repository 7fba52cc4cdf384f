#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "draw/picture/color.h"
#include "draw/picture/lens.h"
#include "draw/picture/list.h"
#include "sim/math/vec.h"

namespace obscura::draw {

// Things drawn by depth, as one camera sees them: triangles that hide each other, each with its colour in
// light and in shadow; the casters of shadows, as the light sees them; and the shadows on the ground, already
// on the page. Edges, trails and arrows are not among them: depict has found which of them are visible, and
// they are strokes of the list that is drawn after.

/// How many rays stand for the light: a shadow's edge has so many steps.
inline constexpr int kRays = 32;

/// Texels a side of the map in which the light sees what casts shadows on bodies.
inline constexpr int kMap = 1024;

/// Of lines that are found by what hides them: seen from elsewhere, they are drawn anew.
inline constexpr Subject kSeenLines{Subject::What::layer, -1};

struct Solids {
  struct Vertex {
    std::array<float, 4> at;  // (x w, y w, z w, w): page units, z from 0 at the farthest to 1
    Color lit, shaded;        // opaque, but for a fluid's
    std::array<float, 3>
        light;  // where the light sees it: 0 to 1 over Solids' shadow map, the third away from it
    std::array<float, 2> slope;  // how the third grows with the first and second along the surface
    std::array<float, 4>
        grain{};  // where it is in its material: see shaders/material.glsl; the fourth: which
  };
  /// A convex shadow on the ground that some of the light's rays draw.
  struct Shade {
    int begin = 0, end = 0;  // into points
    std::uint32_t rays = 0;  // one bit a ray
  };

  Rect window;
  bool grained = false;  // whether a body is of a material with a pattern,
  bool marked = false;   // and whether one has lines that show how it turns
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;       // that nothing can throw a shadow on
  std::vector<std::uint32_t> shadowed;        // that something may
  std::vector<std::uint32_t> water;           // the surface of a fluid: translucent, over the others
  std::vector<std::array<float, 3>> casters;  // triangles turned away from the light, as `light` of a vertex
  std::array<float, 2>
      soft{};  // of a shadow in that map: half its edge's width a distance to the caster, and at most
  std::vector<Shade> shades;
  std::vector<Point> points;   // page units
  Color shade{0, 0, 0, 0};     // laid over the ground where no ray reaches it
  std::vector<Shade> touches;  // how near bodies are to the ground: a ray is a distance
  Color touch{0, 0, 0, 0};     // laid over the ground where they touch it

  // What stands in space besides the bodies, before a camera sees it; lengths in m, of a coil's winding in
  // page units at the target.
  struct Tube {
    std::vector<sim::Vec3> way;  // of a coil its ends
    double radius = 0;
    Color color{};
    Winding winding{};
  };
  struct Ball {
    sim::Vec3 center;
    double radius = 0;
    Color color{};
  };
  struct Plate {
    sim::Vec3 center;
    double half = 0, thick = 0;
  };
  /// A trail, or a path of an annotation.
  struct Way {
    int body = 0;
    double now = 0, lasting = 0, widest = 0;  // s (of a path 0: for ever), page units
    Color strong{}, faint{};
    std::vector<sim::Vec3> places;
    std::vector<double> times;
    int path = -1;       // which
    bool front = false;  // over the bodies
  };
  CameraProjection lens;
  int part = 0;  // of a page of several runs: which
  std::vector<Tube> tubes;
  std::vector<Tube> lines;  // of earlier instants; their radius in page units
  std::vector<Ball> balls;
  std::vector<Plate> plates;
  std::vector<Way> ways;
};

/// The same on a larger page: each of its lengths times `scale`, its origin at `at`.
Solids placed(Solids solids, double scale, const Point& at);

}  // namespace obscura::draw
