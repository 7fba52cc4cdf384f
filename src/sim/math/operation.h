#pragma once

#include <cstdint>

namespace obscura::sim {

/// What a node of a graph does. Comparisons give 1 or 0.
enum class Operation : std::uint8_t {
  constant,
  variable,
  add,
  subtract,
  multiply,
  divide,
  negate,
  power,
  square_root,
  exponential,
  logarithm,
  sine,
  cosine,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
  absolute,
  sign,
  floor,
  minimum,
  maximum,
  less,
  less_equal,
  equal,
  not_equal,
  choose,  // a != 0 ? b : c
};

/// How many operands an operation has, 0 to 3.
int operands(Operation operation);

/// What an operation makes of numbers; those beyond its operands are not read.
double evaluated(Operation operation, double a, double b, double c);

}  // namespace obscura::sim
