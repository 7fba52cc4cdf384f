#pragma once

#include "scene/complaints.h"
#include "scene/dimension.h"
#include "scene/document.h"
#include "scene/table.h"

namespace obscura::scene {

/// Checks a document against the table of keys: reports keys that are unknown, of the wrong type, out of
/// range or of another dimension, and removes them, so that the rest may be read without checks.
void check(Node& top, const Dimension& told, Diagnostics& complaints);

/// The same for one table ("box") of a document.
void check(Node& table, const std::string& owner, const Dimension& told, Diagnostics& complaints);

}  // namespace obscura::scene
