#pragma once

#include <string_view>
#include <vector>

#include "draw/compose/annotate.h"
#include "draw/page/figure.h"
#include "draw/picture/theme.h"

namespace obscura::draw {

/// The value of an arrow, before it is scaled.
struct Reading {
  sim::Vec3 tail, value;
  double signed_value = 0;  // of what turns: in the plane counter-clockwise, in space how much about `value`
};

/// The arrows that a vector of a figure stands for at an instant: one a spring, one a thing touched.
std::vector<Reading> readings(const Figure::Vector& vector, const sim::SceneInfo& cast,
                              const sim::Snapshot& now);

std::string_view unit(Quantity quantity);

/// The scale of its kind; null: it has none.
double* scale_of(Quantity quantity, Scales& scales);

Color color_of(const Figure::Vector& vector, const Palette& colours);

}  // namespace obscura::draw
