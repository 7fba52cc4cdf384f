#pragma once

#include <optional>
#include <string>
#include <vector>

#include "draw/page/marks.h"
#include "draw/page/measure.h"
#include "sim/math/rational.h"
#include "sim/math/vec.h"

namespace obscura::draw {

/// A figure: its marks, and the rest of the page.
struct Figure : Marks {
  struct Plot : Measured {
    sim::Rational from, to;  // s
    double height = 36;      // mm
    std::string over;        // "physics.rate=10,20,40": the end of a run for each, instead of time
    std::string reference;   // "physics.rate=6400; physics.integrator=rk4": plotted is how far the end is
                             // from that run's
    bool log = false;
  };

  std::vector<sim::Rational> at;       // s, one a panel; after the impact, where there is one
  int impact = -1;                     // the body whose first impact it is about
  std::optional<double> width;         // mm
  std::optional<sim::Vec3> low, high;  // m: what of the world is shown
  std::optional<sim::Rational> every;
  std::string vary;  // "crate.elasticity=0,0.5,1": a panel and a line of each plot for each value
  int columns = 0;
  std::vector<std::string> titles;  // of the panels, in place of what sets them apart; as mathematics
  int times_of = -1;                // the body whose earlier exposures have their times beside them
  bool room = true;                 // the run's picture; false: plots alone
  bool scale_bar = false;
  std::string formula;  // above the picture
  std::vector<Plot> plots;
};

}  // namespace obscura::draw
