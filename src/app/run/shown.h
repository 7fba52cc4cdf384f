#pragma once

#include <string>
#include <vector>

#include "draw/page/marks.h"
#include "draw/page/measure.h"
#include "draw/picture/look.h"
#include "sim/model/snapshot.h"

namespace obscura::app {

/// What is drawn over a picture, in sentences: "Arrows show velocity of the ball." Of many bodies the first.
std::vector<std::string> shown_marks(const draw::Marks& marks, const draw::Look& look,
                                     const sim::SceneInfo& cast);

/// What a plot shows, in a sentence: "A plot shows kinetic energy over time." `over`: the key that it goes
/// over; empty: time, or the quantity that it names itself. `errors`: how far that is from another run's.
std::string shown_plot(const draw::Measured& plot, const sim::SceneInfo& cast, const std::string& over = {},
                       bool errors = false);

}  // namespace obscura::app
