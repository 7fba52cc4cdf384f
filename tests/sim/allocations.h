#pragma once

#include <cstddef>

namespace obscura::sim {

/// Calls of operator new in this program so far.
std::size_t allocations();

}  // namespace obscura::sim
