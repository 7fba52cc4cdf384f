#pragma once

#include "scene/complaints.h"
#include "scene/dimension.h"
#include "scene/document.h"
#include "scene/table.h"

namespace obscura::scene {

/// Holds a document against the table of keys: what it does not know, what has the wrong type or is out of
/// range, or of another dimension, is complained about and taken out, so that what is left may be read
/// without asking.
void check(Node& top, const Dimension& told, Diagnostics& complaints);

/// The same for one table ("box") of a document.
void check(Node& table, const std::string& owner, const Dimension& told, Diagnostics& complaints);

}  // namespace obscura::scene
