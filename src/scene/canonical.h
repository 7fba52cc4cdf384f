#pragma once

#include <string>

#include "scene/difference.h"
#include "scene/document.h"

namespace obscura::scene {

/// The keys and values of a scene in one form, whatever its layout, comments and order of keys: equal exactly
/// for scenes that say the same. Things of a kind keep their order. Throws Error where it is not TOML.
std::string canonical(const Source& source);

/// The scene's keys and values, with what is set over them; what is set on one of several copies is left out.
/// Throws Error where it is not TOML.
Node with_sets(const Source& source);

}  // namespace obscura::scene
