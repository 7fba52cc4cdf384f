#pragma once

#include "sim/math/trig.h"

namespace obscura::sim::elementary {

// Elementary functions with the same bits on every processor: additions, multiplications, divisions, square
// roots and exact scalings only, no libm, no fused multiply-add. Sine and cosine are in sim/math/trig.h.
// Special values are those of IEEE 754: log(0) = -inf, sqrt(-1) and log(-1) are not numbers, and so on.

double exp(double x);              ///< off by less than 0.8 units in the last place
double log(double x);              ///< natural; 0.9
double pow(double x, double y);    ///< x^y; 0.8; of negative x only where y is a whole number
double tan(double x);              ///< 2.2 for |x| <= 2^20; beyond as sin_cos
double asin(double x);             ///< 2.2
double acos(double x);             ///< 2.2
double atan(double x);             ///< 1.1
double atan2(double y, double x);  ///< of the direction (x, y), in (-pi, pi]; 1.5
double sinh(double x);             ///< 2
double cosh(double x);             ///< 1.7
double tanh(double x);             ///< 2.7

}  // namespace obscura::sim::elementary
