#pragma once

#include "scene/faults.h"

namespace obscura::scene {

/// Whether a value has the form and range of its key, and as many numbers as a place of this scene has.
/// Reports all faults, in every element of a list. Requires a form that is no table of keys.
bool check_value(const Node& node, const Key& key, const Reporter& faults);

}  // namespace obscura::scene
