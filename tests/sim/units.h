#pragma once

namespace obscura::sim {

/// Gravity of the tests' rooms, m/s^2.
inline constexpr double kG = 9.81;

/// rad
inline constexpr double kDegree = 3.14159265358979324 / 180;

}  // namespace obscura::sim
