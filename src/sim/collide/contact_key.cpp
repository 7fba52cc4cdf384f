#include "sim/collide/contact_key.h"

#include <algorithm>

#include "sim/collide/core_shapes.h"
#include "sim/shape/shape.h"

namespace obscura::sim {

int feature_digits(const Shape<2>& shape) {
  int most = 1;
  for (int i = 0; i < parts(shape); ++i) {
    const Core<2> one = core(part(shape, i));
    most = std::max(most, one.box ? 4 : int(one.corners.size()));
  }
  return most;
}

int pack_features(const FeatureNumbers& it, int parts_b, int digits_a, int digits_b) {
  unsigned feature = unsigned(it.kind);
  feature = (feature + 3u * unsigned(it.part_a)) * unsigned(parts_b) + unsigned(it.part_b);
  feature = (feature * unsigned(digits_a) + unsigned(it.on_a)) * unsigned(digits_b) + unsigned(it.on_b);
  return int(feature & 0x7fffffffu);
}

ContactKey narrow_phase_key(const Model<2>& model, const ContactKey& key) {
  using plane::Feature;
  const Feature feature = Feature::of(key.feature & 0xffff);
  const int part_a = key.feature >> 23, part_b = key.feature >> 16 & 127;
  ContactKey made{key.a, key.b, -1};
  if (feature.kind == Feature::none) return made;
  const Shape<2>& a = model.bodies[std::size_t(key.a)].shape;
  if (key.b < 0) {
    made.feature = pack_features(part_a, feature.corner, feature_digits(a));
    return made;
  }
  const Shape<2>& b = model.bodies[std::size_t(key.b)].shape;
  // a face is b's where the corner is a's
  const bool swapped = feature.kind == Feature::corner_of_b;
  const FeatureNumbers numbers{int(feature.kind), part_a, part_b, swapped ? feature.face : feature.corner,
                               swapped ? feature.corner : feature.face};
  made.feature = pack_features(numbers, parts(b), feature_digits(a), feature_digits(b));
  return made;
}

}  // namespace obscura::sim
