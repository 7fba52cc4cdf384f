#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"
#include "sim/math/rational.h"

namespace obscura::app {

/// The first difference of two runs.
struct Parting {
  std::int64_t step = 0;  // of the physics clock
  double time = 0;        // s
  std::string body;       // whose; empty: of no single body
  std::string quantity;   // "velocity", "position and velocity", "number of bodies"
  std::string a, b;       // the values, where they are numbers

  /// "states part at step 312 (t = 0.52 s): body box, velocity: [0, 1] and [0, 1.1]"
  std::string text() const;
};

/// Simulates two scenes side by side, step by step up to `until` (s), and says where their states part first;
/// none where they never do. A run that cannot go on parts from one that can.
std::optional<Parting> parting(const scene::Scene& a, const scene::Scene& b, sim::Rational until);

}  // namespace obscura::app
