#include "sim/math/operation.h"

#include <cmath>

#include "sim/math/elementary.h"
#include "sim/math/trig.h"

namespace obscura::sim {

namespace {

double sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : x; }

}  // namespace

int operands(Operation operation) {
  using enum Operation;
  switch (operation) {
    case constant:
    case variable:
      return 0;
    case add:
    case subtract:
    case multiply:
    case divide:
    case power:
    case arc_tangent:
    case minimum:
    case maximum:
    case less:
    case less_equal:
    case equal:
    case not_equal:
      return 2;
    case choose:
      return 3;
    default:
      return 1;
  }
}

double evaluated(Operation operation, double a, double b, double c) {
  using enum Operation;
  switch (operation) {
    case constant:
    case variable:
      break;
    case add:
      return a + b;
    case subtract:
      return a - b;
    case multiply:
      return a * b;
    case divide:
      return a / b;
    case negate:
      return -a;
    case power:
      return elementary::pow(a, b);
    case square_root:
      return std::sqrt(a);
    case exponential:
      return elementary::exp(a);
    case logarithm:
      return elementary::log(a);
    case sine:
      return sin_cos(a).sin;
    case cosine:
      return sin_cos(a).cos;
    case tangent:
      return elementary::tan(a);
    case arc_sine:
      return elementary::asin(a);
    case arc_cosine:
      return elementary::acos(a);
    case arc_tangent:
      return elementary::atan2(a, b);
    case hyperbolic_sine:
      return elementary::sinh(a);
    case hyperbolic_cosine:
      return elementary::cosh(a);
    case hyperbolic_tangent:
      return elementary::tanh(a);
    case absolute:
      return std::fabs(a);
    case sign:
      return sign_of(a);
    case floor:
      return std::floor(a);
    case minimum:
      return b < a ? b : a;
    case maximum:
      return b > a ? b : a;
    case less:
      return a < b;
    case less_equal:
      return a <= b;
    case equal:
      return a == b;
    case not_equal:
      return a != b;
    case choose:
      return a != 0 ? b : c;
  }
  return 0;
}

}  // namespace obscura::sim
