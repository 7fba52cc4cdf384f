#pragma once

// Before any header of Eigen, for programs compiled by hand with Eigen 5 (obscura.pc): sums in our order.
// CMake says it in a flag.

#ifndef EIGEN_MATRIXBASE_PLUGIN
#define EIGEN_MATRIXBASE_PLUGIN "sim/math/sums.h"
#endif
