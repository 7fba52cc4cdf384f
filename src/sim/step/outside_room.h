#pragma once

#include <optional>
#include <string>

#include "sim/model/state.h"

namespace obscura::sim {

/// A body that stands outside the room, and where: "0.3 m beyond the left wall".
struct Outside {
  int body = -1;
  std::string where;
};

/// The first body that has been set elsewhere than in `before` and lies beyond a wall. Allowed is what
/// contacts leave, a hundredth of the bounding radius, and what it lay beyond the wall before. One that is
/// held counts by its centre. With `any_turn`, only what is outside however it is turned: positions may be
/// set before turns.
template <int D>
std::optional<Outside> outside(const Model<D>& model, const State<D>& before, const State<D>& now,
                               bool any_turn);

}  // namespace obscura::sim
