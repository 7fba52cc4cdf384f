#pragma once

#include "draw/plane/stage.h"
#include "draw/space/space.h"

namespace obscura::draw {

/// An instant as it would be `seconds` later if bodies went straight on: time and bodies alone.
sim::Snapshot later(const sim::Snapshot& now, double seconds);

/// How far a body reaches from its centre of mass, m.
double reach(const sim::SceneInfo::Body& body);

/// How far anything that is seen moves on the page from one instant to a later one: bodies, the hands of mice
/// on their ways, and what stands still as the camera goes. Page units.
double travel(const Stage& stage, const View& from, const View& to, const sim::Snapshot& now,
              const sim::Snapshot& then);
double travel(const SpaceStage& stage, const sim::Snapshot& now, const sim::Snapshot& then);

}  // namespace obscura::draw
