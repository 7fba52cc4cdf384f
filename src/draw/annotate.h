#pragma once

#include <span>

#include "draw/depict.h"
#include "draw/figure.h"
#include "draw/layout.h"
#include "draw/theme.h"

namespace obscura::draw {

/// How long arrows are, one scale a kind for all panels of a figure: m a unit. 0: none is drawn.
struct Scales {
  double velocity = 0;  // m/s
  double force = 0;     // N
  double impulse = 0;   // N s
};

/// The scales at which the longest arrow of each kind is a good part of the picture. Requires a sheet's
/// layout.
Scales scales(const Figure& figure, const sim::Cast& cast, std::span<const sim::Snapshot> moments,
              const Layout& layout);

/// Draws what a figure says of an instant: arrows, angles, lengths, points, and their words where there is
/// room for them.
void annotate(const Figure& figure, const Scales& scales, const sim::Cast& cast, const Palette& colours,
              const Layout& layout, const View& view, const sim::Snapshot& now, List& list);

/// Whether a figure has a line of legend, and puts it down from `left` to `right` (page units) on a baseline:
/// the room's scale, and an arrow of each kind.
bool has_legend(const Figure& figure);
void draw_legend(const Figure& figure, const Scales& scales, const Palette& colours, double scale,
                 double left, double right, double baseline, List& list);

/// The largest of 1, 2, 5 times a power of ten that is not above x.
double round_below(double x);

}  // namespace obscura::draw
