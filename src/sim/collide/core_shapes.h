#pragma once

#include <vector>

#include "sim/collide/narrow_phase.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

// Narrow phase of the plane's iterative solver. Every shape is a set of convex cores in flat arrays: a
// polygon of corners and faces, or one corner, rounded by a radius. Two cores touch at features,
//   g = n . (p - x) - d - r        a corner p at a face (n, d) of the other
//   g = |p_a - p_b| - r_a - r_b    two corners
// so the numbers of two features identify a contact point, and its gap depends on nothing else but two poses.

namespace obscura::sim::plane {

/// A body's pose: its centre (m), and cosine and sine of its angle.
struct alignas(32) Pose {
  double x = 0, y = 0, c = 1, s = 0;
};

struct CoreShape {
  int body = 0, part = 0;
  int first = 0, count = 0;    // corners, counter-clockwise; face i goes from corner i to the next
  double radius = 0;           // m
  double half_thickness = 0;   // m
  double bounding_radius = 0;  // from the body's centre, m
  double wide = 0, high = 0;   // half sides of a box centred on the body, m; 0: not such a box
};

/// All cores of a model, those of a body side by side.
struct CoreShapes {
  /// Parallel faces pass by where they share no more than `passing_part` of the shorter one.
  explicit CoreShapes(const Model<2>& model, double passing_part = kAligned);

  std::vector<CoreShape> all;
  std::vector<int> begin;         // a body's first core; one more at the end
  std::vector<double> x, y;       // corners in the body's frame, m
  std::vector<double> nx, ny, d;  // faces: outward normal and its distance from the body's centre
  std::vector<double> bounding_radius, half_thickness;  // of bodies, m
  double passing;                                       // passing_part
};

/// Which features touch. `none` pads a pair whose two cores have one touch only.
struct Feature {
  enum Kind { corner_of_a, corner_of_b, corners, none };
  static constexpr int kMostCorners = 127, kMostParts = 127;

  Kind kind = none;
  int corner = 0, face = 0;  // `corners`: of a, and of b

  int word() const { return int(kind) << 14 | corner << 7 | face; }
  static Feature of(int word) { return {Kind(word >> 14 & 3), word >> 7 & 127, word & 127}; }
  bool operator==(const Feature&) const = default;
};

/// A contact point between two features: point (m), normal from b to a, gap (m).
struct ContactPoint {
  double x = 0, y = 0, nx = 0, ny = 1, gap = 0;
};

/// The nearest features: two if two faces overlap, one at each end of the overlap; else one, and `none` in
/// the second; none where faces pass by. Returns a lower bound of the distance, m. If that is `margin` or
/// more, `out` may stay unset.
double find_features(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, const CoreShape& b,
                     const Pose& at_b, Feature out[2], double margin = 1e300);
ContactPoint evaluate_feature(const CoreShapes& cores, const CoreShape& a, const Pose& at_a,
                              const CoreShape& b, const Pose& at_b, Feature feature);

/// Against a wall: the two lowest vertices.
double find_features(const CoreShapes& cores, const CoreShape& a, const Pose& at_a, const Wall<2>& wall,
                     Feature out[2]);
ContactPoint evaluate_feature(const CoreShapes& cores, const CoreShape& a, const Pose& at_a,
                              const Wall<2>& wall, Feature feature);

}  // namespace obscura::sim::plane
