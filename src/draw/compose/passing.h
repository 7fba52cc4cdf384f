#pragma once

#include <vector>

#include "draw/compose/annotate.h"

namespace obscura::draw {

/// Fades words that come over others in passing: `plan` learns when. `instants`: what stands where at each of
/// `films` (s of the film, increasing).
void plan_passing(const std::vector<std::vector<Standing>>& instants, const std::vector<double>& films,
                  LabelPlan& plan);

/// How strong the words of a course are at a time of the film, 0 to 1.
double strength(const LabelPlan::Course& course, double film);

}  // namespace obscura::draw
