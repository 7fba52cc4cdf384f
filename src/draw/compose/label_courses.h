#pragma once

#include <map>
#include <vector>

#include "draw/compose/annotate.h"

namespace obscura::draw {

/// Where the labels of a film stand when: for each sample what it offers. A label goes to another place only
/// where that pays, and not faster than `speed` (page units a second of the film).
std::map<WordKey, LabelPlan::Course> courses(const std::vector<std::vector<Offered>>& samples,
                                             const std::vector<double>& films, double point, double speed);

}  // namespace obscura::draw
