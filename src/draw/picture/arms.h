#pragma once

#include <vector>

#include "sim/model/snapshot.h"

namespace obscura::draw {

/// How far a place, in a body's own frame, is from its form, m; 0 within it. Of a hull no farther than from
/// the ball around it.
double beyond(const sim::SceneInfo::Body& body, const sim::Vec3& local);

/// A line from a body's centre of mass to a joint that lies outside of its form, m.
struct Arm {
  int joint = 0, body = 0;
  sim::Vec3 from, to;
};

/// Page units at the weight 1: a joint farther from its body has a line to it.
inline constexpr double kArmBeyond = 16;

/// The arms of bodies that a pin, a hinge or a weld holds at a place farther than `margin` (m) from them,
/// without which they would hang from nothing.
std::vector<Arm> arms(const sim::SceneInfo& cast, const sim::Snapshot& now, double margin);

}  // namespace obscura::draw
