#pragma once

#include <functional>
#include <optional>
#include <string>

#include "scene/when_changes.h"

namespace obscura::scene {

/// The model of the same scene with one more key set; none, and a complaint at the place, where that is
/// wrong.
template <int D>
using Rebuild =
    std::function<std::optional<sim::Model<D>>(const std::string& set, Place place, Diagnostics& complaints)>;

/// Reads { set = "...", to = ... } of a [[when]] into the changes that it makes. Complains of what stays as
/// it is while the room runs.
template <int D>
void setting(const Node& set, const Node* to, const Rebuild<D>& rebuild, Changes<D>& changes,
             sim::When<D>& when);

}  // namespace obscura::scene
