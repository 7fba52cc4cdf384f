#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "sim/model/trouble.h"

namespace obscura::sim {

/// The most impacts of a substep. Rightly there are many: n elastic balls in a row have up to n^2 / 2, one
/// that is 10^10 times as heavy as another meets it 314,159 times. None are dropped; what goes beyond ends
/// the run.
inline constexpr std::size_t kMostImpacts = 200000;

/// Throws NotFinite: the impacts of body `name` at time t (s), in a substep of h (s), do not end.
[[noreturn]] inline void throw_endless_impacts(std::string name, double t, double h) {
  Trouble trouble;
  trouble.time = t, trouble.body = std::move(name), trouble.quantity = "number of impacts";
  trouble.what = "grew past " + std::to_string(kMostImpacts) + " within a step";
  trouble.likely =
      "too many impacts in " + std::to_string(h) +
      " s: raise physics.rate, or lower the elasticity, or leave it room between what nothing stops";
  throw NotFinite(std::move(trouble));
}

}  // namespace obscura::sim
