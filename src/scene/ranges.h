#pragma once

#include <limits>

#include "scene/table.h"

namespace obscura::scene {

// Ranges that many keys have.
inline constexpr Range kPositive{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range kNotNegative{0};

}  // namespace obscura::scene
