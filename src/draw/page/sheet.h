#pragma once

#include <optional>

#include "draw/page/layout.h"

namespace obscura::draw {

/// Page units a point (1/72 inch) of a sheet: fine enough for what draws in whole units.
inline constexpr double kPoint = 4;

/// The weight at which outlines are 0.9 pt.
inline constexpr double kPrint = 0.9 / kOutline * kPoint;

/// A picture for print. Type and lines have their own size in points, however wide it is.
struct Sheet {
  double width = 238.11;                  // pt: 84 mm, a column
  double tallest = 1.3;                   // heights a width
  std::optional<Extent> region{};         // of the world; none: what a camera fits
  double above = 0, below = 0, left = 0;  // pt left free
};

/// Lays a sheet out in `kPoint` units a point: the world as wide as the sheet, its height what that takes.
Layout lay_out(const sim::SceneInfo& cast, const Look& look, const Extent& extent, const Sheet& sheet);

}  // namespace obscura::draw
