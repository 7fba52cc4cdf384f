#pragma once

#include <string>

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

}  // namespace obscura::sim
