#pragma once

#include "scene/faults.h"

namespace obscura::scene {

/// Whether a value is what its key takes: of its form, in its range, with as many numbers as a place of this
/// scene has. Complains of all that is not, of a list's every element. Requires a form that is no table of
/// keys.
bool check_value(const Node& node, const Key& key, const Reporter& faults);

}  // namespace obscura::scene
