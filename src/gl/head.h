#pragma once

#include <compare>

#include "draw/picture/list.h"

namespace obscura::gl {

/// How far a list goes in painter's order: so many batches, and so many things of the next.
struct Reach {
  int batches = 0, things = 0;
  auto operator<=>(const Reach&) const = default;
};

/// The whole of a list.
inline Reach end_of(const draw::List& list) { return {int(list.batches.size()), 0}; }

/// How far two lists draw the same things.
Reach common_head(const draw::List& a, const draw::List& b);

}  // namespace obscura::gl
