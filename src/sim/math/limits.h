#pragma once

#include <bit>
#include <cstdint>

namespace obscura::sim {

// Whether a number has become too large, or none at all. The bits of abs(x), read as an integer, grow with
// abs(x), and those of an infinity and of what is not a number are larger than any: one subtraction tests all
// three, four at a time.

inline constexpr std::int64_t kMagnitude = 0x7fffffffffffffff;

/// Negative where abs(x) > limit, or x is not a number. Requires limit >= 0.
inline std::int64_t within(double x, double limit) {
  return std::bit_cast<std::int64_t>(limit) - (std::bit_cast<std::int64_t>(x) & kMagnitude);
}

/// Negative where any of n numbers is.
inline std::int64_t within(const double* x, int n, double limit) {
  std::int64_t all = 0;
  for (int i = 0; i < n; ++i) all |= within(x[i], limit);
  return all;
}

/// How far, and how fast in a second, a thing may get, in heights of the room.
inline constexpr double kFarthest = 1e6;

/// How far a step may turn what wobbles in space, rad: it is integrated in pieces of that
/// (sim/math/lie_step.h).
inline constexpr double kFarthestTurn = 100;

/// How far above the ground a body still stands on it, in heights of the room.
inline constexpr double kOnGround = 1e-6;

/// Errors of velocities below which nothing is told, heights of the room a second; of spins, rad/s.
inline constexpr double kFaintest = 1e-9;

}  // namespace obscura::sim
