#pragma once

#include <cstdint>
#include <vector>

#include "draw/picture/look.h"
#include "scene/complaints.h"
#include "scene/dimension.h"
#include "scene/document.h"
#include "scene/expressions.h"
#include "scene/overrides.h"
#include "scene/room.h"
#include "scene/roster.h"
#include "sim/model/state.h"

namespace obscura::scene {

/// Puts the bodies of a scene into a world and says what they look like. Complains of bodies outside the
/// room.
template <int D>
Seating<D> bodies(const Node& top, const Room<D>& room, std::uint64_t seed, const std::vector<CopySet>& sets,
                  const Dimension& told, Constants& constants, sim::World<D>& world,
                  std::vector<draw::BodyLook>& looks, Diagnostics& complaints);

}  // namespace obscura::scene
