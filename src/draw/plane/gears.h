#pragma once

#include <map>

#include "draw/plane/stage.h"

namespace obscura::draw {

/// A wheel with teeth, which is a body.
struct Toothed {
  sim::SceneInfo::Joint::Place center;
  double radius = 0;  // of its pitch circle, m
  double first = 0;   // the angle of a tooth, in its frame, rad
  int count = 0;      // of its teeth

  double pitch() const;  // the angle from tooth to tooth, rad
  double high() const;   // half the height of a tooth, m
};

/// A straight body with teeth.
struct Rack {
  sim::Vec3 out;   // in its frame, unit: away from the pinion
  Toothed pinion;  // the wheel that it meets
};

/// What has teeth at an instant, by the number of its body.
struct Gears {
  std::map<int, Toothed> wheels;
  std::map<int, Rack> racks;
};

/// The toothed wheels and racks of a scene: all teeth as far from each other, and those that mesh between
/// each other.
Gears gears_of(const sim::SceneInfo& cast, const sim::Snapshot& now);

/// How deep the teeth of a body are cut into its form, m: half their height where they are its edge, as of a
/// ball around its centre or of a box along a side, and large enough to be seen; else 0, and the teeth are a
/// line over it.
double cut_of_teeth(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                    int body);

/// The bodies that are boxes, of a rank, and those that are round, without their teeth.
void draw_boxes(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears, Rank rank,
                List& list);
void draw_rounds(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                 List& list);

/// Teeth as far as their bodies reach, over their bodies.
void draw_gears(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                List& list);
void draw_racks(const Stage& stage, const View& view, const sim::Snapshot& now, const Gears& gears,
                List& list);

}  // namespace obscura::draw
