#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace obscura::sim {

/// Why a run cannot go on: which body failed, how, when, and the probable cause.
struct Trouble {
  double time = 0;       // s
  std::string body;      // its name
  std::string quantity;  // "velocity", "position", "energy", ...
  std::string what;      // "is not a number", "grew past 1e6 room heights a second"
  std::string likely;    // "step 1/60 s is longer than 2.828 sqrt(m/k) = 0.0089 s of spring 3: raise
                         // physics.rate above 113"
};

/// A formula of the scene that came to no finite number: thrown from within a step, and told by the stepper
/// that it ends.
struct NotFinite : std::runtime_error {
  explicit NotFinite(Trouble it) : std::runtime_error(it.what), trouble(std::move(it)) {}
  Trouble trouble;
};

}  // namespace obscura::sim
