#pragma once

#include "draw/page/chart.h"
#include "draw/page/figure.h"
#include "draw/page/titles.h"
#include "draw/picture/pace.h"
#include "scene/complaints.h"
#include "scene/document.h"
#include "scene/roster.h"
#include "scene/when_names.h"
#include "sim/model/state.h"

namespace obscura::scene {

struct Film;

/// The scene's [figure]. Reports names that do not exist. `names`: what those of walls, joints and springs
/// mean.
template <int D>
draw::Figure figure(const WhenNames<D>& names, const Seating<D>& roster, const sim::World<D>& world,
                    Diagnostics& complaints);

/// The marks of [film], and those of [figure] where `film.figure` asks for them; `speed`: of the film.
template <int D>
draw::Marks film_marks(const WhenNames<D>& names, const Seating<D>& roster, const sim::World<D>& world,
                       const draw::Pace& speed, Diagnostics& complaints);

/// The scene's [[film.caption]]s.
template <int D>
std::vector<draw::Caption> captions(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                    const draw::Pace& speed, Diagnostics& complaints);

/// Complains of the first plot of a figure or a film whose axis would be too low to read.
void refuse_low_plots(const Node& top, const draw::Figure& figure, const Film& film, double type_scale,
                      Diagnostics& complaints);

/// The scene's [[film.plot]]s.
template <int D>
std::vector<draw::Chart> charts(const Node& top, const Seating<D>& roster, const sim::World<D>& world,
                                Diagnostics& complaints);

}  // namespace obscura::scene
