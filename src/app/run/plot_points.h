#pragma once

#include <cstdint>
#include <vector>

#include "draw/page/measure.h"
#include "draw/page/plot.h"
#include "draw/picture/look.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// Instants at which what the points of a line would leave out is looked for: at most so many.
inline constexpr std::int64_t kLooks = 30720;

/// Whether a body is not what is taught, by the scene's emphasis.
bool is_quiet(const draw::Look& look, int body);

/// Adds the values of a run at one more instant to the lines of a plot.
void add_values(const sim::SceneInfo& cast, const sim::Snapshot& now, const draw::Measured& measured,
                const std::vector<draw::Measured::Line>& lines, draw::Plot& plot);

/// Where a plot's points are too far apart for what it shows, as of an oscillation that is faster than they
/// are, it takes more of those between, `looks`: over time the least and the largest value of each part,
/// which is then a band; against a quantity all that are not one point.
void refine(const draw::Plot& looks, draw::Plot& plot);

}  // namespace obscura::app
