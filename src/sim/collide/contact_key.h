#pragma once

#include "sim/model/contact.h"
#include "sim/model/model.h"

namespace obscura::sim {

// The plane has two narrow phases: narrow_phase.h, of the exact solver, and core_shapes.h, of the iterative
// one. Both number the corners and faces of a part alike (ConvexPolygon), but pack the numbers differently
// into ContactKey::feature:
//   narrow_phase.h   (((kind + 3 part_a) parts_b + part_b) digits_a + on_a) digits_b + on_b
//                    at a wall: part_a digits_a + on_a
//   core_shapes.h    part_a << 23 | part_b << 16 | Feature::word()
// on_a, on_b: the corner or face of each; digits: more than the largest of these numbers.

/// Which features of which parts touch. Kinds: 0 a's corner at b's face, 1 b's corner at a's face, 2 corners.
struct FeatureNumbers {
  int kind = 0;
  int part_a = 0, part_b = 0;
  int on_a = 0, on_b = 0;
};

/// More than the number of any corner of any part of a shape.
int feature_digits(const Shape<2>& shape);

/// ContactKey::feature of narrow_phase.h, for two bodies of which b has `parts_b` parts.
int pack_features(const FeatureNumbers& numbers, int parts_b, int digits_a, int digits_b);
/// The same at a wall.
inline int pack_features(int part_a, int on_a, int digits_a) { return part_a * digits_a + on_a; }

/// The key in narrow_phase.h of a contact that has `key` in core_shapes.h. Its feature is -1 if there is
/// none.
ContactKey narrow_phase_key(const Model<2>& model, const ContactKey& key);

}  // namespace obscura::sim
