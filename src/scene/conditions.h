#pragma once

#include "scene/when_names.h"

namespace obscura::scene {

/// Reads the condition of a [[when]] into `when`; complains where it has none, several, or one that cannot
/// be.
template <int D>
void condition(const Fields& fields, const WhenNames<D>& names, sim::When<D>& when, Diagnostics& complaints);

}  // namespace obscura::scene
