#pragma once

#include <string>
#include <vector>

#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/fields.h"
#include "scene/room.h"
#include "scene/roster.h"
#include "scene/scene.h"

namespace obscura::scene {

/// Words, in which mathematics may stand between dollars. Complains of what is wrong in it.
const std::string& prose(const Fields& fields, const char* key, Diagnostics& complaints);

/// How the scene is to look; the bodies have theirs already, and trails by name are added to them.
void look(const Node& top, const NameTable& roster, draw::Look& look, Diagnostics& complaints);

/// The cameras of a scene, one at least: each stands, or has keys.
template <int D>
std::vector<draw::Camera> cameras(const Node& top, const NameTable& roster, Diagnostics& complaints);

/// How the scene asks to be filmed.
Film film(const Node& top, Diagnostics& complaints);

/// The moments compared with references: its own, or the start and half the duration.
Golden golden(const Node& top, sim::Rational duration, Diagnostics& complaints);

/// The extent that the camera fits: the room; if it is open, everything in it at the start, with a margin.
template <int D>
draw::Extent extent(const Room<D>& room, const sim::World<D>& world);

}  // namespace obscura::scene
