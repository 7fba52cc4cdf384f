#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "sim/math/expression.h"
#include "sim/model/model.h"

namespace obscura::sim {

/// What an evaluation of a force is given: one number a body, or a pair of them; from `time` on one for all.
/// d is the way from the centre, or from the first of two to the second.
namespace each_slot {
enum : int { x, y, z, vx, vy, vz, mass, charge, angle, spin, copy, drag, quadratic_drag, spin_y, spin_z };
enum : int { time = 16, center, center_velocity = center + 3, end = center_velocity + 3 };
}  // namespace each_slot
namespace pair_slot {
enum : int { dx, dy, dz, dvx, dvy, dvz, mass1, mass2, charge1, charge2 };
enum : int { time = 16, end };
}  // namespace pair_slot

/// A force as it is written: a potential, or one expression a dimension, a torque, or both.
struct ForceText {
  std::string potential;
  std::vector<std::string> components;
  std::vector<std::string> torque{};  // in the plane one, in space three
  bool pair = false;                  // between two bodies
  bool centered = false;              // it has a centre
};

using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// A fault in one of the texts: of the potential where `component` is below zero.
struct ForceFault {
  int component = -1;
  bool torque = false;  // a component of it
  ExpressionFault fault;
};

/// The formulas of a force in D dimensions. `constants` may be used in it.
template <int D>
std::variant<ForceFormula, ForceFault> force_formula(const ForceText& text, const NamedNumbers& constants);

/// The names that forces have, for hints, and that a constant must not have: variables, functions, pi and
/// deg.
template <int D>
std::vector<std::string> force_names(bool pair);
std::vector<std::string> expression_names();

}  // namespace obscura::sim
