#pragma once

#include <vector>

#include "draw/picture/list.h"

namespace obscura::draw {

/// The form of a coil spring: how many turns, which stay, and what it measures at rest, in page units.
struct Coil {
  int turns = 0;         // 0: drawn as a plain line
  double rest = 0;       // length
  double amplitude = 0;  // half its thickness
  double line = 0;       // width of the wire
};

/// A coil for a spring of this rest length (page units, where the camera fits) at this line weight.
Coil coil(double rest, double weight);

/// Half the thickness of the coil at a length; it shrinks as it is stretched. `zoom`: page scale over the
/// fitted one.
double amplitude(const Coil& coil, double length, double zoom);

/// The width of its line: thinner as it is stretched, or pressed until its turns come close.
double line_width(const Coil& coil, double length, double zoom);

/// The line from a to b: a straight lead, smooth turns, a straight lead. It never turns back along the
/// spring.
std::vector<Point> coil_line(const Coil& coil, const Point& a, const Point& b, double zoom);

/// What the line of coil_line follows from, besides its ends.
Winding winding(const Coil& coil, double length, double zoom);

}  // namespace obscura::draw
